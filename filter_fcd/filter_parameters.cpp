// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/kept_deformation.h> // before Qt

#include "common_parameters.h"

#include <QRegularExpression>

using host::addParameter;
using host::Shown;
using vcg::fcd::Error;

namespace {

/// The last layer whose label fits, or else the current one.
const MeshModel *lastLayer(const MeshDocument &document, const QRegularExpression &label,
                           const QRegularExpression &butNot) {
    const MeshModel *found = document.mm();
    for (const MeshModel *layer : host::layers(document)) {
        if (!found)
            found = layer;
        if (layer->label().contains(label) && !layer->label().contains(butNot))
            found = layer;
    }
    return found;
}

QRegularExpression deformedGraphLabel() { return QRegularExpression(" deformed graph[ 0-9()]*$"); }

/// The layers that are most likely meant as deformation graph, and as the same graph deformed.
const MeshModel *likelyGraph(const MeshDocument &document) {
    return lastLayer(document, QRegularExpression(" graph( \\d+)?(\\(\\d+\\))?$"), deformedGraphLabel());
}
const MeshModel *likelyDeformedGraph(const MeshDocument &document) {
    return lastLayer(document, deformedGraphLabel(), QRegularExpression("^$"));
}

} // namespace

RichParameterList toRichParameters(const BuildGraphParam &param, const MeshDocument &document) {
    RichParameterList list;
    addTargetRadius(list, param.graph.targetRadius, document, Shown::Always);
    addInitialPatches(list, param.graph.initialPatches, Shown::Always);
    addParameter<RichInt>(list, Shown::Advanced, "max_iterations", param.graph.maxIterations, "Maximum iterations",
                          "Patches are improved until they hardly change, at most this often. <b>Raise it</b> when the "
                          "log says that they did not converge.");
    addRandomSeed(list, param.graph.randomSeed);
    addParameter<RichBool>(list, Shown::Always, "patches_layer", param.patchesLayer, "Add patch layer",
                           "Also adds a copy of the mesh, coloured by patch. Its quality is the number of the patch.");
    if (host::scriptsMayLackParameters)
        addParameter<RichBool>(list, Shown::Always, "surface_layer", param.surfaceLayer, "Add graph as a surface",
                               "Also adds the graph as balls and tubes, for any viewer and every format.");
    return list;
}

BuildGraphParam buildGraphParam(const RichParameterList &list) {
    BuildGraphParam param;
    param.graph = graphParam(list);
    param.graph.maxIterations = list.getInt("max_iterations");
    param.patchesLayer = list.getBool("patches_layer");
    param.surfaceLayer = host::scriptsMayLackParameters ? list.getBool("surface_layer") : host::inWindow();
    param.graph.Validate();
    return param;
}

RichParameterList toRichParameters(const DeformMeshParam &param, const MeshDocument &document) {
    const HandleParam &handles = param.handles;
    const vcg::fcd::DeformationParam &deformation = param.deformation;
    RichParameterList list;

    addHandles(list, handles, document);

    // With which graph.
    addParameter<RichBool>(list, Shown::Advanced, "use_graph_layer", param.useGraphLayer, "Use a graph layer",
                           "Takes the vertices of the layer below as nodes instead of building a graph. One graph can "
                           "drive several meshes, and you can place nodes by hand.");
    host::addLayerParameter(list, Shown::Advanced, "graph_layer",
                            param.graphLayer ? param.graphLayer : likelyGraph(document), document, "Graph layer",
                            "The layer whose vertices are the nodes. Only read when 'Use a graph layer' is ticked. "
                            "Nodes that are not on the surface are left out. It is an error when most are not.");
    addTargetRadius(list, deformation.graph.targetRadius, document);
    addInitialPatches(list, deformation.graph.initialPatches);
    addRandomSeed(list, deformation.graph.randomSeed);

    addBending(list, deformation, host::scriptsMayLackParameters);
    addGraphLayers(list, param.graphLayers);
    addParameter<RichEnum>(list, Shown::Advanced, "deformed_quality", int(param.quality),
                           QStringList() << "As the input"
                                         << "Stretch"
                                         << "Rotation angle"
                                         << "Contact",
                           "Result quality",
                           "The vertex quality of the result, to colour, select or save: that of the input, the "
                           "<b>stretch</b> (length of edges over that at rest: 1.1 is 10 percent longer), the "
                           "<b>angle</b> by which the surface turned, in degrees, or the <b>contact</b>: how far the "
                           "surface passes through itself where it did not at rest. Up to 250 thousand faces the log "
                           "tells of contact in any case; larger layers take a second for a million faces.");
    addDisplacement(list, param.displacement);
    if (host::scriptsMayLackParameters)
        addParameter<RichBool>(list, Shown::Advanced, "stop_at_contact", param.stopAtContact, "Stop at contact",
                               "Carries the motion out only until the surface would pass through itself: to the last "
                               "hundredth of it that is free. Solves eight poses; the log tells how far it came.");
    if (host::dialogsFold)
        return list;
    // Where nothing is folded, what one needs comes first.
    return inOrder(list,
                   {"handles", "translation", "rotation_axis", "rotation_angle", "rotation_center", "rotation_point",
                    handleLayer, "smoothness", "pose", "graph_layers", "transforms"},
                   true);
}

