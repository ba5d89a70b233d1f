// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SEQUENCE_SOLVER_H
#define VCG_FCD_SEQUENCE_SOLVER_H

#include <vcg_ext/deformer.h>

#include <map>
#include <optional>
#include <vector>

namespace vcg::fcd {

/// Blends poses of a prepared surface by weights. Each blend is solved from the one before.
class SequenceSolver {
  public:
    /// \param deformer must outlive this
    /// \param world mesh units to the world \param pose motions of handle tags in each pose, world units \param param
    /// as the deformer was prepared with; param.pose is not read \throw BadInput the deformer has point handles
    SequenceSolver(const Deformer &deformer, const Eigen::Affine3d &world, std::vector<std::map<int, Motion>> pose,
                   const DeformationParam &param);

    /// The blended motions of held regions (Blend).
    /// \param weight of each pose, percent \throw BadInput a motion by more than 1e30 times the mesh, or one that is
    /// not finite
    HeldMotions MotionsOf(const std::vector<double> &weight) const;

    /// Solves the pose of these weights, from the one before or from rest, with as many poses between as it needs.
    /// Without a motion, it is rest, to the bit. \throw Unsolvable \throw Cancelled the last pose is then kept
    const Deformer::Pose &Go(const std::vector<double> &weight, const Progress &progress = {});

    /// Begins at rest again.
    void Rest() { last.reset(); }

  private:
    const Deformer &deformer;
    const std::vector<std::map<int, Motion>> pose;
    const DeformationParam param;
    Eigen::Affine3d world;
    std::map<Index, bool> turns; ///< tags that any of the poses turns
    std::optional<Deformer::Pose> last;
    std::vector<double> lastWeight;
};

} // namespace vcg::fcd

#endif
