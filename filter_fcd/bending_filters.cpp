// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_fcd.h"
#include "filter_parameters.h"
#include "filter_reports.h"

#include <layer_fcd/deformation_uses.h>
#include <layer_fcd/new_layers.h>
#include <layer_fcd/layer_deformer.h>
#include <layer_fcd/layer_labels.h>

#include <iomanip>

// The filters that bend a layer, and others as it was bent.

using vcg::fcd::Error;
using vcg::fcd::Progress;

/// "3 steps, ", where there are several.
static std::string inSteps(const vcg::fcd::PosePath &path) {
    return path.steps > 1 ? std::to_string(path.steps) + " steps, " : std::string();
}

HostFilterPlugin::ReturnedValues FilterFcd::buildGraph(const RichParameterList &parameters, MeshDocument &document,
                                                       MeshModel &layer, const Progress &progress) {
    const auto param = read<BuildGraphParam>(parameters, document);
    const vcg::fcd::CentroidalGraph graph = addGraphLayers(document, layer, param, toLog(), progress);

    const int patches = int(graph.geometry.position.cols()), edges = int(graph.geometry.edge.size());
    logLine(describe(graph.surface));
    logLine(inWords(patches, " patches, ", edges, " edges, patch radius at most ", graph.targetRadius, ", ",
                    graph.iterations, " iterations, ", graph.seconds, " s."));
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
                                                       MeshModel &current, const Progress &progress) {
    const bool inWindow = host::inWindow();
    MeshModel &layer = meant(DeformMesh, current, document);
    const auto param = read<DeformMeshParam>(parameters, document);
    const DeformedLayers made =
        LayerDeformer(document, layer, preparedLayers, toLog()).deform(param, inWindow, progress);
    const vcg::fcd::DeformationResult &result = made.result;
    if (inWindow)
        logLine((made.replaced == 0 ? std::string()
                                    : std::to_string(made.replaced) + " layers of the last try are replaced. ") +
                inQuotes(*made.layers.back()) + " is shown, " + inQuotes(layer) +
                " and the graphs are hidden. Another try deforms " + inQuotes(layer) +
                " again and replaces this result: rename a result to keep it.");

    logLine(describe(result.surface));
    logLine(inWords(describe(result.tags), "; ", result.rest.position.cols(), " nodes, ", inSteps(result.pose.path),
                    result.iterations, " iterations; ", result.secondsGraph, " s for the graph, ", result.secondsSolve,
                    " s to bend it, ", result.secondsMap, " s for the mesh."));
    for (const std::string &remark : describe(made, param))
        logLine(remark);
    warn(describe(result.check, result.surface));
    warn(warningsOf(result.contact));
    warnOf(result.pose.path, result.converged, result.discretisationError);
    ReturnedValues values = valuesOf(result);
    values.merge(valuesOf(result.tags));
    values.merge(valuesOf(result.pose.path));
    values.insert({{"loose_parts", result.looseParts},
                   {"pose_percent", made.percent},
                   {"strained_edges", result.check.strained},
                   {"iterations", result.iterations},
                   {"energy", result.energy},
                   {"discretisation_error", valueOfDiscretisation(result.discretisationError)},
                   {"seconds_graph", result.secondsGraph},
                   {"seconds_solve", result.secondsSolve},
                   {"seconds_map", result.secondsMap}});
    return values;
}

HostFilterPlugin::ReturnedValues FilterFcd::pose(const RichParameterList &parameters, MeshDocument &document,
                                                 MeshModel &layer, const Progress &progress) {
    const auto param = read<PoseParam>(parameters, document);
    const PoseResult result = LayerDeformer(document, layer, preparedLayers, toLog()).pose(param, progress);
    logLine(inWords(describe(result.tags), "; ", result.nodes, " nodes, ", inSteps(result.path), result.iterations,
                    " iterations; ", result.prepared ? "prepared in " : "already prepared, found in ",
                    result.prepared ? result.secondsPrepare : result.secondsFind, " s, ", result.secondsSolve,
                    " s to bend the graph, ", result.secondsMap + result.secondsNormals, " s for the mesh."));
    warn(warningsOf(result.contact));
    warnOf(result.path, result.converged, result.discretisationError);
    ReturnedValues values = valuesOf(result.tags);
    values.merge(valuesOf(result.contact));
    values.merge(valuesOf(result.path));
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
                                                 MeshModel &current, const Progress &progress) {
    const auto param = read<CopyParam>(parameters, document);
    std::vector<MeshModel *> targets(1, &current);
    if (param.allVisible) {
        targets.clear();
        for (const MeshModel *layer : host::layers(document))
            if (layer->isVisible() && layer->cm.vn > 0 &&
                (!param.file.isEmpty() ||
                 (layer != param.source && layer != param.restGraph && layer != param.deformedGraph)))
                targets.push_back(const_cast<MeshModel *>(layer));
        if (targets.empty())
            throw Error("Only the source and its graphs are visible. Show the layers that you want to deform.");
    }
    const DeformedCopies made = copyDeformation(document, param, targets, toLog(), progress);
    logLine(counted(targets.size(), "layer of ", "layers of ") + std::to_string(made.vertices) +
            " vertices deformed as '" + (param.file.isEmpty() ? param.source->label() : param.file).toStdString() +
            "'.");
    warn(made.warnings);
    return {{"layers", int(targets.size())}, {"vertices", made.vertices}};
}

void FilterFcd::warnOf(const vcg::fcd::PosePath &path, bool converged, double discretisationError) const {
    if (path.jumps)
        logLine("The shape jumps to another one on its way: the handles twist or press it too far. Move them less" +
                    std::string(host::scriptsMayLackParameters ? "." : ", or raise pose_steps."),
                GLLogStream::WARNING);
    if (path.unstable)
        logLine("The shape would buckle: the handles press or twist it too far. To let it bow, mark a handle in its "
                "middle and pull that to the side that you want.",
                GLLogStream::WARNING);
    if (!converged)
        logLine("The deformation did not converge: raise max_iterations, or tolerance, or move the handles less at "
                "a time.",
                GLLogStream::WARNING);
    if (discretisationError > vcg::fcd::coarseError)
        logLine(inWords("With so few patches, the shape is off by about ", std::setprecision(2),
                        100 * discretisationError,
                        " percent of the diagonal of the part that bends (rms). Raise initial_patches."),
                GLLogStream::WARNING);
}
