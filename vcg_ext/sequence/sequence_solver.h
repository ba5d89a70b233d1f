// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SEQUENCE_SOLVER_H
#define VCG_FCD_SEQUENCE_SOLVER_H

#include <vcg_ext/deformer.h>

#include <map>
#include <optional>
#include <vector>

namespace vcg::fcd {

/// Poses of a prepared surface, blended by weights; each is solved from the one before.
class SequenceSolver {
  public:
    /// Refers to \p deformer. \param world from mesh units to the world \param pose of each pose, the motions of handle
    /// tags, in the world \param param as the deformer was prepared with; param.pose is not read
    /// \throw BadInput when the deformer has point handles
    SequenceSolver(const Deformer &deformer, const Eigen::Affine3d &world, std::vector<std::map<int, Motion>> pose,
                   const DeformationParam &param);

    /// How what is held moves, as Blend tells. \param weight of each pose, percent
    /// \throw BadInput a motion by more than 1e30 times the mesh, or one that is not finite
    HeldMotions MotionsOf(const std::vector<double> &weight) const;

    /// The pose of these weights, reached from the one before, or from rest; with as many poses between as it needs.
    /// That without a motion is rest, to the bit. \throw Unsolvable \throw Cancelled; the one before is then kept
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
