// SPDX-License-Identifier: GPL-3.0-or-later
#include "fcd_layers.h"
#include "fcd_aside.h"
#include "fcd_copy.h"
#include "fcd_deformation_file.h"
#include "fcd_parameters.h"
#include "fcd_pose.h"
#include "fcd_rest.h"
#include "fcd_tags.h"
#include "filter_fcd.h"

#include <sstream>

using vcg::fcd::Error;
using vcg::fcd::Progress;

using vcg::fcd::HasNodes;
using vcg::tri::PoseMesh;
using vcg::tri::PrepareDeformer;

namespace {

const char *const reference = "<br>Method: A. Morsucci, M. Centin, A. Signoroni, <i>Fast centroidal deformation for "
                              "large mesh models</i>, STAG 2018 "
                              "(<a href='https://doi.org/10.2312/stag.20181302'>doi:10.2312/stag.20181302</a>)";

/// The current layer. \throw Error when there is none or it is empty
MeshModel &input(MeshDocument &document) {
    MeshModel *layer = document.mm();
    if (!layer)
        throw Error("There is no layer. Open a mesh first.");
    if (layer->cm.vn == 0)
        throw Error("The layer '" + layer->label().toStdString() +
                    "' has no vertices. Make the mesh the current layer.");
    return *layer;
}

/// What the surface is like, in words. Mentions only what was met.
std::string describe(const vcg::fcd::SurfaceReport &surface) {
    std::ostringstream line;
    line << (surface.pointCloud ? "Point cloud" : "Surface") << " of " << surface.vertices << " vertices";
    const auto mention = [&](vcg::fcd::Index count, const char *what) {
        if (count > 0)
            line << ", " << count << " " << what;
    };
    mention(surface.components, surface.components == 1 ? "connected part" : "connected parts");
    mention(surface.welded, "vertices at the place of another (treated as one)");
    mention(surface.seams, "on borders a hair from another (treated as one)");
    mention(surface.isolated, "isolated vertices");
    mention(surface.nonManifoldEdges, "non-manifold edges");
    mention(surface.degenerateFaces, "degenerate faces");
    return line.str() + ".";
}

/// What describe() tells, for scripts.
HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::SurfaceReport &surface) {
    return {{"components", surface.components},           {"welded_vertices", surface.welded},
            {"joined_vertices", surface.seams},           {"gap_vertices", surface.gaps},
            {"isolated_vertices", surface.isolated},      {"non_manifold_edges", surface.nonManifoldEdges},
            {"degenerate_faces", surface.degenerateFaces}};
}

std::string describe(const vcg::fcd::TagCount &tags) {
    std::ostringstream line;
    line << tags.fixed << " fixed, " << tags.handle << " handle, " << tags.free << " free, " << tags.outside
         << " outside vertices";
    return line.str();
}

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::TagCount &tags) {
    return {{"fixed_vertices", tags.fixed},
            {"handle_vertices", tags.handle},
            {"free_vertices", tags.free},
            {"outside_vertices", tags.outside}};
}

/// A sentence for each thing that is probably not meant.
std::vector<std::string> describe(const vcg::fcd::DeformationCheck &check, vcg::fcd::Index gaps) {
    std::vector<std::string> warnings;
    const auto count = [](vcg::fcd::Index n, const char *one, const char *many) {
        return std::to_string(n) + " " + (n == 1 ? one : many);
    };
    if (check.rigid)
        warnings.emplace_back("All that the free surface touches makes the same motion, so it moves rigidly with that. "
                              "Mark what stays as fixed (tag 0), beside what is free.");
    if (gaps > 3)
        warnings.push_back(
            std::to_string(gaps) +
            " vertices on open borders lie closer to another border than a tenth of their edges, and "
            "nothing joins the two: such a slit may open. To close it, use 'Merge Close Vertices' first" +
            (host::scriptsMayLackParameters ? ", or raise weld_distance." : "."));
    if (check.overruled > 0)
        warnings.push_back(
            count(check.overruled, "handle vertex is", "handle vertices are") +
            " at the same place as a fixed vertex, or one of a handle with a smaller number, and held as "
            "that one. Give all vertices at a place the same tag.");
    if (check.strained > 0) {
        std::ostringstream line;
        line << count(check.strained, "edge leads", "edges lead")
             << " straight from one held region to another that moves otherwise, and stretched or shrunk to less than "
                "half or more than twice the length (the longest: "
             << check.longest << " times). Leave free vertices between them.";
        warnings.push_back(line.str());
    }
    if (check.folded > 0)
        warnings.push_back(count(check.folded, "triangle has", "triangles have") +
                           " turned over: the surface is squeezed or twisted too much there. Move the handles less, or "
                           "leave more free surface between them.");
    return warnings;
}

} // namespace

