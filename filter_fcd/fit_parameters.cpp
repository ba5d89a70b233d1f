// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

#include <limits>

using host::addParameter;
using host::Shown;

namespace {

/// The only other layer, or else the current one, which is no target.
const MeshModel *likelyTarget(const MeshDocument &document) {
    const std::vector<const MeshModel *> layers = host::layers(document);
    const MeshModel *current = const_cast<MeshDocument &>(document).mm(); // which is not changed
    if (layers.size() != 2)
        return current;
    return layers[0] == current ? layers[1] : layers[0];
}

/// Pairs that a fit is judged by.
void addChecks(RichParameterList &list, const FitMeshParam &param) {
    if (host::firstMayBeLacking()) // meshlabserver 2020.09 ends where a script lacks a parameter
        return;
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "check_file", param.checkFile,
        QStringList() << "*.csv"
                      << "*.pp",
        "File with pairs to check by (.csv, .pp)",
        "Pairs as of the file with landmarks, of any vertices, which are kept back from the fit: how far they are "
        "from where they belong, which is logged, judges it. <b>Empty</b> (the default): none.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "target_check_file", param.checkTargetFile, QStringList() << "*.pp",
        "Picked points of the target to check by (.pp)",
        "With picked points of the current layer as the file with pairs to check by: those of the target, whose names "
        "are the same.");
    addParameter<RichBool>(list, Shown::Advanced, "leave_one_out", param.leaveOneOut, "Leave landmarks out in turn",
                           "Also fits without each of the landmarks, which takes as many fits, and logs how far it is "
                           "from where it belongs then: what the target and the others say of it.");
}

/// How much of the two layers counts.
void addWeights(RichParameterList &list, const FitMeshParam &param) {
    if (host::firstMayBeLacking())
        return;
    const QStringList sources = QStringList() << "All counts"
                                              << "Vertex quality"
                                              << "Selected vertices"
                                              << "Attribute";
    addParameter<RichEnum>(
        list, Shown::Always, "weights", int(param.weights), sources, "What counts",
        "How much the match of each vertex of the current layer counts: from 0, which is <b>carried along</b> and not "
        "matched, as the gum of a dental scan, to 1. <b>All counts</b> (the default), the <b>vertex quality</b>, what "
        "is "
        "<b>selected</b>, or an <b>attribute</b>. Quality or selection that tell this tell no handles. A separate "
        "part that nothing of the target leads is carried in any case, by what it belongs to or lies in: an eyeball "
        "by its head.");
    addParameter<RichEnum>(list, Shown::Always, "target_weights", int(param.targetWeights), sources,
                           "What of the target counts",
                           "The same of the vertices of the target: what has 0 is as if it were not there.");
    addParameter<RichString>(list, Shown::Advanced, "weight_attribute", param.weightAttribute, "Attribute with weights",
                             "Name of the scalar attribute per vertex that tells how much it counts, 0 to 1, of either "
                             "layer.");
}

} // namespace

