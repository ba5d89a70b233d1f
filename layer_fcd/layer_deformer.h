// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_DEFORMER_H
#define FCD_LAYER_DEFORMER_H

#include "parameters.h"
#include "prepared_layers.h"
#include "rest_shape.h"

#include <functional>
#include <map>
#include <memory>
#include <vector>

/// The result of FCD: Deform Mesh.
struct DeformedLayers {
    vcg::fcd::DeformationResult result;
    std::vector<MeshModel *> layers; ///< the new ones, the deformed one last
    double percent = 0;              ///< the pose that was reached
    bool isStopped = false;          ///< it stopped at contact
    int replaced = 0;                ///< number of layers of an earlier try that were deleted
    bool isOwnGraph = false;         ///< the graph layer is the graph that the parameters make
    vcg::fcd::Index givenNodes = 0;  ///< number of nodes of the graph layer
};

/// The result of FCD: Pose in Place.
struct PoseResult {
    int nodes = 0, iterations = 0;
    bool converged = false;
    double discretisationError = 0; ///< as in Deformer::DiscretisationError
    vcg::fcd::PosePath path;
    vcg::fcd::TagCount tags;
    vcg::fcd::SurfaceContact contact; ///< if it was asked for
    bool prepared = false;            ///< the deformer was prepared anew
    double secondsFind = 0, secondsPrepare = 0, secondsSolve = 0, secondsMap = 0, secondsNormals = 0;
};

/// Deforms a layer, for filters and the tool: reads tags and point handles, finds or prepares a deformer, reads
/// motions. deform() and pose() are whole filters; steps of them follow, in order, for other callers.
class LayerDeformer {
  public:
    /// \param preparedLayers keeps the deformers \param remark may be empty
    LayerDeformer(MeshDocument &document, MeshModel &layer, PreparedLayers &preparedLayers, Remark remark = {});

    /// FCD: Deform Mesh: adds layers with the result. \param replaceEarlier deletes the layers of the try before
    /// \throw vcg::fcd::Error, vcg::fcd::Cancelled; the document is then as it was
    DeformedLayers deform(DeformMeshParam param, bool replaceEarlier, const vcg::fcd::Progress &progress);

    /// FCD: Pose in Place: gives the layer the deformed positions of its rest shape, and turns its normals. The first
    /// time, its present shape becomes the rest shape.
    /// \throw vcg::fcd::Error the layer was changed since its last pose, or as deform; vcg::fcd::Cancelled; the layer
    /// is then as it was
    PoseResult pose(const PoseParam &param, const vcg::fcd::Progress &progress);

    // --- the steps ---

    /// Finds the deformer for arrays of the layer at rest, with the matrix \p world, or prepares it. Reads neither
    /// layer nor document, so it can run in another thread than the window's.
    /// \param tag one per vertex slot \throw vcg::fcd::Error no handle, nothing free, ... \throw vcg::fcd::Cancelled
    void prepare(const vcg::fcd::SurfaceView &surface, std::vector<int> tag, const Eigen::Affine3d &world,
                 const vcg::fcd::DeformerParam &param, const vcg::fcd::Progress &progress = {});
    const std::shared_ptr<Prepared> &prepared() const { return found; }
    /// Releases the deformer.
    void forget() { found.reset(); }

    /// Sets the motions of handles, world units.
    void takeMotions(std::map<vcg::fcd::Index, vcg::fcd::Motion> motion) { handles.motion = std::move(motion); }

    /// If set, solves poses from rest instead of the deformer (which poses by the motions that were read).
    using Solve = std::function<vcg::fcd::Deformer::Pose(const vcg::fcd::Deformer &, const vcg::fcd::DeformationParam &,
                                                         const vcg::fcd::Progress &)>;
    void solveBy(Solve other) { solveOtherwise = std::move(other); }

    /// The pose from rest, until it is at rest.
    vcg::fcd::Deformer::Pose solve(const vcg::fcd::DeformationParam &param,
                                   const vcg::fcd::Progress &progress = {}) const;
    /// The pose after some iterations, from \p last if its motions are near, or else from rest.
    vcg::fcd::Deformer::Pose solveFrom(const vcg::fcd::Deformer::Pose *last,
                                       const vcg::fcd::DeformationParam &param) const;

  private:
    bool prepare(std::uint64_t faces, const vcg::fcd::DeformerParam &param, const vcg::fcd::Progress &progress);
    void prepareRead(const vcg::fcd::SurfaceView &read, const vcg::fcd::DeformerParam &param,
                     const vcg::fcd::Progress &progress);
    bool prepareWithNodesOf(const MeshModel *graph, vcg::fcd::DeformationParam &param,
                            const vcg::fcd::Progress &progress, vcg::fcd::Index &nodes);
    void readSurface();

    MeshDocument &document;
    MeshModel &layer;
    const int number; ///< of the layer
    PreparedLayers &preparedLayers;
    Remark remark;
    const Point3m *rest = nullptr;   ///< positions per vertex slot; null: the layer is at rest
    vcg::fcd::SurfaceArrays surface; ///< of the layer at rest, once read
    vcg::fcd::Handles handles;
    std::shared_ptr<Prepared> found;
    Solve solveOtherwise; ///< may be empty
};

/// Writes the positions and normals of moving vertices. \param position, normal at rest, per vertex slot
void writeMoving(CMeshO &mesh, const Point3m *position, const Point3m *normal, const Prepared &prepared,
                 const vcg::fcd::Deformer::Pose &pose);

/// Writes a pose, and the box, into the layer. Vertices that do not move get their rest positions, and all normals are
/// at rest if nothing moves. \param turnNormals turns normals of moving vertices; otherwise they are left as they were
/// \return whether anything moves
bool writePose(CMeshO &mesh, RestShape &rest, const Prepared &prepared, const vcg::fcd::Deformer::Pose &pose,
               bool turnNormals);

/// FCD: Reset Pose: restores the rest shape of \p layer, to the bit; the one before if it has that already; or the
/// first of all. Or makes the present shape the rest shape. \throw vcg::fcd::Error the layer has no rest shape, or not
/// all of its vertices belong to it
void resetPose(const MeshDocument &document, MeshModel &layer, const ResetPoseParam &param, const Remark &remark);

#endif