FilterFcd::FilterFcd() {
    announce({BuildGraph, DeformMesh, PoseInPlace, ResetPose, CopyDeformation, SaveDeformation, TagSelection,
              TagsFromFiles, ClearTags, SaveTags});
}

QString FilterFcd::name() const { return "FilterFCD"; }

QString FilterFcd::filterName(int id) const {
    switch (id) {
    case BuildGraph: return "FCD: Build Deformation Graph";
    case DeformMesh: return "FCD: Deform Mesh";
    case PoseInPlace: return "FCD: Pose in Place";
    case ResetPose: return "FCD: Reset Pose";
    case CopyDeformation: return "FCD: Apply Deformation to Layer";
    case SaveDeformation: return "FCD: Save Deformation";
    case TagSelection: return "FCD: Tag Selection";
    case TagsFromFiles: return "FCD: Tags from Files";
    case ClearTags: return "FCD: Clear Tags";
    case SaveTags: return "FCD: Save Tags";
    }
    return QString();
}

QString FilterFcd::scriptName(int id) const {
    switch (id) {
    case BuildGraph: return "generate_fcd_deformation_graph";
    case DeformMesh: return "generate_fcd_deformed_mesh";
    case PoseInPlace: return "apply_coord_fcd_deformation";
    case ResetPose: return "apply_coord_fcd_reset";
    case CopyDeformation: return "generate_fcd_deformed_copy";
    case SaveDeformation: return "save_fcd_deformation";
    case TagSelection: return "compute_fcd_tags_from_selection";
    case TagsFromFiles: return "compute_fcd_tags_from_files";
    case ClearTags: return "clear_fcd_tags";
    case SaveTags: return "save_fcd_tags";
    }
    return QString();
}

