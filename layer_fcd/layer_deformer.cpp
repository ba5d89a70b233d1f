// SPDX-License-Identifier: GPL-3.0-or-later
#include "angle_normals.h"
#include "new_layers.h"
#include "inherited.h"
#include "kept_graph.h"
#include "layer_contents.h"
#include "layer_deformer.h"
#include "layer_normals.h"
#include "handle_sources.h"

#include <algorithm>
#include <new>

using vcg::fcd::DeformationParam;
using vcg::fcd::Deformer;
using vcg::fcd::DeformerParam;
using vcg::fcd::Error;
using vcg::fcd::Progress;
using vcg::fcd::Stopwatch;

LayerDeformer::LayerDeformer(MeshDocument &document, MeshModel &layer, PreparedLayers &preparedLayers, Remark remark)
    : document(document), layer(layer), number(layer.id()), preparedLayers(preparedLayers),
      remark(remark ? std::move(remark) : [](const std::string &) {}) {
    preparedLayers.follow(document);
}

// --- the steps ---

/// Reads the surface into arrays, once.
void LayerDeformer::readSurface() {
    surface = rest ? vcg::tri::ReadSurface(layer.cm, {}, [this](std::size_t slot) { return rest[slot]; })
                   : vcg::tri::ReadSurface(layer.cm);
}

void LayerDeformer::prepare(const vcg::fcd::SurfaceView &read, std::vector<int> tag, const Eigen::Affine3d &world,
                            const DeformerParam &param, const Progress &progress) {
    handles = {};
    handles.tag = std::move(tag);
    handles.world = world;
    prepareRead(read, param, progress);
}

/// Finds the deformer for the handles, or reads the layer and prepares it. \return whether it was prepared anew
bool LayerDeformer::prepare(std::uint64_t faces, const DeformerParam &param, const Progress &progress) {
    found = preparedLayers.find(PreparedLayers::keyOf(layer.cm, rest, faces, handles, param));
    if (found)
        return false;
    readSurface();
    prepareRead(surface.View(), param, progress);
    surface = {};
    return true;
}

/// The same for a surface that has been read.
void LayerDeformer::prepareRead(const vcg::fcd::SurfaceView &read, const DeformerParam &param,
                                const Progress &progress) {
    const PreparedLayers::Key key = PreparedLayers::keyOf(read, handles, param);
    found = preparedLayers.find(key);
    if (!found)
        found = preparedLayers.add(key, document, number, read, handles, param, progress);
}

/// Prepares the deformer with the vertices of a graph layer as nodes. If these are the nodes that the parameters make
/// anyway, it is prepared without them, and has the patches of that graph, too.
/// \param param out: its nodes are set if they are used \param nodes out: number of vertices of the layer
/// \return whether the graph is that of the parameters
bool LayerDeformer::prepareWithNodesOf(const MeshModel *graph, DeformationParam &param, const Progress &progress,
                                       vcg::fcd::Index &nodes) {
    DeformationParam given = param;
    given.nodes = readNodes(layer, graph);
    nodes = vcg::fcd::Index(given.nodes.cols());
    if (!isGraph(document, *graph)) {
        param = std::move(given);
        prepareRead(surface.View(), param, progress);
        return false;
    }
    // Do not prepare again if it is known that the nodes are others.
    found = preparedLayers.find(PreparedLayers::keyOf(surface.View(), handles, given));
    if (!found || !found->isOfOthers) {
        prepareRead(surface.View(), param, progress);
        if (vcg::fcd::HasNodes(*found->deformer, given.nodes))
            return true;
        prepareRead(surface.View(), given, progress);
        found->isOfOthers = true;
    }
    param = std::move(given);
    return false;
}

Deformer::Pose LayerDeformer::solve(const DeformationParam &param, const Progress &progress) const {
    return solveOtherwise ? solveOtherwise(*found->deformer, param, progress)
                          : found->deformer->Solve(handles, param, progress);
}

Deformer::Pose LayerDeformer::solveFrom(const Deformer::Pose *last, const DeformationParam &param) const {
    const Deformer &deformer = *found->deformer;
    vcg::fcd::HeldMotions motions = deformer.MotionsOf(handles, param.pose);
    if (deformer.StepsTo(motions, last ? &last->given : nullptr) > 1)
        return solve(param);
    return deformer.Solve(std::move(motions), param, last);
}

// --- FCD: Deform Mesh ---

