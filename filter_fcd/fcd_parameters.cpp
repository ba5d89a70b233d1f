// SPDX-License-Identifier: GPL-3.0-or-later
#include "fcd_parameters.h"

#include <cmath>

#include <QRegularExpression>

using host::addParameter;
using host::Shown;
using vcg::fcd::Error;

namespace {

Scalarm diagonal(const MeshDocument &document) {
    const MeshModel *layer = document.mm();
    const Scalarm length = layer && !layer->cm.bbox.IsNull() ? layer->cm.bbox.Diag() : 0;
    return length > 0 && std::isfinite(length) ? length : 1;
}

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

// What both filters ask for the graph.

void addTargetRadius(RichParameterList &list, double targetRadius, const MeshDocument &document) {
    addParameter<host::RichPercentageParam>(
        list, Shown::Always, "target_radius", Scalarm(targetRadius), Scalarm(0), diagonal(document), "Patch radius",
        "How far a patch reaches from its centre, in units of the layer, measured along the surface. Patches that grow "
        "beyond it are split. <b>0</b> (the default) chooses it from the number of patches and the area to cover. "
        "<b>Raising it</b> gives "
        "fewer "
        "and larger patches: faster, and the deformation bends more stiffly. <b>Lowering it</b> gives more patches, "
        "which "
        "can follow tighter bends.");
}

void addInitialPatches(RichParameterList &list, int initialPatches) {
    addParameter<RichInt>(
        list, Shown::Always, "initial_patches", initialPatches, "Initial patches",
        "Number of patches to start from, all of them where the surface is free; splitting adds to it. <b>Raising "
        "it</b> lets the deformation bend in finer "
        "detail "
        "and costs a little time; a few hundred are enough for most scans, whatever their number of vertices.");
}

void addRandomSeed(RichParameterList &list, unsigned randomSeed) {
    addParameter<RichInt>(
        list, Shown::Advanced, "random_seed", int(randomSeed), "Random seed",
        "Chooses where the first patches are placed. The same seed on the same mesh gives exactly the same result; "
        "another seed gives another, equally good, set of patches.");
}

vcg::fcd::GraphParam graphParam(const RichParameterList &list) {
    vcg::fcd::GraphParam param;
    param.targetRadius = list.getAbsPerc("target_radius");
    param.initialPatches = list.getInt("initial_patches");
    param.randomSeed = unsigned(list.getInt("random_seed"));
    return param;
}

/// What moves, and how.
void addHandles(RichParameterList &list, const HandleParam &handles, const MeshDocument &document) {
    addParameter<RichEnum>(list, Shown::Always, "handles", int(handles.source),
                           QStringList() << "Vertex quality"
                                         << "Selection"
                                         << "Custom vertex attribute"
                                         << "Files",
                           "Handles from",
                           "Where it is written what moves and what stays. Each vertex has a <b>tag</b>: <b>0</b> "
                           "stays fixed, <b>1</b> is free "
                           "and follows, <b>2, 3, ...</b> belongs to handle 2, 3, ... and moves as told, a "
                           "<b>negative</b> tag lies outside the "
                           "region of influence and is never moved."
                           "<ul><li><i>Vertex quality</i>: the quality is the tag (set it for example with 'Per Vertex "
                           "Quality Function').</li>"
                           "<li><i>Selection</i>: the selected vertices are the handle, the vertices of selected faces "
                           "stay fixed (where both "
                           "are selected the handle wins), all else is free.</li>"
                           "<li><i>Custom vertex attribute</i>: the attribute named below holds the tags.</li>"
                           "<li><i>Files</i>: a .sel file holds the tags.</li></ul>");
    addParameter<RichString>(
        list, Shown::Advanced, "tag_attribute", handles.tagAttribute, "Attribute with the tags",
        "Name of the per-vertex scalar attribute that holds the tags. Only read when the handles come "
        "from a custom attribute.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "tag_file", handles.tagFile, QStringList("*.sel"), "File with the tags (.sel)",
        "One tag per line for each vertex, in the order of the vertices; lines that begin with "
        "# are comments. Only read when the handles come from files.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "transform_file", handles.transformFile, QStringList("*.def"),
        "File with the motions (.def)",
        "One 4x4 matrix per handle, in world coordinates: the first moves handle 2, the second handle 3, and so on. "
        "May be "
        "left empty, and may be given whatever the handles come from. Handles without a matrix in it move by the "
        "translation, rotation, matrix and layer below.");
    addParameter<RichString>(
        list, Shown::Advanced, "transforms", handles.transforms, "Motions as text",
        "A motion for each handle, in world coordinates, for example <i>2: rotate 0 0 1 135 about 0 0 0 translate 0 0 "
        "5; 3: translate 1 0 0</i>: the handle's tag, a colon and the steps of its motion in their order; a semicolon "
        "between handles. The steps are:"
        "<ul><li><i>translate x y z</i></li>"
        "<li><i>rotate ax ay az degrees</i>: about the axis (ax, ay, az), counterclockwise when it points at you; any "
        "angle</li>"
        "<li><i>scale s</i>, or <i>scale sx sy sz</i>: positive factors</li>"
        "<li><i>matrix m11 m12 ... m44</i>: 16 numbers, row by row, the last row 0 0 0 1</li>"
        "<li><i>layer 'NAME'</i>: as the layer of that name lies to this one, for example a copy of the handle that "
        "was "
        "put in place with MeshLab's manipulators</li></ul>"
        "<i>rotate</i> and <i>scale</i> may be followed by <i>about x y z</i>, the point that stays in place; without "
        "it, that is the mean of the handle's own vertices, where the steps before have put it. Upper and lower case, "
        "line breaks and commas between numbers make no difference. May be given whatever the handles come from. "
        "Handles that are not in it move by the file above or by the translation, rotation, "
        "matrix and layer below.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "point_handles_file", handles.pointFile,
        QStringList() << "*.csv"
                      << "*.pp",
        "File with point handles (.csv, .pp)",
        "Points and where they go, in world coordinates; between them the surface turns as it likes. Either a "
        "list with a line for each point: <i>vertex, x, y, z</i> (the number of a vertex, from 0, and its target) or "
        "<i>x, y, z, x, y, z</i> (start and target), with commas, semicolons or blanks between; lines that begin with "
        "# "
        "are comments. Or MeshLab's picked points (.pp): start, target, start, target, and so on. For a start that is "
        "no vertex, the nearest vertex moves as the start does. Points are handles in addition to the tags, and belong "
        "where the surface is free; with them, a layer without tags is all free.");

    // How it moves.
    addParameter<host::RichPositionParam>(list, Shown::Always, "translation", toPoint(handles.translation),
                                          "Translation",
                                          "How far the handles move along x, y and z, in world units. Applied last.");
    addParameter<host::RichDirectionParam>(list, Shown::Always, "rotation_axis", toPoint(handles.rotationAxis),
                                           "Rotation axis",
                                           "Axis that the handles turn about; only its direction counts.");
    addParameter<RichFloat>(
        list, Shown::Always, "rotation_angle", Scalarm(handles.rotationAngle), "Rotation angle (degrees)",
        "How far the handles turn, in degrees, counterclockwise when the axis points at you. Applied "
        "before the translation. Any angle; the pose follows it: 270 degrees at pose 50 are 135 (with a matrix below "
        "that rotates, too, the handles take the shortest way). The surface between only sees where the handles "
        "arrive: turned by 360 degrees, they end, at pose 100, as if they had not turned; to twist it by more than "
        "180 degrees, use several handles.");
    addParameter<RichEnum>(
        list, Shown::Always, "rotation_center", int(handles.rotationCenter),
        QStringList() << "Barycentre of the handle"
                      << "Origin"
                      << "Rotation point",
        "Rotation centre",
        "The point that stays in place when a handle turns: the mean of the handle's own vertices (where "
        "the matrix below has put them), the origin of the world, or the point given below.");
    addParameter<host::RichPositionParam>(
        list, Shown::Advanced, "rotation_point", toPoint(handles.rotationPoint), "Rotation point",
        "Centre of the rotation in world coordinates. Only read when the rotation centre "
        "is 'Rotation point'. It comes here in single precision, which far from the origin is coarse (at 600 000, "
        "steps "
        "of 0.06): 'Motions as text' keeps all digits.");
    Matrix44m matrix;
    matrix.FromEigenMatrix(handles.matrix);
    addParameter<host::RichMatrixParam>(
        list, Shown::Advanced, "TransformMatrix", matrix, "Matrix",
        "A 4x4 affine matrix in world coordinates (last row 0 0 0 1) that moves the handles, "
        "applied before rotation and translation. May also scale or shear them.");
    host::addLayerParameter(
        list, Shown::Advanced, handleLayer, handles.likeLayer ? handles.likeLayer : document.mm(), document,
        "Handle moves like layer",
        "The handles move as this layer lies to the one that is deformed: duplicate the layer, put the copy where the "
        "handle belongs with MeshLab's manipulators, and choose it here. Only its matrix counts. Matrix, rotation and "
        "translation come on top of that. <b>The layer that is deformed itself</b> (the default): not used. As the "
        "other motions of the dialog, it moves the handles that neither a text nor a file moves.");
}

/// How it bends. \param all also what a filter may lack where scripts may not
void addBending(RichParameterList &list, const vcg::fcd::DeformationParam &deformation, bool all) {
    addParameter<RichFloat>(list, Shown::Always, "smoothness", Scalarm(deformation.smoothness),
                            "Smoothness (0.001 loose, 0.1 stiff)",
                            "How strongly neighbouring parts must turn alike: 0.001 is loose, 0.1 is stiff. <b>Raising "
                            "it</b> spreads bends over more of the surface and stiffens it; <b>lowering it</b> keeps "
                            "lengths better but lets bends become sharp near the handles.");
    addParameter<RichInt>(
        list, Shown::Advanced, "max_iterations", deformation.maxIterations, "Maximum iterations",
        "The shape is improved until it comes to rest, at most this often. <b>Raise it</b> when the log "
        "says that it did not converge; a converged result does not change.");
    addParameter<RichFloat>(list, Shown::Advanced, "tolerance", Scalarm(deformation.tolerance), "Tolerance",
                            "At rest means that no node is farther from where it comes to rest than ten times this "
                            "fraction of the bounding box diagonal (estimated from how fast the steps get shorter). "
                            "<b>Raising it</b> ends sooner and less exactly.");
    addParameter<RichEnum>(
        list, Shown::Advanced, "graph_weights", int(deformation.graphWeights),
        QStringList() << "Common border"
                      << "Uniform"
                      << "As in the paper"
                      << "The paper to the letter",
        "Graph weights",
        "How strongly neighbouring patches hold together. <i>Common border</i>: the more, the longer "
        "their border and the closer their centres, so that the shape hardly depends on where the "
        "patches lie. <i>Uniform</i>: all alike. <i>As in the paper</i>: all alike, and the patches are balanced by "
        "their number of vertices instead of their area, so that denser parts get more of them. <i>The paper to the "
        "letter</i>: all else, too, is as it is printed, to compare with it: vertices follow the nodes whose patch "
        "would reach them (Eqs. 7 and 8), whatever is held gives no way and nothing runs over into it, and the shape "
        "is improved by plain steps until one moves no node by more than the tolerance. 'Distances' and 'Influence' "
        "are not read.");
    const EnumText weights = weightsText();
    addParameter<RichEnum>(list, Shown::Advanced, "weights", int(deformation.weights), weights.values, weights.label,
                           weights.help);
    addParameter<RichFloat>(list, Shown::Advanced, "influence", Scalarm(deformation.influence), "Influence",
                            "A node moves vertices up to this many times the radius of its patch. <b>Raising it</b> "
                            "blends over more nodes: "
                            "smoother and a little slower. Below about 2 the patches begin to show.");
    addParameter<RichEnum>(list, Shown::Advanced, "loose_parts", int(deformation.looseParts),
                           QStringList() << "Follow"
                                         << "Stay",
                           "Loose parts",
                           "What becomes of parts that are not connected to any handle or fixed vertex: <i>Follow</i> "
                           "the nearest part that is "
                           "(a button follows the sleeve), or <i>Stay</i> where they are.");
    if (all)
        addParameter<RichFloat>(
            list, Shown::Advanced, "weld_distance", Scalarm(deformation.weldDistance), "Weld distance",
            "Vertices on open borders that are at most this far apart count as one, so that a seam does not tear; a "
            "fraction of the bounding box diagonal of what bends. <b>Raise it</b> when the log says that borders lie "
            "close to each other and are not joined; with <b>0</b>, only vertices at the same place count as one.");
    addParameter<RichFloat>(
        list, Shown::Always, "pose", Scalarm(deformation.pose), "Pose (percent)",
        "How much of the motion of the handles is carried out: 0 is the mesh as it is, 100 the full motion; "
        "it may exceed 100.");
    if (all)
        addParameter<RichInt>(
            list, Shown::Advanced, "pose_steps", deformation.steps, "Pose in steps",
            "The pose is reached over so many steps, each bent from the one before. <b>Raise it</b> (10, say) where a "
            "strong compression or twist makes the shape jump from one pose to the next: it then stays with the shape "
            "that grows out of the mesh as it is.");
}

HandleParam handleParam(const RichParameterList &list, const MeshDocument &document) {
    HandleParam handles;
    handles.source = HandleParam::Source(enumValue(list, "handles", 4));
    handles.tagAttribute = list.getString("tag_attribute");
    handles.tagFile = list.getOpenFileName("tag_file");
    handles.transformFile = list.getOpenFileName("transform_file");
    handles.transforms = list.getString("transforms");
    handles.pointFile = list.getOpenFileName("point_handles_file");
    handles.translation = toVector(list.getPoint3m("translation"));
    handles.rotationAxis = toVector(list.getPoint3m("rotation_axis"));
    handles.rotationAngle = list.getFloat("rotation_angle");
    handles.rotationCenter = HandleParam::Center(enumValue(list, "rotation_center", 3));
    handles.rotationPoint = toVector(list.getPoint3m("rotation_point"));
    const Matrix44m matrix = host::matrixParameter(list, "TransformMatrix");
    matrix.ToEigenMatrix(handles.matrix);
    if (list.hasParameter(handleLayer)) { // the window of 2020.09 runs scripts that lack it as they are
        handles.likeLayer = host::layerParameter(list, handleLayer, document);
        if (!handles.likeLayer && document.mm())
            throw Error("'handle_layer' names no layer of this document. Choose the layer that the handles move like, "
                        "or, for none, the layer that is deformed.");
    }
    handles.validate();
    return handles;
}

/// All but nodes, and what is measured.
vcg::fcd::DeformationParam deformationParam(const RichParameterList &list, bool all) {
    vcg::fcd::DeformationParam deformation;
    deformation.graph = graphParam(list);
    deformation.smoothness = list.getFloat("smoothness");
    deformation.maxIterations = list.getInt("max_iterations");
    deformation.tolerance = list.getFloat("tolerance");
    using vcg::fcd::GraphWeights;
    using vcg::fcd::PatchMeasure;
    const GraphWeights graphWeights[] = {GraphWeights::Border, GraphWeights::Uniform, GraphWeights::Uniform,
                                         GraphWeights::Printed};
    const int chosen = enumValue(list, "graph_weights", 4);
    deformation.graphWeights = graphWeights[chosen];
    deformation.graph.measure = chosen >= 2 ? PatchMeasure::Vertices : PatchMeasure::Area;
    deformation.weights = vcg::fcd::MappingWeights(enumValue(list, "weights", 2));
    deformation.influence = list.getFloat("influence");
    deformation.looseParts = vcg::fcd::LooseParts(enumValue(list, "loose_parts", 2));
    deformation.pose = list.getFloat("pose");
    if (all) {
        deformation.weldDistance = list.getFloat("weld_distance");
        deformation.steps = list.getInt("pose_steps");
    }
    deformation.Validate();
    return deformation;
}

} // namespace

