// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ONE_SIDED_H
#define VCG_FCD_ONE_SIDED_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// A triangle of nodes.
using Corners = std::array<Index, 3>;

/// Calls body(corners) for each face between three different nodes. \param nodeOf of each vertex slot, -1: none
/// \throw Cancelled
template <class Body>
void ForTriangles(const SurfaceView &mesh, const std::vector<Index> &nodeOf, const Progress &progress,
                  const Body &body) {
    for (std::size_t f = 0; f < mesh.faces; ++f) {
        progress.Round(f, mesh.faces, readingStage);
        if (!mesh.IsFace(f))
            continue;
        Corners c;
        for (std::size_t k = 0; k < 3; ++k)
            c[k] = nodeOf[mesh.corner[3 * f + k]];
        if (std::min({c[0], c[1], c[2]}) >= 0 && c[0] != c[1] && c[1] != c[2] && c[2] != c[0])
            body(c);
    }
}

/// Orients a surface: flips triangles so that neighbours face the same side, and removes repeated triangles (with the
/// same corners in any order). A piece, whose triangles are joined by edges of two, gets the side of most of its area;
/// if less than three quarters of the area agree, it faces outwards. Pieces that are oriented, or cannot be (a Moebius
/// strip), are not changed.
/// \param position 3 x nodes \param triangle in, out: three different nodes each \throw Cancelled
void MakeOneSided(const Eigen::Matrix3Xd &position, std::vector<Corners> &triangle, const Progress &progress = {});

} // namespace vcg::fcd

#endif