namespace {

RichParameterList allParameters(const PoseParam &param, const MeshDocument &document) {
    RichParameterList list;
    addHandles(list, param.handles, document);
    addTargetRadius(list, param.deformation.graph.targetRadius, document);
    addInitialPatches(list, param.deformation.graph.initialPatches);
    addRandomSeed(list, param.deformation.graph.randomSeed);
    addBending(list, param.deformation, true);
    addParameter<RichBool>(list, Shown::Advanced, "exact_normals", param.exactNormals, "Exact normals",
                           "Computes normals of what moves from the faces, as MeshLab does. Without it they turn with "
                           "the surface: a tenth faster, and some degrees off where it bends. A layer's own normals, "
                           "and those of clouds, turn in any case.");
    if (host::scriptsMayLackParameters)
        addParameter<RichBool>(list, Shown::Advanced, "contact", param.contact, "Look for contact",
                               "Tells how many triangles pass through the layer that did not at rest, and how far. It "
                               "takes several times as long as the pose, and so does each step of a preview.");
    return list;
}

} // namespace

RichParameterList toRichParameters(const PoseParam &param, const MeshDocument &document) {
    RichParameterList all = allParameters(param, document);
    if (host::dialogsFold)
        return all;
    return inOrder(all,
                   {"handles", "translation", "rotation_axis", "rotation_angle", "rotation_center", "rotation_point",
                    handleLayer, "smoothness", "pose", "transforms", "tag_attribute", "initial_patches"},
                   false);
}

PoseParam poseParam(const RichParameterList &given, const MeshDocument &document) {
    // What is not given has its default; what the host gives besides is its own.
    const RichParameterList all = allParameters(PoseParam(), document);
    RichParameterList list = all;
    for (const RichParameter &parameter : all)
        if (given.hasParameter(parameter.name()))
            list.setValue(parameter.name(), given.getParameterByName(parameter.name()).value());
    PoseParam param;
    param.handles = handleParam(list, document);
    param.deformation = deformationParam(list, true);
    if (!host::scriptsMayLackParameters && !given.hasParameter("weld_distance")) // of no dialog, so not rounded
        param.deformation.weldDistance = vcg::fcd::DeformerParam().weldDistance;
    param.exactNormals = list.getBool("exact_normals");
    param.contact = list.hasParameter("contact") && list.getBool("contact");
    return param;
}

RichParameterList toRichParameters(const CopyParam &param, const MeshDocument &document) {
    RichParameterList list;
    const DeformationLayers last = lastDeformation(document);
    const auto firstOf = [](const MeshModel *given, const MeshModel *kept, const MeshModel *likely) {
        return given ? given : kept ? kept : likely;
    };
    // First: where a script lacks the first parameter only, meshlabserver 2020.09 fills it in.
    addParameter<host::RichFileParam>(list, Shown::Always, "deformation_file", param.file, QStringList("*.ply"),
                                      "Saved deformation (.ply)",
                                      "A file of 'FCD: Save Deformation', in world coordinates. The three layers below "
                                      "are not read then. <b>Empty</b> (the default): the layers tell.");
    host::addLayerParameter(
        list, Shown::Always, "source_layer", firstOf(param.source, last.source, document.mm()), document,
        "Source layer",
        "The layer that was deformed, in the shape that it had then. By default that of the last deformation.");
    host::addLayerParameter(list, Shown::Always, "rest_graph",
                            firstOf(param.restGraph, last.restGraph, likelyGraph(document)), document, "Graph at rest",
                            "The layer with the deformation graph of the source.");
    host::addLayerParameter(list, Shown::Always, "deformed_graph",
                            firstOf(param.deformedGraph, last.deformedGraph, likelyDeformedGraph(document)), document,
                            "Deformed graph", "The layer with the same graph, deformed.");
    addParameter<RichBool>(list, Shown::Always, "all_visible", param.allVisible, "All visible layers",
                           "Deforms every visible layer but those above, instead of the current one.");
    addDisplacement(list, param.displacement);
    return list;
}

