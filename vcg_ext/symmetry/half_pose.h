// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HALF_POSE_H
#define VCG_FCD_HALF_POSE_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/solve/graph_pose.h>

namespace vcg::fcd {

/// The shape half-way from rest to a pose. \param full the pose; its linear maps may stretch \throw Unsolvable the
/// system cannot be factorised
///
/// The mean of the positions would shrink turning parts, by the cosine of half the angle. Instead, each edge of the
/// graph is the mean of its vectors at rest and in the pose, both turned to half of the rotation between them.
/// Positions fit these edges best (least squares), and each connected part is centred between rest and pose. Half of a
/// rotation or a bend has half of the angle; half of a shear by t is a shear by t / 2. From the pose to rest, half-way
/// is the same shape: if the pose is the mirror image, it is its own mirror image.
GraphPose HalfPose(const DeformationGraph &graph, const GraphPose &full);

} // namespace vcg::fcd

#endif
