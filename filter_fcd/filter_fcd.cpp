// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_fcd.h"
#include "filter_parameters.h"
#include "filter_reports.h"

#include <layer_fcd/deformed_copies.h>
#include <layer_fcd/graph_layer.h>
#include <layer_fcd/kept_aside.h>
#include <layer_fcd/layer_deformer.h>
#include <layer_fcd/layer_fitter.h>
#include <layer_fcd/layer_straightener.h>
#include <layer_fcd/layer_symmetrizer.h>
#include <layer_fcd/results.h>
#include <layer_fcd/saved_deformation.h>
#include <layer_fcd/tagging.h>

#include <sstream>

using vcg::fcd::Error;
using vcg::fcd::Progress;

namespace {

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

/// "3 steps, ", where there are several.
std::string inSteps(const vcg::fcd::PoseWay &way) {
    return way.steps > 1 ? std::to_string(way.steps) + " steps, " : std::string();
}

} // namespace

FilterFcd::FilterFcd() {
    announce({BuildGraph, DeformMesh, FitMesh, StraightenMesh, Symmetrize, PoseSequence, PoseInPlace, ResetPose,
              CopyDeformation, SaveDeformation, TagSelection, TagsFromFiles, ClearTags, SaveTags, SaveSession,
              LoadSession});
}

QString FilterFcd::name() const { return "FilterFCD"; }

HostFilterPlugin::FilterClass FilterFcd::menus(int id) const {
    // After a filter of textures the host shows those of the current layer, which is new.
    const int both = int(Smoothing) | int(Texture);
    // NOLINTNEXTLINE(clang-analyzer-optin.core.EnumCastOutOfRange): the host takes it as bits
    return id == DeformMesh || id == FitMesh || id == StraightenMesh || id == Symmetrize || id == PoseSequence ||
                   id == CopyDeformation
               ? FilterClass(both)
               : Smoothing;
}

int FilterFcd::changes(int id) const {
    const int shape = MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
    switch (id) {
    case PoseInPlace: return shape;
    // A number of vertices that changes means no preview. A preview of this could not be taken back: the host does not
    // restore attributes.
    case ResetPose: return shape | MeshModel::MM_VERTNUMBER;
    case LoadSession: return shape | MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTNUMBER;
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
    case FitMesh: return toRichParameters(FitMeshParam(), document);
    case StraightenMesh: return toRichParameters(StraightenMeshParam(), document);
    case Symmetrize: return toRichParameters(SymmetrizeParam(), document);
    case PoseSequence: return toRichParameters(SequenceParam(), document);
    case PoseInPlace: return toRichParameters(PoseParam(), document);
    case ResetPose: return toRichParameters(ResetPoseParam());
    case CopyDeformation: return toRichParameters(CopyParam(), document);
    case SaveDeformation: return toRichParameters(SaveDeformationParam(), document);
    case TagSelection: return toRichParameters(TagSelectionParam());
    case TagsFromFiles: return toRichParameters(TagsFromFilesParam());
    case SaveTags: return toRichParameters(SaveTagsParam(), document);
    case SaveSession:
    case LoadSession: return sessionParameters(id == SaveSession);
    }
    return RichParameterList(); // Clear Tags has none
}