CopyParam copyParam(const RichParameterList &list, const MeshDocument &document) {
    return {host::layerParameter(list, "source_layer", document),
            host::layerParameter(list, "rest_graph", document),
            host::layerParameter(list, "deformed_graph", document),
            list.getOpenFileName("deformation_file"),
            displacement(list),
            list.getBool("all_visible")};
}

RichParameterList toRichParameters(const ResetPoseParam &param) {
    RichParameterList list;
    addParameter<RichEnum>(
        list, Shown::Always, "to", int(param.to),
        QStringList{"The shape before the last pose", "The shape as loaded",
                    "The shape before the last pose, whatever has moved it"},
        "Back to",
        "<b>The shape before the last pose</b> (0): one step; where the layer has that already, the one before. Steps "
        "are what 'Apply' in the tool 'FCD: Bend', or 'Keep the present shape', made of a pose.<br><b>The shape as "
        "loaded</b> (1): that which the layer had before its first pose.<br><b>The shape before the last pose, "
        "whatever has "
        "moved it</b> (2): also where another filter has moved some vertices since (smoothed them, say), which is "
        "undone "
        "with the pose. New vertices, or other faces, have no place there.");
    addParameter<RichBool>(list, Shown::Always, "keep_shape", param.keepShape, "Keep the present shape",
                           "Ticked, the layer stays as it is, and later poses begin from this shape.");
    return list;
}

ResetPoseParam resetPoseParam(const RichParameterList &list) {
    return {list.getBool("keep_shape"), ResetPoseParam::To(enumValue(list, "to", 3))};
}

DeformMeshParam deformMeshParam(const RichParameterList &list, const MeshDocument &document) {
    DeformMeshParam param;
    param.handles = handleParam(list, document);

    param.useGraphLayer = list.getBool("use_graph_layer");
    if (param.useGraphLayer)
        param.graphLayer = host::layerParameter(list, "graph_layer", document);

    param.deformation = deformationParam(list, host::scriptsMayLackParameters);

    param.graphLayers = list.getBool("graph_layers");
    param.quality = DeformMeshParam::Quality(enumValue(list, "deformed_quality", 4));
    param.displacement = displacement(list);
    param.stopAtContact = list.hasParameter("stop_at_contact") && list.getBool("stop_at_contact");
    param.deformation.contact = param.quality == DeformMeshParam::Contact;
    param.deformation.measure = param.quality == DeformMeshParam::Stretch || param.quality == DeformMeshParam::Rotation;
    return param;
}

RichParameterList toRichParameters(const SaveDeformationParam &param, const MeshDocument &document) {
    CopyParam layers;
    layers.source = param.source;
    layers.restGraph = param.restGraph;
    layers.deformedGraph = param.deformedGraph;
    const RichParameterList all = toRichParameters(layers, document);
    RichParameterList list;
    for (const char *name : {"source_layer", "rest_graph", "deformed_graph"})
        list.addParam(all.getParameterByName(name));
    host::addParameter<host::RichSaveFileParam>(list, host::Shown::Always, "deformation_file", param.file, "*.ply",
                                                "Write deformation to (.ply)",
                                                "The file to write. An existing file is replaced.");
    if (host::scriptsMayLackParameters) {
        host::addParameter<RichFloat>(
            list, host::Shown::Always, "accuracy", Scalarm(param.accuracy), "Accuracy",
            "How far a vertex of the source may be off, in world units. A tenth of it takes about five times as many "
            "samples, of some 115 bytes each, up to a million. The log tells size and time. <b>0</b> (the default): a "
            "fiftieth of the largest motion, at most 0.01 percent of the diagonal of what moves.");
        host::addParameter<RichBool>(list, host::Shown::Always, "inverse", param.inverse, "Inverse",
                                     "Writes the deformation that leads back, from the deformed shape to the original. "
                                     "It carries marks and measurements onto the original. Where the deformation folds "
                                     "the mesh there is no way back; the log counts these vertices.");
    }
    return list;
}

SaveDeformationParam saveDeformationParam(const RichParameterList &list, const MeshDocument &document) {
    SaveDeformationParam param;
    param.source = host::layerParameter(list, "source_layer", document);
    param.restGraph = host::layerParameter(list, "rest_graph", document);
    param.deformedGraph = host::layerParameter(list, "deformed_graph", document);
    param.file = list.getSaveFileName("deformation_file");
    param.accuracy = host::scriptsMayLackParameters ? double(list.getFloat("accuracy")) : 0;
    param.inverse = host::scriptsMayLackParameters && list.getBool("inverse");
    param.validate();
    return param;
}