RichParameterList toRichParameters(const FitMeshParam &param, const MeshDocument &document) {
    const vcg::fcd::FitParam &fit = param.fit;
    RichParameterList list;
    host::addLayerParameter(
        list, Shown::Always, "target_layer", param.target ? param.target : likelyTarget(document), document, "Target",
        "The layer that the current one is laid onto: triangles, or a point cloud. The normals of a "
        "cloud, where it has some, tell its sides apart. It is not changed.");
    addParameter<host::RichFileParam>(
        list, Shown::Always, "landmarks_file", param.landmarkFile,
        QStringList() << "*.csv"
                      << "*.pp",
        "File with landmarks (.csv, .pp)",
        "Pairs of points that belong together, in world coordinates. Either a list with a line for each pair: "
        "<i>vertex, x, y, z</i> (the number of a vertex of the current layer, from 0, and the place on the target) or "
        "<i>x, y, z, x, y, z</i> (place on the current layer, place on the target), with commas, semicolons or blanks "
        "between; lines that begin with # are comments. Or MeshLab's picked points (.pp): source, target, source, "
        "target, and so on. A place that is no vertex stands for the vertex nearest to it. <b>Empty</b> (the default): "
        "no landmarks; give some where limbs lie far from where they belong.");
    addParameter<host::RichFileParam>(
        list, Shown::Always, "target_landmarks_file", param.targetFile, QStringList() << "*.pp",
        "Picked points of the target (.pp)",
        "With MeshLab's picked points of the current layer as the file with landmarks: those of the target, whose "
        "names "
        "are the same. <b>Empty</b> (the default): that file holds both ends of each pair.");
    addParameter<RichFloat>(
        list, Shown::Advanced, "landmark_tolerance", Scalarm(fit.landmarkTolerance), "Tolerance of the landmarks",
        "So far from where it belongs, in world units, a landmark may stay. <b>0</b> (the default): none, it is exact. "
        "<b>Raise it</b> to the error of the points where they were measured or picked by hand. Pairs that the others "
        "contradict, such as two that are mixed up, are left out then; the log names them in any case.");
    addChecks(list, param);
    addParameter<RichBool>(list, Shown::Advanced, "landmarks_only", param.landmarksOnly, "Landmarks only",
                           "The surface follows the landmarks, as rigidly as its rigidity says, and nothing else of "
                           "the target counts: to see where they alone take it, or to morph it by them.");
    addParameter<RichEnum>(
        list, Shown::Always, "start", int(fit.start),
        QStringList() << "As they lie"
                      << "Rigid, from landmarks"
                      << "Rigid and scaled, from landmarks"
                      << "Axes tried out",
        "Start",
        "Where the layers do not lie on each other yet: moves all of the current one first, by the <b>landmarks</b> "
        "(three that are not on a line at least), or so that middle and <b>principal axes</b> fall together, of the 24 "
        "ways the one that fits best. Needs a layer without fixed vertices and handles. Where nothing of the two "
        "overlaps, "
        "and there are no landmarks, <b>As they lie</b> moves the layer onto the target's middle, too; and where it "
        "fits far better turned by its axes or scaled by up to 2.2, it begins so, and says so.");
    addParameter<RichFloat>(
        list, Shown::Always, "stiffness", Scalarm(fit.stiffness), "Stiffness (1 is the default, 10 stiff)",
        "How rigid the surface is in the end. <b>Raising it</b> smooths over noise and holes of the target; "
        "<b>lowering it</b> follows finer detail.");
    if (!host::firstMayBeLacking())
        addParameter<RichFloat>(
            list, Shown::Advanced, "rigidity", Scalarm(fit.rigidity), "Rigidity (1 rigid, 0 smooth)",
            "How much of the stiffness is against stretching, from 0 to 1. <b>1</b> (the default): as rigid as "
            "possible, for what bends, as bodies do. <b>0</b>: smooth, for what is sheared, scaled or grown all over, "
            "as one skull to another: only how the map changes from place to place costs, as in a thin-plate spline. "
            "What turns by far needs rigidity.");
    addParameter<RichFloat>(
        list, Shown::Always, "largest_distance", Scalarm(0), "Largest distance",
        "What is farther than this from the target, in world units, has no counterpart there and is carried along. "
        "<b>0</b> (the default): no limit, the distances themselves tell what is too far. <b>Lower it</b> where the "
        "target lacks parts that something else lies near to.");
    addParameter<RichFloat>(
        list, Shown::Advanced, "largest_angle", Scalarm(fit.largestAngle), "Largest angle (degrees)",
        "A place of the target whose normal is turned by more than this from that of the surface is no counterpart: "
        "what keeps the two sides of something thin apart. <b>180</b>: normals do not count.");
    addParameter<RichBool>(list, Shown::Always, "both_ways", fit.bothWays, "Matches both ways",
                           "Places of the target that nothing of the layer lies near draw what is nearest, too, so "
                           "that thin and long parts "
                           "of the target are reached. <b>Off</b> (the default): where parts of the target are left, "
                           "that is tried, and taken if nothing of it is left then and more of the layer has a "
                           "counterpart. Leave it off where the target has parts that the layer lacks.");
    addWeights(list, param);
    addInitialPatches(list, fit.graph.initialPatches);
    addSmoothness(list, Shown::Advanced, fit.smoothness);
    addRandomSeed(list, fit.graph.randomSeed);
    addParameter<RichInt>(list, Shown::Advanced, "samples", fit.samples, "Samples",
                          "How many places of the surface are matched, evenly spread. <b>Raising it</b> takes longer, "
                          "and helps where there are many patches.");
    addParameter<RichInt>(list, Shown::Advanced, "fit_steps", fit.fitSteps, "Steps",
                          "The surface gets softer from step to step, over so many at most, and the sooner the less it "
                          "moves. <b>Raise it</b> where it has far to go, or when the log says that it did not come to "
                          "rest.");
    addGraphLayers(list, param.graphLayers);
    addParameter<RichEnum>(
        list, Shown::Always, "fit_quality", int(param.quality),
        QStringList() << "As the input"
                      << "Distance to the target"
                      << "Matched",
        "Quality of the result",
        "What the vertex quality of the fitted layer is, to be coloured ('Colorize by vertex Quality'), selected by or "
        "saved: that of the input, the <b>distance</b> to the target in world units, or whether the vertex is "
        "<b>matched</b>: 1 where it lies on the target, but for a distance that the fit leaves there, 0 where it has "
        "no counterpart and was carried along.");
    addHandles(list, param.handles, document, Shown::Advanced);
    return list;
}