QString FilterFcd::filterInfo(int id) const {
    switch (id) {
    case BuildGraph:
        return QString(
                   "Divides the surface into a few hundred round patches of similar size and connects the centres of "
                   "neighbouring patches: this is the <b>deformation graph</b> that 'FCD: Deform Mesh' bends in place "
                   "of "
                   "the mesh, which makes the time it takes to bend independent of the size of the mesh.<br>"
                   "'FCD: Deform Mesh' builds such a graph by itself; this filter is for looking at it, and for using "
                   "one "
                   "graph several times.<br>"
                   "Works on any mesh and on point clouds. The current layer is not changed. New layers: the graph (a "
                   "vertex per patch at its centre, quality = radius of the patch, in the colour of the patch, and an "
                   "edge "
                   "between neighbours) and, if wanted, the mesh coloured by patch.") +
               reference;
    case DeformMesh:
        return shown() +
               QString(
                   "Bends a mesh of any size smoothly, with all its detail. Mark what <b>stays</b> fixed and one or "
                   "more "
                   "<b>handles</b> (with 'FCD: Tag Selection', or select vertices of the handle and faces that stay), "
                   "say how the handles move, and the rest follows; fixed vertices stay to the bit. Works on scans as "
                   "they are (unwelded, non-manifold, in pieces) and on point clouds; the result is a new layer with "
                   "all that the mesh carries. Motions are in world coordinates. Pose, warp or bend a mesh; as rigid "
                   "as possible (ARAP).") +
               reference;
    case PoseInPlace:
        return QString(
                   "Bends the current layer itself, as 'FCD: Deform Mesh' bends a copy of it: tick <i>Preview</i> and "
                   "see "
                   "the shape follow while you change a value. The first time the layer is prepared, which takes a "
                   "moment; each further pose takes a fraction of that, also when you come back to the dialog.<br>"
                   "A pose is always one of the <b>rest shape</b>, that which the layer had before its first pose: "
                   "poses "
                   "do not add up, and pose 0 is the rest shape. The layer keeps the rest shape as vertex attributes "
                   "(fcd_rest, fcd_rest_normal); 'FCD: Reset Pose' brings it back. Changes positions and normals, "
                   "nothing else. All motions are in world coordinates. Warp, bend, deform with preview; ARAP.") +
               reference;
    case ResetPose:
        return "Brings a layer that 'FCD: Pose in Place' has bent back to the shape that it had before its first pose, "
               "exactly; or keeps the shape that it has and lets later poses begin from that.";
    case CopyDeformation:
        return QString(
                   "Does to the current layer what 'FCD: Deform Mesh' did to another one in the same space: deform a "
                   "decimated copy, then the full scan with it; or a point cloud, landmarks, a textured version. Each "
                   "vertex follows the nearest place of the source's surface, and what is nearest to something fixed "
                   "stays, to the bit.<br>"
                   "What was done is told by the layers with the graph, in the session that made them, or by a file "
                   "of 'FCD: Save Deformation'.<br>"
                   "The layers are left as they are: the result is a new layer with everything that the layer "
                   "carries.") +
               reference;
    case SaveDeformation:
        return QString(
                   "Writes what 'FCD: Deform Mesh' did to a layer to one small file, for 'FCD: Apply Deformation to "
                   "Layer' in another session, or for points outside of MeshLab.<br>"
                   "The file holds the deformation at some thousand vertices of the source, and the triangles "
                   "between them, in world coordinates. Vertices are added until at none of the source's the file "
                   "differs from the deformation by more than 0.01 percent of the diagonal of what moves (or there "
                   "are 50000; the log says so), and all that was fixed stays, to the bit. It is a binary PLY file: "
                   "any program for meshes shows the "
                   "thinned surface.<br>"
                   "The layers are not changed.") +
               reference;
    case TagSelection:
        return "Says what 'FCD: Deform Mesh' does with the selected part of the mesh: it stays <b>fixed</b>, is "
               "<b>free</b> to follow, is a <b>handle</b> that moves as told, or lies <b>outside</b> the region of "
               "influence.<br>"
               "Select what stays, run this filter as <i>Fixed</i>; select what moves, run it as <i>Handle</i>; then "
               "deform. Selected vertices and the vertices of selected faces count. All else keeps its tag; where the "
               "layer has no tags yet (no quality, or 0 everywhere) all else is free.<br>"
               "Changes the quality, or an attribute, of the current layer and its colours, nothing else.";
    case TagsFromFiles:
        return "Gives the vertices of the current layer the tags of a .sel file, to look at them, to change them with "
               "'FCD: Tag Selection', or for 'FCD: Deform Mesh'.<br>"
               "Changes the quality, or an attribute, of the current layer and its colours, nothing else.";
    case ClearTags:
        return "Gives the current layer back the colours and the quality that it had before it was tagged by 'FCD: Tag "
               "Selection' or 'FCD: Tags from Files'. Where it had none, none is left.";
    case SaveTags:
        return "Writes the tags of the vertices to a .sel file and, if wanted, the motions of the handles to a .def "
               "file. 'FCD: Deform Mesh' with <i>Handles from: Files</i> then deforms as it would with the tags of "
               "the layer and these motions. The layer is not changed.";
    }
    return QString();
}

