// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_SHAPE_H
#define FCD_LAYER_SHAPE_H

#include <vcg_ext/sequence/pose_sequence.h> // these before Qt
#include <vcg_ext/sequence/sequence_solver.h>

#include <layer_fcd/inherited.h>
#include <layer_fcd/layer_deformer.h>
#include <layer_fcd/parameters.h>
#include <layer_fcd/rest_shape.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

/// The rest shape of a layer while a tool has it, and whether the layer has it.
class RestGuard {
  public:
    /// \throw vcg::fcd::Error a matrix without an inverse
    explicit RestGuard(MeshModel &layer);
    /// Makes the present shape of the layer the rest shape.
    void keep();
    /// The same for a layer in a pose of its RestShape: calls \p keepRest, for keep(), while it is at rest.
    void keepPosed(const std::function<void()> &keepRest);

    /// Whether the layer has as many vertices and faces as it had.
    bool fits() const { return layer.cm.vert.size() == position.size() && layer.cm.face.size() == faceNormal.size(); }
    bool isPosed() const { return posed; }
    /// Call before a pose is written to the vertices, and know() afterwards.
    void leave() { posed = true; }
    void know();
    /// Whether the layer has the matrix, the shape and the normals that it had when these were known last.
    bool isAsKnown() const;
    std::uint64_t known() const { return shape; } ///< the shape that the layer was given last, as shapeOf tells it

    /// Positions and normals of the vertices in a pose; none at rest.
    using Shown = std::vector<std::pair<Point3m, Point3m>>;
    Shown shown() const;

    /// Gives vertices their positions and normals at rest.
    void restoreVertices();
    /// Restores the rest shape to the bit, with normals of faces and the box, unless the layer is another mesh by now.
    void restore();

    /// Per vertex slot, in the layer.
    const std::vector<Point3m> &positions() const { return position; }
    const std::vector<Point3m> &normals() const { return normal; }
    bool isDeleted(std::size_t slot) const { return layer.cm.vert[slot].IsD(); }
    Eigen::Vector3d at(std::size_t slot) const { return toVector(position[slot]); }

    const Eigen::Affine3d &world() const { return matrix; }  ///< the layer's matrix
    const Eigen::Vector3d &middle() const { return center; } ///< of the box, layer units
    double diagonal() const { return size; }                 ///< of the box in the world
    const vcg::fcd::SurfaceMark &mark() const { return surface; }

  private:
    MeshModel &layer;
    Eigen::Affine3d matrix;
    std::vector<Point3m> position, normal, faceNormal;
    vcg::Box3<Scalarm> box;
    Eigen::Vector3d center;
    double size = 1;
    vcg::fcd::SurfaceMark surface;
    std::uint64_t shape = 0, shownNormals = 0;
    bool posed = false;
};

// --- undo over applies: back to the rest shape before one, if RestShape still keeps it ---

/// Makes an earlier rest shape, which shapeOf identifies, the layer's rest shape again and shows it. Copies of the
/// layer take over its rest shapes first. \return false: it is not kept, and nothing has changed
inline bool goBackTo(const MeshDocument &document, MeshModel &layer, std::uint64_t shape) {
    if (!RestShape::exists(layer))
        return false;
    RestShape shapes(layer);
    const std::vector<std::uint64_t> kept = shapes.shapes();
    const auto place = std::find(kept.begin(), kept.end(), shape);
    if (place == kept.end())
        return false;
    handDownRest(document, layer);
    shapes.backTo(std::size_t(place - kept.begin()));
    shapes.restore();
    return true;
}

/// The first apply from which on all rest shapes are kept. \param shapeBefore(i) the shape before apply i
template <class ShapeBefore>
std::size_t firstKept(MeshModel &layer, std::size_t applies, const ShapeBefore &shapeBefore) {
    if (applies == 0 || !RestShape::exists(layer))
        return applies;
    const std::vector<std::uint64_t> kept = RestShape(layer).shapes();
    while (applies > 0 && std::find(kept.begin(), kept.end(), shapeBefore(applies - 1)) != kept.end())
        --applies;
    return applies;
}

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
    /// Begins an animation: from rest, then from the pose before, until something else is solved or prepared.
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
