// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ONE_SIDED_H
#define VCG_FCD_ONE_SIDED_H

#include <vcg_ext/base/graph.h>

#include <vcg_ext/base/progress.h>

#include <Eigen/Core>
#include <array>
#include <vector>

namespace vcg::fcd {

/// A triangle of nodes.
using Corners = std::array<Index, 3>;

/// Orients a surface: flips triangles so that neighbours face the same side, and removes repeated triangles (with the
/// same corners in any order). A piece, whose triangles are joined by edges of two, gets the side of most of its area;
/// if less than three quarters of the area agree, it faces outwards. Pieces that are oriented, or cannot be (a Moebius
/// strip), are not changed.
/// \param position 3 x nodes \param triangle in, out: three different nodes each \throw Cancelled
void MakeOneSided(const Eigen::Matrix3Xd &position, std::vector<Corners> &triangle, const Progress &progress = {});

} // namespace vcg::fcd

#endif
