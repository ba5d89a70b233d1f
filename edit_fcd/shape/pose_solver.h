// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_SOLVER_H
#define FCD_BEND_SOLVER_H

#include "edit_fcd/bend/model/state.h" // before Qt

#include <layer_fcd/layer_deformer.h>
#include <vcg_ext/sequence/sequence_solver.h>

#include <map>
#include <memory>
#include <optional>
#include <vector>

/// How the filters are asked for what the panel says.
vcg::fcd::DeformationParam deformationOf(const BendOptions &options);

/// The deformer of a layer while the tool bends it, and the last pose.
class BendSolver {
  public:
    using Motions = std::map<vcg::fcd::Index, vcg::fcd::Motion>;

    BendSolver(MeshDocument &document, MeshModel &layer) : deformer(document, layer, kept) {}
    BendSolver(const BendSolver &) = delete;
    BendSolver &operator=(const BendSolver &) = delete;

    /// Whether it is prepared for tags, these very ones, and options.
    bool isPrepared(const std::shared_ptr<const BendTags> &tags, const BendOptions &options) const;
    /// \param surface of the layer at rest \param world its matrix \throw vcg::fcd::Error \throw vcg::fcd::Cancelled
    void prepare(const std::shared_ptr<const BendTags> &tags, const BendOptions &options,
                 const vcg::fcd::SurfaceView &surface, const Eigen::Affine3d &world,
                 const vcg::fcd::Progress &progress = {});
    const Prepared *prepared() const { return deformer.prepared().get(); }
    /// Where a filter finds what is prepared here.
    PreparedLayers &preparedLayers() { return kept; }
    void clear();

    /// \param full from rest to the end, as the filters do; otherwise some steps from the last pose
    const vcg::fcd::Deformer::Pose &solve(Motions motions, const BendOptions &options, bool full);
    /// The pose that FCD: Pose Sequence gives first for \p weight, percent of each of \p poses.
    const vcg::fcd::Deformer::Pose &solveBlend(std::vector<std::map<int, vcg::fcd::Motion>> poses,
                                               const Eigen::Affine3d &world, const std::vector<double> &weight,
                                               const BendOptions &options);
    /// The same on the way of an animation: from the pose before, the first one from rest. \pre it was begun, and
    /// nothing else was solved or prepared since
    void beginBlends(std::vector<std::map<int, vcg::fcd::Motion>> poses, const Eigen::Affine3d &world,
                     const BendOptions &options);
    const vcg::fcd::Deformer::Pose &solveNextBlend(const std::vector<double> &weight) { return blends->Go(weight); }
    void endBlends() { blends.reset(); }
    /// The next one begins at rest.
    void forgetPose() { last.reset(); }

  private:
    PreparedLayers kept;
    LayerDeformer deformer;
    std::shared_ptr<const BendTags> preparedFor; ///< null: for nothing
    int preparedPatches = 0;
    vcg::fcd::MappingWeights preparedWeights = BendOptions().weights;
    std::optional<vcg::fcd::Deformer::Pose> last;
    std::unique_ptr<vcg::fcd::SequenceSolver> blends; ///< while an animation is played
};

#endif