HostFilterPlugin::FilterClass FilterFcd::menus(int id) const {
    // After a filter of textures the host shows those of the current layer, which is new.
    const int both = int(Smoothing) | int(Texture);
    // NOLINTNEXTLINE(clang-analyzer-optin.core.EnumCastOutOfRange): the host takes it as bits
    return id == DeformMesh || id == CopyDeformation ? FilterClass(both) : Smoothing;
}

int FilterFcd::changes(int id) const {
    const int shape = MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
    switch (id) {
    case PoseInPlace: return shape;
    // A number of vertices that changes means no preview. A preview of this could not be taken back: the host does not
    // restore attributes.
    case ResetPose: return shape | MeshModel::MM_VERTNUMBER;
    case ClearTags: return MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTNUMBER;
    case TagSelection:
    case TagsFromFiles: return MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR;
    }
    return MeshModel::MM_NONE;
}

RichParameterList FilterFcd::parameters(int id, const MeshDocument &document) const {
    RichParameterList list = defaults(id, document);
    if (!host::inWindow())
        return list;
    shownLayer.clear();
    if (MeshModel *current = const_cast<MeshDocument &>(document).mm()) { // the document itself is not changed
        const MeshModel &layer = meant(id, *current, const_cast<MeshDocument &>(document));
        shownLayer = layer.label();
        if (list.hasParameter(handleLayer))
            host::setLayer(list, handleLayer, layer);
        lastValues.recall(id, list, document);
        if (id == DeformMesh || id == PoseInPlace)
            host::setEnum(list, "handles", likelySource(layer, list.getEnum("handles")));
    }
    if (!list.isEmpty())
        prepareDialog(filterName(id), const_cast<MeshDocument &>(document), [this, id] {
            lastValues.forget(id);
            action(id)->trigger();
        });
    return list;
}

/// The layer that a filter is about.
MeshModel &FilterFcd::meant(int id, MeshModel &current, MeshDocument &document) {
    return id == DeformMesh && host::inWindow() ? sourceOf(document, current) : current;
}

QString FilterFcd::shown() const {
    return shownLayer.isEmpty() ? QString() : "<b>Deforms '" + shownLayer.toHtmlEscaped() + "'.</b> ";
}

RichParameterList FilterFcd::defaults(int id, const MeshDocument &document) {
    switch (id) {
    case BuildGraph: return toRichParameters(BuildGraphParam(), document);
    case DeformMesh: return toRichParameters(DeformMeshParam(), document);
    case PoseInPlace: return toRichParameters(PoseParam(), document);
    case ResetPose: return toRichParameters(ResetPoseParam());
    case CopyDeformation: return toRichParameters(CopyParam(), document);
    case SaveDeformation: return toRichParameters(SaveDeformationParam(), document);
    case TagSelection: return toRichParameters(TagSelectionParam());
    case TagsFromFiles: return toRichParameters(TagsFromFilesParam());
    case SaveTags: return toRichParameters(SaveTagsParam(), document);
    }
    return RichParameterList(); // Clear Tags has none
}

HostFilterPlugin::ReturnedValues FilterFcd::run(int id, const RichParameterList &parameters, MeshDocument &document,
                                                vcg::CallBackPos *callback) {
    if (host::inWindow() && document.mm())
        lastValues.keep(id, parameters, document, meant(id, *document.mm(), document));
    switch (id) {
    case BuildGraph: return buildGraph(parameters, document, callback);
    case DeformMesh: return deformMesh(parameters, document, callback);
    case PoseInPlace: return pose(parameters, document, callback);
    case CopyDeformation: return copy(parameters, document, callback);
    case SaveDeformation: return save(parameters, document, callback);
    case ResetPose: resetPose(input(document), resetPoseParam(parameters).keepShape); return {};
    case TagSelection: return report(tagSelection(input(document), tagSelectionParam(parameters)));
    case TagsFromFiles: return report(tagFromFiles(input(document), tagsFromFilesParam(parameters)));
    case ClearTags: bringBack(input(document)); return {};
    case SaveTags:
        return report(saveTags(document, input(document), saveTagsParam(parameters, document),
                               [this](const std::string &line) { logLine(line); }));
    }
    throw Error("Unknown filter.");
}

