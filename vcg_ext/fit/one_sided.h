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

/// Makes one side of a surface: triangles with the same corners count once, however these are numbered, and each looks
/// to the side to which those beside it do. Of a piece that hangs together by edges of two triangles, the side is that
/// of most of its area; where less than three quarters of it agree, that which is outwards. What has one side already
/// keeps its bits, and so does a piece that has none, as a Moebius strip.
/// \param position 3 x nodes \param triangle of three different nodes each \throw Cancelled
void MakeOneSided(const Eigen::Matrix3Xd &position, std::vector<Corners> &triangle, const Progress &progress = {});

} // namespace vcg::fcd

#endif