HostFilterPlugin::ReturnedValues FilterFcd::run(int id, const RichParameterList &parameters, MeshDocument &document,
                                                vcg::CallBackPos *callback) {
    const TidyLater tidy(document);
    if (host::inWindow() && document.mm())
        lastValues.keep(id, parameters, document, meant(id, *document.mm(), document));
    const Progress progress(callback);
    MeshModel &layer = input(document);
    switch (id) {
    case BuildGraph: return buildGraph(parameters, document, callback);
    case DeformMesh: return deformMesh(parameters, document, callback);
    case FitMesh: return tell(fitLayer(document, layer, fitMeshParam(parameters, document), toLog(), progress));
    case StraightenMesh:
        return tell(straightenLayer(document, layer, straightenMeshParam(parameters, document), toLog(), progress));
    case Symmetrize: return tell(symmetrizeLayer(document, layer, symmetrizeParam(parameters), toLog(), progress));
    case PoseSequence:
        return tell(
            makeSequence(document, layer, preparedLayers, sequenceParam(parameters, document), toLog(), progress));
    case PoseInPlace: return pose(parameters, document, callback);
    case CopyDeformation: return copy(parameters, document, callback);
    case SaveDeformation: return save(parameters, document, callback);
    case ResetPose: resetPose(document, layer, resetPoseParam(parameters), toLog()); return {};
    case TagSelection: {
        const TagSelectionParam param = tagSelectionParam(parameters);
        return reportTags(layer, tagSelection(document, layer, param), param.target);
    }
    case TagsFromFiles: {
        const TagsFromFilesParam param = tagsFromFilesParam(parameters);
        return reportTags(layer, tagFromFiles(document, layer, param), param.target);
    }
    case ClearTags: return clearTags(document, layer);
    case SaveSession:
    case LoadSession: return session(id, parameters, document, layer);
    case SaveTags: return report(saveTags(document, layer, saveTagsParam(parameters, document), toLog()));
    }
    throw Error("Unknown filter.");
}

HostFilterPlugin::ReturnedValues FilterFcd::buildGraph(const RichParameterList &parameters, MeshDocument &document,
                                                       vcg::CallBackPos *callback) {
    MeshModel &layer = input(document);
    const BuildGraphParam param = buildGraphParam(parameters);
    const vcg::fcd::CentroidalGraph graph = addGraphLayers(document, layer, param, toLog(), Progress(callback));

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
    const DeformMeshParam param = deformMeshParam(parameters, document);
    const DeformedLayers made =
        LayerDeformer(document, layer, preparedLayers, toLog()).deform(param, inWindow, Progress(callback));
    const vcg::fcd::DeformationResult &result = made.result;
    if (inWindow)
        logLine((made.replaced == 0 ? std::string()
                                    : std::to_string(made.replaced) + " layers of the last try are replaced. ") +
                "'" + made.layers.back()->label().toStdString() + "' is shown, '" + layer.label().toStdString() +
                "' and the graphs are hidden. Another try deforms '" + layer.label().toStdString() +
                "' again and replaces this result: rename a result to keep it.");

    const int nodes = int(result.rest.position.cols());
    logLine(describe(result.surface));
    std::ostringstream line;
    line << describe(result.tags) << "; " << nodes << " nodes, " << inSteps(result.pose.way) << result.iterations
         << " iterations; " << result.secondsGraph << " s for the graph, " << result.secondsSolve << " s to bend it, "
         << result.secondsMap << " s for the mesh.";
    logLine(line.str());
    for (const std::string &remark : describe(made, param))
        logLine(remark);
    warn(describe(result.check, result.surface));
    warn(warningsOf(result.contact));
    warnOf(result.pose.way, result.converged, result.discretisationError);
    ReturnedValues values = valuesOf(result.surface);
    values.merge(valuesOf(result.contact));
    values.merge(valuesOf(result.tags));
    values.merge(valuesOf(result.pose.way));
    values.insert({{"loose_parts", result.looseParts},
                   {"folded_triangles", result.check.flipped},
                   {"strained_edges", result.check.strained},
                   {"nodes", nodes},
                   {"iterations", result.iterations},
                   {"converged", result.converged},
                   {"energy", result.energy},
                   {"discretisation_error", valueOfDiscretisation(result.discretisationError)},
                   {"seconds_graph", result.secondsGraph},
                   {"seconds_solve", result.secondsSolve},
                   {"seconds_map", result.secondsMap}});
    return values;
}

/// Logs what was made, and gives the numbers.
HostFilterPlugin::ReturnedValues FilterFcd::tell(const std::string &line, const std::vector<std::string> &warnings,
                                                 const ReturnedValues &values) const {
    logLine(line);
    warn(warnings);
    return values;
}

template <class Made>
HostFilterPlugin::ReturnedValues FilterFcd::tell(const Made &made) const {
    logLine(describe(made.result.surface));
    ReturnedValues values = valuesOf(made);
    values.merge(valuesOf(made.result.contact));
    warn(warningsOf(made.result.contact));
    return tell(describe(made), warningsOf(made), values);
}