DeformedLayers LayerDeformer::deform(DeformMeshParam param, bool replaceEarlier, const Progress &progress) {
    const bool inWindow = host::inWindow();
    DeformedLayers made;
    vcg::fcd::DeformationResult &result = made.result;
    handles = readHandles(layer, rest, param.handles, remark);
    param.deformation.linear = hasDirections(layer);
    readSurface();
    if (param.useGraphLayer)
        made.isOwnGraph =
            prepareWithNodesOf(param.graphLayer, param.deformation, progress.Slice(0, 0.7), made.givenNodes);
    else
        prepareRead(surface.View(), param.deformation, progress.Slice(0, 0.7));
    const bool moves = readMotions(document, layer, rest, param.handles, found->deformer->center, remark, handles);
    if (inWindow && (!moves || param.deformation.pose == 0))
        throw Error(
            "Nothing would move. Give a translation, a rotation (an angle that is not 0), a matrix, a layer that lies "
            "elsewhere or a motion as text, and a pose that is not 0.");
    result.position = surface.View().Copy();
    const vcg::fcd::NormalOf normal = vcg::tri::NormalsOf(layer.cm);
    if (param.stopAtContact) {
        const auto at = [&](double percent, const Progress &part) {
            DeformationParam some = param.deformation;
            some.pose = percent;
            return solve(some, part);
        };
        const double free = vcg::fcd::PercentToContact(surface.View(), *found->deformer, at, param.deformation,
                                                       progress.Slice(0.7, 0.85));
        made.isStopped = free != param.deformation.pose;
        param.deformation.pose = free;
    }
    made.percent = param.deformation.pose;
    const auto solved = [&](const Progress &part) { return solve(param.deformation, part); };
    vcg::fcd::PoseSurface(surface.View(), normal, handles, *found->deformer, solved, param.deformation,
                          progress.Slice(param.stopAtContact ? 0.85 : 0.7, 0.9), result);
    surface = {};
    result.secondsGraph = found->seconds;
    result.tags = found->tags;

    const Progress adding = progress.Slice(0.9, 1);
    adding(0, "Adding layers...");
    std::vector<MeshModel *> earlier;
    if (replaceEarlier)
        earlier = earlierResults(document, layer);
    earlier.erase(std::remove(earlier.begin(), earlier.end(), param.graphLayer), earlier.end()); // it is being used
    made.replaced = int(earlier.size());
    NewLayers layers(document, layer, remark, earlier);
    static const std::vector<float> none;
    std::vector<float> depth(result.contact.depth.begin(), result.contact.depth.end());
    if (depth.empty()) // there is no contact
        depth.assign(std::size_t(result.position.cols()), 0);
    made.layers = layers.addResult("deformed", result,
                                   param.quality == DeformMeshParam::Stretch    ? result.stretch
                                   : param.quality == DeformMeshParam::Rotation ? result.rotation
                                   : param.quality == DeformMeshParam::Contact  ? depth
                                                                                : none,
                                   param.graphLayers ? found : nullptr);
    if (param.displacement)
        layers.addDisplacement(*made.layers.back(), result.position);
    layers.keep(*made.layers.back(), adding);
    if (inWindow) // show the result, which the next try replaces
        showResult(document, layer, made.layers);
    return made;
}

// --- FCD: Pose in Place ---

PoseResult LayerDeformer::pose(const PoseParam &param, const Progress &progress) {
    CMeshO &mesh = layer.cm;
    PoseResult result;
    Stopwatch watch;
    progress(0, "Reading the layer");
    const bool isFirst = !RestShape::exists(layer);
    if (!isFirst)
        RestShape(layer).checkVertices("A pose would undo that. Run 'FCD: Reset Pose' (apply_coord_fcd_reset) with "
                                       "'Keep the present shape' (keep_shape): poses then begin from the shape that "
                                       "the layer has now.",
                                       remark);
    rest = isFirst ? nullptr : RestShape(layer).positions();
    handles = readHandles(layer, rest, param.handles, remark);
    const std::uint64_t faces = isFirst ? facesOf(mesh) : RestShape(layer).followFaces();
    result.prepared = prepare(faces, param.deformation, progress.Slice(0, 0.9));
    result.secondsPrepare = found->seconds;
    result.secondsFind = watch.Seconds() - (result.prepared ? found->seconds : 0);
    result.tags = found->tags;

    watch = {};
    readMotions(document, layer, rest, param.handles, found->deformer->center, remark, handles);
    const Deformer::Pose pose = solve(param.deformation, progress.Slice(0.9, 1));
    result.nodes = int(found->deformer->Nodes());
    result.iterations = pose.iterations;
    result.converged = pose.converged;
    result.discretisationError = found->deformer->DiscretisationError(pose, param.deformation);
    result.path = pose.path;
    result.secondsSolve = watch.Seconds();

    progress(1, "Done"); // the rest cannot be cancelled
    watch = {};
    try { // allocates all memory before the first vertex is moved
        if (isFirst)
            RestShape::keep(document, layer);
        else
            handDownRest(document, layer);
        RestShape restShape(layer);
        const bool ofFaces = param.exactNormals && mesh.fn > 0 && !restShape.hasOwnNormals();
        FlaggedFaces flagged(ofFaces ? mesh.vert.size() : 0, ofFaces ? mesh.face.size() : 0);
        if (ofFaces && found->turning.empty())
            found->turning = verticesBeside(mesh, found->moving);
        const bool moved = writePose(mesh, restShape, *found, pose, !ofFaces);
        result.secondsMap = watch.Seconds();

        watch = {};
        if (ofFaces && moved)
            computeFlaggedNormals(mesh, found->turning, flagged);
        else
            computeFaceNormals(mesh, found->moving);
        restShape.knowNormals();
        result.secondsNormals = watch.Seconds();
        if (param.contact && moved && mesh.fn > 0) {
            rest = restShape.positions();
            readSurface();
            result.contact =
                vcg::fcd::ContactOf(surface.View(), *found->deformer, positionsOf(layer), param.deformation);
        }
    } catch (const std::bad_alloc &) {
        if (LayerState *state = LayerState::of(layer); state && isFirst)
            state->rest.reset();
        throw;
    }
    return result;
}