RichParameterList inOrder(const RichParameterList &list, QStringList first, bool others) {
    if (host::firstMayBeLacking())
        first.prepend(handleLayer);
    first.removeDuplicates();
    RichParameterList ordered;
    for (const QString &name : first)
        ordered.addParam(list.getParameterByName(name));
    for (const RichParameter &parameter : list)
        if (others && !ordered.hasParameter(parameter.name()))
            ordered.addParam(parameter);
    return ordered;
}

EnumText weightsText() {
    return {"Distances",
            {"Along the surface", "Euclidean"},
            "How a vertex finds the nodes that move it. <i>Along the surface</i>: parts that are close in space but "
            "not connected (fingers, lips, folds) do not drag each other along. <i>Euclidean</i>: as in the paper, by "
            "straight distance."};
}

int enumValue(const RichParameterList &list, const char *name, int count) {
    const int value = list.getEnum(name);
    if (value < 0 || value >= count)
        throw Error(std::string(name) + " is " + std::to_string(value) + "; it must be from 0 to " +
                    std::to_string(count - 1) + ".");
    return value;
}

RichParameterList toRichParameters(const BuildGraphParam &param, const MeshDocument &document) {
    RichParameterList list;
    addTargetRadius(list, param.graph.targetRadius, document);
    addInitialPatches(list, param.graph.initialPatches);
    addParameter<RichInt>(list, Shown::Advanced, "max_iterations", param.graph.maxIterations, "Maximum iterations",
                          "The patches are improved until they hardly change, at most this often. <b>Raising it</b> "
                          "matters only when the log "
                          "says that they did not converge.");
    addRandomSeed(list, param.graph.randomSeed);
    addParameter<RichBool>(
        list, Shown::Always, "patches_layer", param.patchesLayer, "Layer with the patches",
        "Also adds a copy of the mesh that is coloured by patch; its quality is the number of the patch.");
    if (host::scriptsMayLackParameters)
        addParameter<RichBool>(
            list, Shown::Always, "surface_layer", param.surfaceLayer, "Layer with the graph as a surface",
            "Also adds the graph as balls and tubes, which any viewer shows and every format keeps.");
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
    addParameter<RichBool>(
        list, Shown::Advanced, "use_graph_layer", param.useGraphLayer, "Use a graph layer",
        "Deforms with the vertices of the layer below as nodes instead of building a graph: one graph can "
        "drive several meshes, and nodes can be placed by hand.");
    host::addLayerParameter(
        list, Shown::Advanced, "graph_layer", param.graphLayer ? param.graphLayer : likelyGraph(document), document,
        "Graph layer",
        "The layer whose vertices are the nodes. Only read when 'Use a graph layer' is ticked. Nodes "
        "that are not on the surface are left out; when most of them are not, it is an error.");
    addTargetRadius(list, deformation.graph.targetRadius, document);
    addInitialPatches(list, deformation.graph.initialPatches);
    addRandomSeed(list, deformation.graph.randomSeed);

    addBending(list, deformation, host::scriptsMayLackParameters);
    addParameter<RichBool>(list, Shown::Always, "graph_layers", param.graphLayers, "Layers with the graph",
                           "Also adds the deformation graph at rest and deformed, as two layers; their attribute "
                           "<i>energy</i> says where the deformation costs most.");
    addParameter<RichEnum>(
        list, Shown::Advanced, "deformed_quality", int(param.quality),
        QStringList() << "As the input"
                      << "Stretch"
                      << "Rotation angle",
        "Quality of the result",
        "What the vertex quality of the deformed layer is, to be coloured ('Colorize by vertex "
        "Quality'), selected by or saved: that of the input, the <b>stretch</b> (length of the edges "
        "over that at rest: 1 is not stretched, 1.1 is 10 percent longer), or the <b>angle</b> by "
        "which the surface turned, in degrees.");
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
    addParameter<RichBool>(
        list, Shown::Advanced, "exact_normals", param.exactNormals, "Exact normals",
        "Computes the normals of the vertices anew from the faces, as MeshLab does. Without it they are turned as the "
        "surface turns, which is faster and looks the same.");
    return list;
}

} // namespace