FitMeshParam fitMeshParam(const RichParameterList &list, const MeshDocument &document) {
    FitMeshParam param;
    param.target = host::layerParameter(list, "target_layer", document);
    param.landmarkFile = list.getOpenFileName("landmarks_file");
    param.targetFile = list.getOpenFileName("target_landmarks_file");
    param.fit.landmarkTolerance = asTyped(list.getFloat("landmark_tolerance"));
    param.fit.bothWays = list.getBool("both_ways");
    param.landmarksOnly = list.getBool("landmarks_only");
    if (list.hasParameter("check_file")) {
        param.checkFile = list.getOpenFileName("check_file");
        param.checkTargetFile = list.getOpenFileName("target_check_file");
        param.leaveOneOut = list.getBool("leave_one_out");
    }
    if (list.hasParameter("weights")) {
        param.weights = FitMeshParam::Weights(enumValue(list, "weights", 4));
        param.targetWeights = FitMeshParam::Weights(enumValue(list, "target_weights", 4));
        param.weightAttribute = list.getString("weight_attribute");
    }
    param.fit.start = vcg::fcd::FitStart(enumValue(list, "start", 4));
    param.handles = handleParam(list, document);
    param.handles.mayLack = true;
    vcg::fcd::FitParam &fit = param.fit;
    fit.stiffness = asTyped(list.getFloat("stiffness"));
    if (list.hasParameter("rigidity"))
        fit.rigidity = asTyped(list.getFloat("rigidity"));
    fit.largestDistance = asTyped(list.getFloat("largest_distance"));
    if (fit.largestDistance == 0)
        fit.largestDistance = std::numeric_limits<double>::infinity();
    fit.largestAngle = asTyped(list.getFloat("largest_angle"));
    fit.graph.initialPatches = list.getInt("initial_patches");
    fit.graph.randomSeed = unsigned(list.getInt("random_seed"));
    fit.smoothness = asTyped(list.getFloat("smoothness"));
    fit.samples = list.getInt("samples");
    fit.fitSteps = list.getInt("fit_steps");
    fit.Validate();
    param.graphLayers = list.getBool("graph_layers");
    param.quality = FitMeshParam::Quality(enumValue(list, "fit_quality", 3));
    return param;
}
