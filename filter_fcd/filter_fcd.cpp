// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_fcd.h"
#include "filter_parameters.h"
#include "filter_reports.h"

#include <layer_fcd/inherited.h>
#include <layer_fcd/kept_aside.h>
#include <layer_fcd/layer_fitter.h>
#include <layer_fcd/layer_labels.h>
#include <layer_fcd/layer_state.h>
#include <layer_fcd/layer_straightener.h>
#include <layer_fcd/layer_corrections.h>
#include <layer_fcd/new_layers.h>
#include <layer_fcd/session_file.h>
#include <layer_fcd/tagging.h>

#include <memory>

#include <QGuiApplication>

using vcg::fcd::Error;
using vcg::fcd::Progress;

/// The current layer. \throw Error there is none, or it is empty
static MeshModel &input(MeshDocument &document) {
    MeshModel *layer = document.mm();
    if (!layer)
        throw Error("There is no layer. Open a mesh first.");
    if (layer->cm.vn == 0)
        throw Error("The layer " + inQuotes(*layer) + " has no vertices. Make the mesh the current layer.");
    return *layer;
}

FilterFcd::FilterFcd() {
    announce(SaveTags + 1);
    if (qobject_cast<QGuiApplication *>(QCoreApplication::instance())) // there is a window
        for (const int id : {TagSelection, TagsFromFiles, SaveTags})
            action(id)->setVisible(false); // neither in menus nor in the search
}

QString FilterFcd::name() const { return "FilterFCD"; }

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

/// The layer that a filter works on: in the window, the source of a result that is tried again.
MeshModel &FilterFcd::meant(int id, MeshModel &current, MeshDocument &document) {
    return id == DeformMesh && host::inWindow() ? sourceOf(document, current) : current;
}

QString FilterFcd::shown() const {
    return shownLayer.isEmpty() ? QString() : "<b>Deforms '" + shownLayer.toHtmlEscaped() + "'.</b> ";
}

HostFilterPlugin::ReturnedValues FilterFcd::run(int id, const RichParameterList &parameters, MeshDocument &document,
                                                vcg::CallBackPos *callback) {
    // So that a filter that fails leaves no state behind.
    const std::shared_ptr<void> tidyLater(nullptr, [&document, id = document.mm() ? document.mm()->id() : -1](void *) {
        if (MeshModel *layer = document.getMesh(id))
            LayerState::tidy(*layer);
    });
    if (host::inWindow() && document.mm())
        lastValues.keep(id, parameters, document, meant(id, *document.mm(), document));
    const Progress progress(callback);
    MeshModel &layer = input(document);
    if (parameters.hasParameter("handles") && parameters.getEnum("handles") == HandleParam::Known)
        inheritScan(document, layer);
    switch (id) {
    case BuildGraph: return buildGraph(parameters, document, layer, progress);
    case DeformMesh: return deformMesh(parameters, document, layer, progress);
    case FitMesh:
        return tellBent(fitLayer(document, layer, read<FitMeshParam>(parameters, document), toLog(), progress));
    case StraightenMesh:
        return tellBent(
            straightenLayer(document, layer, read<StraightenMeshParam>(parameters, document), toLog(), progress));
    case Symmetrize:
        return tellBent(
            symmetrizeLayer(document, layer, read<SymmetrizeParam>(parameters, document), toLog(), progress));
    case Compensate:
        return tell(
            compensateLayer(document, layer, read<CompensateLayerParam>(parameters, document), toLog(), progress));
    case PoseSequence: {
        const SequenceLayers made =
            makeSequence(document, layer, preparedLayers, read<SequenceParam>(parameters, document), toLog(), progress);
        warnOf({1, made.report.jumps, made.report.unstable}, made.report.converged, made.report.discretisationError);
        return tell(made);
    }
    case PoseInPlace: return pose(parameters, document, layer, progress);
    case CopyDeformation: return copy(parameters, document, layer, progress);
    case SaveDeformation:
        return tell(saveDeformation(read<SaveDeformationParam>(parameters, document), toLog(), progress));
    case ResetPose: resetPose(document, layer, read<ResetPoseParam>(parameters, document), toLog()); return {};
    case Tag:
    case TagSelection:
    case TagsFromFiles: {
        const TagParam param = id == Tag            ? read<TagParam>(parameters, document)
                               : id == TagSelection ? read<TagSelectionParam>(parameters, document)
                                                    : TagParam(read<TagsFromFilesParam>(parameters, document));
        const ReturnedValues values = report(tagLayer(document, layer, param, toLog()));
        const std::string line = param.role == TagParam::AsTheyAre ? "" : describe(layer, param.target);
        if (!line.empty())
            logLine(line);
        return values;
    }
    case ClearTags: return clearTags(document, layer);
    case SaveSession:
    case LoadSession: return session(id, parameters, document, layer);
    case SaveTags: return report(saveTags(document, layer, read<SaveTagsParam>(parameters, document), toLog()));
    }
    throw Error("Unknown filter.");
}

template <class Made>
HostFilterPlugin::ReturnedValues FilterFcd::tell(const Made &made) const {
    logLine(describe(made));
    warn(warningsOf(made));
    return valuesOf(made);
}

template <class Made>
HostFilterPlugin::ReturnedValues FilterFcd::tellBent(const Made &made) const {
    logLine(describe(made.result.surface));
    ReturnedValues values = valuesOf(made.result);
    warn(warningsOf(made.result.contact));
    values.merge(tell(made));
    return values;
}

HostFilterPlugin::ReturnedValues FilterFcd::report(const vcg::fcd::TagCount &tags) const {
    logLine(describe(tags) + ".");
    return valuesOf(tags);
}

HostFilterPlugin::ReturnedValues FilterFcd::clearTags(const MeshDocument &document, MeshModel &layer) const {
    const BroughtBack made = bringBack(document, layer);
    const std::string were =
        " of the " + std::to_string(layer.cm.vn) + " vertices of " + inQuotes(layer) + " were made";
    if (made.placed > 0)
        logLine(std::to_string(made.placed) + were +
                " by something else since they were tagged: they have what was at their place.");
    if (made.others > 0)
        logLine(std::to_string(made.others) + were +
                    ", coloured or given another quality by something else since they were tagged: they keep what they "
                    "have.",
                GLLogStream::WARNING);
    return {{"other_vertices", made.others}, {"new_vertices", made.placed}};
}

HostFilterPlugin::ReturnedValues FilterFcd::session(int id, const RichParameterList &parameters,
                                                    const MeshDocument &document, MeshModel &layer) const {
    const QString file = id == SaveSession ? read<SaveSessionParam>(parameters, document).file
                                           : read<LoadSessionParam>(parameters, document).file;
    if (id == SaveSession)
        inheritState(document, layer);
    const SessionContents contents = id == SaveSession ? saveSession(layer, file) : loadSession(document, layer, file);
    logLine((id == SaveSession ? "Saved: " : "Loaded: ") + describe(contents));
    return {{"marks", contents.marks},     {"colors", contents.colors},
            {"rest_shape", contents.rest}, {"earlier", contents.earlier},
            {"poses", contents.poses},     {"tool", contents.tool},
            {"pairs", contents.pairs},     {"fit_options", contents.fitOptions},
            {"fitted", contents.fitted},   {"moved_vertices", contents.moved}};
}

// The sources of moc: compiled here, so that all of MeshLab is not included once more.
#include "layer_fcd/moc_filter_host.cpp" // NOLINT(bugprone-suspicious-include)
#include "moc_filter_fcd.cpp"            // NOLINT(bugprone-suspicious-include)
