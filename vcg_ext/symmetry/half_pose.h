// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HALF_POSE_H
#define VCG_FCD_HALF_POSE_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/solve/graph_pose.h>

namespace vcg::fcd {

/// Half of the way of a pose: neither the rest shape nor the pose is nearer. \param full its linear maps may stretch
///
/// The middle of the positions is not that: what turns by an angle would shrink by the cosine of its half. Instead,
/// each edge of the graph is the mean of what it is at rest and in the pose, both turned to half of the rotation in
/// between; the positions are those that the edges fit best (least squares), in the middle of both as a whole. Of a
/// rotation or a bend it is the one by half of the angle, of a shear by t that by t / 2. Half of the way back is the
/// same shape: so where the pose is the mirror image, half of the way is its own mirror image. \throw Unsolvable
GraphPose HalfPose(const DeformationGraph &graph, const GraphPose &full);

} // namespace vcg::fcd

#endif
