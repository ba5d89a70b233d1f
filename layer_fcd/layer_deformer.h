// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_DEFORMER_H
#define FCD_LAYER_DEFORMER_H

#include "parameters.h"
#include "pose_in_place.h"
#include "prepared_layers.h"

#include <functional>
#include <map>
#include <memory>
#include <vector>

/// What FCD: Deform Mesh did.
struct DeformedLayers {
    vcg::fcd::DeformationResult result;
    std::vector<MeshModel *> layers; ///< the new ones, the deformed one last
    double percent = 0;              ///< how much of the motion was carried out
    bool isStopped = false;          ///< at contact, before all that was asked for
    int replaced = 0;                ///< number of layers of an earlier try that were deleted
    bool isOwnGraph = false;         ///< the graph layer is the graph that the parameters make
    vcg::fcd::Index givenNodes = 0;  ///< of the graph layer
};

/// What posing a layer in place did.
struct PoseResult {
    int nodes = 0, iterations = 0;
    bool converged = false;
    double discretisationError = 0; ///< as Deformer::DiscretisationError gives it
    vcg::fcd::PoseWay way;
    vcg::fcd::TagCount tags;
    vcg::fcd::SurfaceContact contact; ///< where it was asked for
    bool prepared = false;            ///< anew
    double secondsFind = 0, secondsPrepare = 0, secondsSolve = 0, secondsMap = 0, secondsNormals = 0;
};

/// Deforms a layer, for a filter or for the tool: reads what holds it, finds or prepares its deformer, reads how
/// handles move. deform() and pose() are the filters. Their steps follow in their order, for callers that have tags and
/// motions.
class LayerDeformer {
  public:
    /// \param preparedLayers where deformers are found, and kept \param remark may be empty
    LayerDeformer(MeshDocument &document, MeshModel &layer, PreparedLayers &preparedLayers, Remark remark = {});

    /// FCD: Deform Mesh: the result is in new layers. \param replaceEarlier deletes those of the try before
    /// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document is then as it was
    DeformedLayers deform(DeformMeshParam param, bool replaceEarlier, const vcg::fcd::Progress &progress);

    /// FCD: Pose in Place: gives the layer's vertices the positions that the deformation of its rest shape has, and
    /// turns the normals. The first time, the present shape is the rest shape, which the layer keeps from then on.
    /// \throw vcg::fcd::Error when the layer was changed since its last pose, or as above
    /// \throw vcg::fcd::Cancelled; the layer is then as it was
    PoseResult pose(const PoseParam &param, const vcg::fcd::Progress &progress);

    // --- the steps ---

    /// Reads tags and point handles. \throw vcg::fcd::Error when they cannot be had
    void readHandles(const HandleParam &param);
    /// Finds what is prepared for these, or prepares it. \return whether it was prepared anew
    /// \throw vcg::fcd::Error no handle, nothing free, ... \throw vcg::fcd::Cancelled
    bool prepare(const vcg::fcd::DeformerParam &param, const vcg::fcd::Progress &progress = {});
    /// The same for arrays of the layer at rest, with the matrix \p world. It reads neither layer nor document, so it
    /// can run beside the window. \param tag one per vertex slot
    void prepare(const vcg::fcd::SurfaceView &surface, std::vector<int> tag, const Eigen::Affine3d &world,
                 const vcg::fcd::DeformerParam &param, const vcg::fcd::Progress &progress = {});
    const std::shared_ptr<Prepared> &prepared() const { return found; }
    /// Lets go of what was prepared.
    void forget() { found.reset(); }

    /// Reads the motions. \return whether any handle moves
    bool readMotions(const HandleParam &param);
    /// Takes the motions of handles, in world coordinates.
    void takeMotions(std::map<vcg::fcd::Index, vcg::fcd::Motion> motion) { handles.motion = std::move(motion); }

    /// Solves poses from rest instead of the deformer, which goes to the motions that were read.
    using Solve = std::function<vcg::fcd::Deformer::Pose(const vcg::fcd::Deformer &, const vcg::fcd::DeformationParam &,
                                                         const vcg::fcd::Progress &)>;
    void solveBy(Solve other) { solveOtherwise = std::move(other); }

    /// The pose from rest to the end.
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
    vcg::fcd::SurfaceContact contactNow(const vcg::fcd::DeformerParam &param) const;

    MeshDocument &document;
    MeshModel &layer;
    const int number; ///< of the layer
    PreparedLayers &preparedLayers;
    Remark remark;
    const Point3m *rest = nullptr;   ///< positions per vertex slot, null where the layer is at rest
    vcg::fcd::SurfaceArrays surface; ///< of the layer at rest, once it has been read
    vcg::fcd::Handles handles;
    std::shared_ptr<Prepared> found;
    Solve solveOtherwise; ///< may be empty
};

#endif