HostFilterPlugin::ReturnedValues FilterFcd::tell(const SequenceLayers &made) const {
    warnOf({1, made.report.jumps, made.report.unstable}, made.report.converged, made.report.discretisationError);
    return tell(describe(made), warningsOf(made), valuesOf(made));
}

HostFilterPlugin::ReturnedValues FilterFcd::pose(const RichParameterList &parameters, MeshDocument &document,
                                                 vcg::CallBackPos *callback) {
    MeshModel &layer = input(document);
    const PoseParam param = poseParam(parameters, document);
    const PoseResult result = LayerDeformer(document, layer, preparedLayers, toLog()).pose(param, Progress(callback));
    std::ostringstream line;
    line << describe(result.tags) << "; " << result.nodes << " nodes, " << inSteps(result.way) << result.iterations
         << " iterations; " << (result.prepared ? "prepared in " : "already prepared, found in ")
         << (result.prepared ? result.secondsPrepare : result.secondsFind) << " s, " << result.secondsSolve
         << " s to bend the graph, " << result.secondsMap + result.secondsNormals << " s for the mesh.";
    logLine(line.str());
    warnOf(result.way, result.converged, result.discretisationError);
    ReturnedValues values = valuesOf(result.tags);
    values.merge(valuesOf(result.way));
    values.insert({{"nodes", result.nodes},
                   {"iterations", result.iterations},
                   {"converged", result.converged},
                   {"discretisation_error", valueOfDiscretisation(result.discretisationError)},
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
    const DeformedCopies made = copyDeformation(document, param, targets, toLog(), Progress(callback));
    const int layers = int(targets.size());
    logLine(std::to_string(layers) + (layers == 1 ? " layer of " : " layers of ") + std::to_string(made.vertices) +
            " vertices deformed as '" + (param.file.isEmpty() ? param.source->label() : param.file).toStdString() +
            "'.");
    warn(made.warnings);
    return {{"layers", layers}, {"vertices", made.vertices}};
}

HostFilterPlugin::ReturnedValues FilterFcd::save(const RichParameterList &parameters, const MeshDocument &document,
                                                 vcg::CallBackPos *callback) {
    const SavedDeformation saved = saveDeformation(saveDeformationParam(parameters, document), Progress(callback));
    logLine(describe(saved));
    warn(warningsOf(saved));
    return valuesOf(saved);
}

void FilterFcd::warnOf(const vcg::fcd::PoseWay &way, bool converged, double discretisationError) const {
    warn(describe(way));
    if (!converged)
        logLine("The deformation did not converge: raise max_iterations, or tolerance, or move the handles less at "
                "a time.",
                GLLogStream::WARNING);
    if (const std::string remark = describeDiscretisation(discretisationError); !remark.empty())
        logLine(remark, GLLogStream::WARNING);
}

HostFilterPlugin::ReturnedValues FilterFcd::report(const vcg::fcd::TagCount &tags) const {
    logLine(describe(tags) + ".");
    return valuesOf(tags);
}

HostFilterPlugin::ReturnedValues FilterFcd::reportTags(const MeshModel &layer, const vcg::fcd::TagCount &tags,
                                                       const TagTarget &target) const {
    const ReturnedValues values = report(tags);
    if (const std::string line = describe(layer, target); !line.empty())
        logLine(line);
    return values;
}

HostFilterPlugin::ReturnedValues FilterFcd::clearTags(const MeshDocument &document, MeshModel &layer) const {
    const BroughtBack made = bringBack(document, layer);
    if (made.placed > 0)
        logLine(describePlaced(layer, made));
    if (made.others > 0)
        logLine(describeOthers(layer, made), GLLogStream::WARNING);
    return {{"other_vertices", made.others}, {"new_vertices", made.placed}};
}

// What moc makes of the headers: compiled here, it does not include all of MeshLab once more.
#include "layer_fcd/moc_filter_host.cpp" // NOLINT(bugprone-suspicious-include)
#include "moc_filter_fcd.cpp"            // NOLINT(bugprone-suspicious-include)