HostFilterPlugin::ReturnedValues FilterFcd::buildGraph(const RichParameterList &parameters, MeshDocument &document,
                                                       vcg::CallBackPos *callback) {
    MeshModel &layer = input(document);
    const BuildGraphParam param = buildGraphParam(parameters);
    const vcg::fcd::CentroidalGraph graph =
        vcg::tri::BuildCentroidalGraph(layer.cm, param.graph, Progress(callback, 0, 90), metricOf(layer));

    const Progress progress(callback, 90, 100);
    progress(0, "Adding layers...");
    const Remark remark = [this](const std::string &line) { logLine(line); };
    NewLayers layers(document, layer, remark);
    MeshModel &nodes = layers.addGraph("graph", graph.geometry);
    if (param.surfaceLayer)
        layers.addGraphSurface("graph surface", graph.geometry);
    if (param.patchesLayer) {
        MeshModel &patches = layers.addPatches("patches", graph.patchOf, graph.geometry.color);
        if (host::inWindow() && layer.cm.fn > 0)
            patches.clearDataMask(MeshModel::MM_VERTCOLOR); // which it would show, with borders that are blurred
    }
    progress(1, "Done");
    layers.keep(layer);
    if (host::inWindow()) { // one sees what one asked for
        host::setVisible(layer, !param.patchesLayer);
        host::setVisible(nodes, !param.surfaceLayer);
        host::showChanges(document);
    }

    const int patches = int(graph.geometry.position.cols()), edges = int(graph.geometry.edge.size());
    logLine(describe(graph.surface));
    std::ostringstream line;
    line << patches << " patches, " << edges << " edges, patch radius at most " << graph.targetRadius << ", "
         << graph.iterations << " iterations, " << graph.seconds << " s.";
    logLine(line.str());
    if (!graph.converged)
        logLine("The patches did not converge: raise max_iterations if they look uneven.", GLLogStream::WARNING);
    ReturnedValues values = valuesOf(graph.surface);
    values.insert({{"patches", patches},
                   {"edges", edges},
                   {"iterations", graph.iterations},
                   {"converged", graph.converged},
                   {"cost", graph.cost},
                   {"target_radius", graph.targetRadius},
                   {"average_edge", graph.averageEdge},
                   {"seconds", graph.seconds}});
    return values;
}

