// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_STRETCH_COLORS_H
#define FCD_STRETCH_COLORS_H

#include <vcg_ext/centroidal_deformation.h> // before Qt

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <vector>

/// The colour of a place whose stretch is a power of two: blue for half as long or less (-1), grey for 0, red for twice
/// as long or more (1).
vcg::Color4b colorOfStretch(double exponent);

/// The colours of a layer's vertices while they show how much its surface is stretched. Its own are kept meanwhile.
class StretchColors {
  public:
    explicit StretchColors(MeshModel &layer);

    /// Colours each vertex by the mean of the TriangleStretch::Exponent() of its faces, weighed by their area at rest.
    /// \param rest positions at rest, one a vertex slot \param world of the layer's matrix: stretch is that in the
    /// world
    void show(const std::vector<Point3m> &rest, const Eigen::Matrix3d &world);
    /// Gives the layer its own colours back, unless something else has coloured it since.
    void bringBack();

  private:
    void connect();

    MeshModel &layer;
    const bool hadColors;
    std::vector<vcg::Color4b> own, shown;
    std::vector<float> exponent, area; ///< of faces

    // The faces of the vertex at each slot are those from begin[slot] to begin[slot + 1], ascending.
    std::vector<std::uint32_t> begin, faceOf;
};

#endif
