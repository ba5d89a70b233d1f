// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POSE_SOLVER_H
#define FCD_POSE_SOLVER_H

#include <vcg_ext/sequence/sequence_solver.h> // before Qt

#include <layer_fcd/layer_deformer.h>

#include <map>
#include <memory>
#include <optional>
#include <vector>

/// The deformer of a layer while a tool has it, and the last pose.
class PoseSolver {
  public:
    using Tags = std::shared_ptr<const std::vector<int>>; ///< one per vertex slot
    using Param = vcg::fcd::DeformationParam;
    using Motions = std::map<vcg::fcd::Index, vcg::fcd::Motion>;

    PoseSolver(MeshDocument &document, MeshModel &layer) : deformer(document, layer, kept) {}
    PoseSolver(const PoseSolver &) = delete;
    PoseSolver &operator=(const PoseSolver &) = delete;

    /// Whether it is prepared for this very object of tags, and with the same parameters.
    bool isPrepared(const Tags &tags, const Param &param) const;
    /// \param surface of the layer at rest \param world its matrix \throw vcg::fcd::Error \throw vcg::fcd::Cancelled
    void prepare(const Tags &tags, const Param &param, const vcg::fcd::SurfaceView &surface,
                 const Eigen::Affine3d &world, const vcg::fcd::Progress &progress = {});
    const Prepared *prepared() const { return deformer.prepared().get(); }
    /// The prepared deformer, for filters.
    PreparedLayers &preparedLayers() { return kept; }
    void clear();

    /// \param full from rest to the end, as the filters do; otherwise some steps from the last pose
    const vcg::fcd::Deformer::Pose &solve(Motions motions, Param param, bool full);
    /// The pose that FCD: Pose Sequence gives first for \p weight, percent of each of \p poses.
    const vcg::fcd::Deformer::Pose &solveBlend(std::vector<std::map<int, vcg::fcd::Motion>> poses,
                                               const Eigen::Affine3d &world, const std::vector<double> &weight,
                                               const Param &param);
    /// Begins an animation: solveNextBlend then goes on from the pose before, and from rest at first, as long as
    /// nothing else is solved or prepared.
    void beginBlends(std::vector<std::map<int, vcg::fcd::Motion>> poses, const Eigen::Affine3d &world,
                     const Param &param);
    const vcg::fcd::Deformer::Pose &solveNextBlend(const std::vector<double> &weight) { return blends->Go(weight); }
    void endBlends() { blends.reset(); }
    /// Makes the next pose begin at rest.
    void forgetPose() { last.reset(); }

  private:
    PreparedLayers kept;
    LayerDeformer deformer;
    Tags preparedFor; ///< null: not prepared
    Param preparedParam;
    std::optional<vcg::fcd::Deformer::Pose> last;
    std::unique_ptr<vcg::fcd::SequenceSolver> blends; ///< while an animation is played
};

#endif