HostFilterPlugin::ReturnedValues FilterFcd::deformMesh(const RichParameterList &parameters, MeshDocument &document,
                                                       vcg::CallBackPos *callback) {
    const bool inWindow = host::inWindow();
    MeshModel &layer = meant(DeformMesh, input(document), document);
    DeformMeshParam param = deformMeshParam(parameters, document);
    const Remark remark = [this](const std::string &line) { logLine(line); };
    vcg::fcd::Handles handles = readHandles(layer, param.handles);
    param.deformation.linear = hasDirections(layer);
    vcg::fcd::DeformationResult result;

    const auto prepare = [&] {
        return preparedLayers.get(document, layer, nullptr, handles, param.deformation, [&] {
            return PrepareDeformer(layer.cm, handles, param.deformation, result.position, Progress(callback, 0, 70));
        });
    };
    std::shared_ptr<Prepared> prepared;
    Eigen::Matrix3Xd given;
    bool isOwnGraph = false; // that the parameters make, which has its patches, too
    if (param.useGraphLayer) {
        given = readNodes(layer, param.graphLayer);
        if (isGraph(*param.graphLayer)) {
            prepared = prepare();
            isOwnGraph = HasNodes(*prepared->deformer, given);
        }
        if (!isOwnGraph)
            param.deformation.nodes = given;
    }
    if (!isOwnGraph)
        prepared = prepare();
    if (result.position.cols() == 0)
        result.position = positionsOf(layer);
    const bool moves = readMotions(document, layer, param.handles, prepared->deformer->center, remark, handles);
    if (inWindow && (!moves || param.deformation.pose == 0))
        throw Error(
            "Nothing would move. Give a translation, a rotation (an angle that is not 0), a matrix, a layer that lies "
            "elsewhere or a motion as text, and a pose that is not 0.");
    PoseMesh(layer.cm, handles, *prepared->deformer, param.deformation, Progress(callback, 70, 90), result);
    result.secondsGraph = prepared->seconds;
    result.tags = prepared->tags;

    const Progress progress(callback, 90, 100);
    progress(0, "Adding layers...");
    std::vector<MeshModel *> earlier;
    if (inWindow)
        earlier = earlierResults(document, layer);
    earlier.erase(std::remove(earlier.begin(), earlier.end(), param.graphLayer), earlier.end()); // may be used again
    NewLayers layers(document, layer, remark, earlier);
    const std::vector<float> none;
    const std::vector<MeshModel *> results = addResult(layers, layer, prepared, result, param.graphLayers,
                                                       param.quality == DeformMeshParam::Stretch    ? result.stretch
                                                       : param.quality == DeformMeshParam::Rotation ? result.rotation
                                                                                                    : none);
    const MeshModel &deformed = *results.back();
    progress(1, "Done");
    layers.keep(deformed);
    if (inWindow) { // one sees what one asked for, and the next try takes its place
        showResult(document, layer, results);
        logLine((earlier.empty() ? std::string()
                                 : std::to_string(earlier.size()) + " layers of the last try are replaced. ") +
                "'" + deformed.label().toStdString() + "' is shown, '" + layer.label().toStdString() +
                "' and the graphs are hidden. Another try deforms '" + layer.label().toStdString() +
                "' again and replaces this result: rename a result to keep it.");
    }

    const int nodes = int(result.rest.position.cols());
    logLine(describe(result.surface));
    std::ostringstream line;
    line << describe(result.tags) << "; " << nodes << " nodes, " << result.iterations << " iterations; "
         << result.secondsGraph << " s for the graph, " << result.secondsSolve << " s to bend it, " << result.secondsMap
         << " s for the mesh.";
    logLine(line.str());
    if (result.looseParts > 0)
        logLine(std::to_string(result.looseParts) + (result.looseParts == 1 ? " part is" : " parts are") +
                " loose (no fixed or handle vertex): " +
                (param.deformation.looseParts == vcg::fcd::LooseParts::Follow ? "following the nearest held part."
                                                                              : "staying in place."));
    if (isOwnGraph)
        logLine("'" + param.graphLayer->label().toStdString() +
                "' is the graph that these parameters make here: used with the patches that it was made with.");
    else if (param.useGraphLayer)
        logLine(std::to_string(result.placedNodes) + " of the " + std::to_string(given.cols()) + " nodes of '" +
                param.graphLayer->label().toStdString() + "' lie on the surface" +
                (result.placedNodes < given.cols() ? "; the others are left out." : ".") +
                " Their patches are grown anew.");
    for (const std::string &warning : describe(result.check, result.surface.gaps))
        logLine(warning, GLLogStream::WARNING);
    warnUnlessAtRest(result.converged);
    ReturnedValues values = valuesOf(result.surface);
    values.merge(valuesOf(result.tags));
    values.insert({{"loose_parts", result.looseParts},
                   {"folded_triangles", result.check.folded},
                   {"strained_edges", result.check.strained},
                   {"nodes", nodes},
                   {"iterations", result.iterations},
                   {"converged", result.converged},
                   {"energy", result.energy},
                   {"seconds_graph", result.secondsGraph},
                   {"seconds_solve", result.secondsSolve},
                   {"seconds_map", result.secondsMap}});
    return values;
}

