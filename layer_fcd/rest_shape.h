// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_REST_SHAPE_H
#define FCD_REST_SHAPE_H

#include "meshlab_host.h"

#include <Eigen/Core>

#include <cstdint>
#include <string>

/// The shapes of a layer, as numbers: plain data, which a layer keeps. Who changes it changes the number in its name.
struct Poses {
    // A preview begins each time with the shape that the layer had before, which is then the latest; a few are enough.
    static constexpr int most = 16;

    std::uint64_t rest = 0;
    int vertices = 0;                ///< at rest
    int count = 0;                   ///< of the latest
    std::uint64_t latest[most] = {}; ///< poses, the latest first
};

/// The rest shape of a layer that is posed in place: positions and normals of its vertices, which the layer keeps as
/// attributes, and the shapes that posing gave it, by which it is known whether something else changed it.
class RestShape {
  public:
    static bool exists(const MeshModel &layer);
    /// Makes the present shape of \p layer its rest shape.
    static void keep(MeshModel &layer);

    /// \pre the layer has a rest shape
    explicit RestShape(MeshModel &layer);

    const Point3m *positions() const { return position; } ///< per vertex slot
    const Point3m *normals() const { return normal; }     ///< per vertex slot

    std::uint64_t shape() const { return poses->rest; } ///< at rest
    /// Whether \p shape is one of the latest poses, or that at rest. A pose is then the latest.
    bool knows(std::uint64_t shape);
    /// Remembers a pose, as the latest.
    void add(std::uint64_t shape);

    /// Gives the layer its rest shape back, to the bit; normals of faces are computed.
    /// \throw vcg::fcd::Error when it has more vertices than it had
    void restore() const;

  private:
    MeshModel &layer;
    const Point3m *position, *normal;
    Poses *poses;
};

/// Whether a vertex attribute is one of a rest shape.
bool isOfRest(const std::string &attribute);

/// The positions of the vertices of \p layer at rest, 3 x slots.
Eigen::Matrix3Xd restPositionsOf(MeshModel &layer);

/// A number for the positions of all vertices: the sum of the terms of each of them.
std::uint64_t shapeOf(const CMeshO &mesh);
/// What a vertex at a slot adds to it.
std::uint64_t shapeTerm(std::size_t slot, const Point3m &position);

#endif
