// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_STRETCH_COLORS_H
#define FCD_STRETCH_COLORS_H

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <vector>

/// The colour of a place whose stretch is a power of two: blue for half as long or less (-1), grey for 0, red for twice
/// as long or more (1).
vcg::Color4b colorOfStretch(double exponent);

/// Colours of a layer's vertices that show how much its surface is stretched.
class StretchColors {
  public:
    explicit StretchColors(const MeshModel &layer);

    /// One colour per vertex slot, by the mean of the TriangleStretch::Exponent() of its faces, weighed by their area
    /// at rest. \param rest positions at rest, one a vertex slot \param world of the layer's matrix: stretch is that in
    /// the world \param opacity of all, to 255
    std::vector<vcg::Color4b> of(const std::vector<Point3m> &rest, const Eigen::Matrix3d &world, unsigned char opacity);

  private:
    void connect();

    const MeshModel &layer;
    std::vector<float> exponent, area; ///< of faces

    // The faces of the vertex at each slot are those from begin[slot] to begin[slot + 1], ascending.
    std::vector<std::uint32_t> begin, faceOf;
};

#endif