HostFilterPlugin::ReturnedValues FilterFcd::pose(const RichParameterList &parameters, MeshDocument &document,
                                                 vcg::CallBackPos *callback) {
    const PoseResult result = poseInPlace(
        document, input(document), poseParam(parameters, document), preparedLayers,
        [this](const std::string &line) { logLine(line); }, Progress(callback));
    std::ostringstream line;
    line << describe(result.tags) << "; " << result.nodes << " nodes, " << result.iterations << " iterations; "
         << (result.prepared ? "prepared in " : "already prepared, found in ")
         << (result.prepared ? result.secondsPrepare : result.secondsFind) << " s, " << result.secondsSolve
         << " s to bend the graph, " << result.secondsMap + result.secondsNormals << " s for the mesh.";
    logLine(line.str());
    warnUnlessAtRest(result.converged);
    ReturnedValues values = valuesOf(result.tags);
    values.insert({{"nodes", result.nodes},
                   {"iterations", result.iterations},
                   {"converged", result.converged},
                   {"prepared", result.prepared},
                   {"seconds_find", result.secondsFind},
                   {"seconds_prepare", result.secondsPrepare},
                   {"seconds_solve", result.secondsSolve},
                   {"seconds_map", result.secondsMap},
                   {"seconds_normals", result.secondsNormals}});
    return values;
}

HostFilterPlugin::ReturnedValues FilterFcd::copy(const RichParameterList &parameters, MeshDocument &document,
                                                 vcg::CallBackPos *callback) {
    MeshModel &current = input(document);
    const CopyParam param = copyParam(parameters, document);
    std::vector<MeshModel *> targets(1, &current);
    if (param.allVisible) {
        targets.clear();
        for (const MeshModel *layer : host::layers(document))
            if (layer->isVisible() && layer->cm.vn > 0 &&
                (!param.file.isEmpty() ||
                 (layer != param.source && layer != param.restGraph && layer != param.deformedGraph)))
                targets.push_back(const_cast<MeshModel *>(layer));
        if (targets.empty())
            throw Error("No layer but the source and its graphs is visible. Show those that are to be deformed.");
    }
    const int vertices = copyDeformation(
        document, param, targets, [this](const std::string &line) { logLine(line); }, Progress(callback));
    const int layers = int(targets.size());
    logLine(std::to_string(layers) + (layers == 1 ? " layer of " : " layers of ") + std::to_string(vertices) +
            " vertices deformed as '" + (param.file.isEmpty() ? param.source->label() : param.file).toStdString() +
            "'.");
    return {{"layers", layers}, {"vertices", vertices}};
}

HostFilterPlugin::ReturnedValues FilterFcd::save(const RichParameterList &parameters, const MeshDocument &document,
                                                 vcg::CallBackPos *callback) {
    const vcg::fcd::SampledField field =
        saveDeformation(saveDeformationParam(parameters, document), Progress(callback));
    const int samples = field.samples.Size();
    std::ostringstream line;
    line << samples << " samples; the vertices of the source that move are off by " << field.rms << " (rms), at most "
         << field.largest << ".";
    logLine(line.str());
    if (field.off + field.stirred > 0)
        logLine(std::to_string(field.off + field.stirred) +
                    " vertices of the source are farther off than 0.01 percent: parts that lie at one place move "
                    "differently there, or there are more of them than a small file can tell apart. Where that "
                    "matters, deform with the layers.",
                GLLogStream::WARNING);
    return {{"samples", samples}, {"rms_difference", field.rms}, {"largest_difference", field.largest}};
}

void FilterFcd::warnUnlessAtRest(bool converged) const {
    if (!converged)
        logLine("The deformation did not come to rest: raise max_iterations, or tolerance, or move the handles less at "
                "a time.",
                GLLogStream::WARNING);
}

HostFilterPlugin::ReturnedValues FilterFcd::report(const vcg::fcd::TagCount &tags) const {
    logLine(describe(tags) + ".");
    return valuesOf(tags);
}

// What moc makes of the headers: compiled here, it does not include all of MeshLab once more.
#include "moc_filter_fcd.cpp"   // NOLINT(bugprone-suspicious-include)
#include "moc_meshlab_host.cpp" // NOLINT(bugprone-suspicious-include)