RichParameterList toRichParameters(const PoseParam &param, const MeshDocument &document) {
    RichParameterList all = allParameters(param, document);
    if (host::dialogsFold)
        return all;
    return inOrder(all,
                   {"handles", "tag_attribute", "transforms", "translation", "rotation_axis", "rotation_angle",
                    "rotation_center", "rotation_point", handleLayer, "initial_patches", "smoothness", "pose"},
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
    param.exactNormals = list.getBool("exact_normals");
    return param;
}

RichParameterList toRichParameters(const CopyParam &param, const MeshDocument &document) {
    RichParameterList list;
    // First: where a script lacks the first parameter only, meshlabserver 2020.09 fills it in.
    addParameter<host::RichFileParam>(
        list, Shown::Always, "deformation_file", param.file, QStringList("*.ply"), "Saved deformation (.ply)",
        "A file of 'FCD: Save Deformation'. With it, the three layers below are not read, and need not be there. Such "
        "a file stands in world coordinates. <b>Empty</b> (the default): the layers tell.");
    host::addLayerParameter(list, Shown::Always, "source_layer", param.source ? param.source : document.mm(), document,
                            "Source layer", "The layer that 'FCD: Deform Mesh' has deformed, as it was before.");
    host::addLayerParameter(list, Shown::Always, "rest_graph",
                            param.restGraph ? param.restGraph : likelyGraph(document), document, "Graph at rest",
                            "The layer with the deformation graph of the source.");
    host::addLayerParameter(list, Shown::Always, "deformed_graph",
                            param.deformedGraph ? param.deformedGraph : likelyDeformedGraph(document), document,
                            "Deformed graph",
                            "The layer with the same graph, deformed: it holds what was done to the source.");
    addParameter<RichBool>(list, Shown::Always, "all_visible", param.allVisible, "All visible layers",
                           "Deforms every visible layer but those above, instead of the current one.");
    return list;
}

CopyParam copyParam(const RichParameterList &list, const MeshDocument &document) {
    return {host::layerParameter(list, "source_layer", document), host::layerParameter(list, "rest_graph", document),
            host::layerParameter(list, "deformed_graph", document), list.getOpenFileName("deformation_file"),
            list.getBool("all_visible")};
}

RichParameterList toRichParameters(const ResetPoseParam &param) {
    RichParameterList list;
    addParameter<RichBool>(
        list, Shown::Always, "keep_shape", param.keepShape, "Keep the present shape",
        "Ticked, the layer stays as it is, and later poses begin from this shape. Otherwise it gets the shape back "
        "that it had before its first pose.");
    return list;
}

ResetPoseParam resetPoseParam(const RichParameterList &list) { return {list.getBool("keep_shape")}; }

DeformMeshParam deformMeshParam(const RichParameterList &list, const MeshDocument &document) {
    DeformMeshParam param;
    param.handles = handleParam(list, document);

    param.useGraphLayer = list.getBool("use_graph_layer");
    if (param.useGraphLayer)
        param.graphLayer = host::layerParameter(list, "graph_layer", document);

    param.deformation = deformationParam(list, host::scriptsMayLackParameters);

    param.graphLayers = list.getBool("graph_layers");
    param.quality = DeformMeshParam::Quality(enumValue(list, "deformed_quality", 3));
    param.deformation.measure = param.quality != DeformMeshParam::Input;
    return param;
}

void HandleParam::validate() const {
    if (!translation.allFinite() || !rotationAxis.allFinite() || !rotationPoint.allFinite() ||
        !std::isfinite(rotationAngle))
        throw Error("translation, rotation_axis, rotation_angle and rotation_point must be finite numbers.");
    if (rotationAngle != 0 && !(rotationAxis.norm() > 0))
        throw Error("rotation_axis is 0 0 0, which is no direction. Give an axis, or set rotation_angle to 0.");
    if (!matrix.allFinite() || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw Error("TransformMatrix is not affine: its last row must be 0 0 0 1 and all its entries finite numbers.");
    if (source == Attribute && tagAttribute.isEmpty())
        throw Error("tag_attribute is empty. Give the name of the per-vertex attribute that holds the tags.");
    if (source == Files && tagFile.isEmpty() && pointFile.isEmpty())
        throw Error("tag_file is empty. Give the .sel file with one tag per vertex, or a file with point handles, or "
                    "choose another source of handles.");
}
