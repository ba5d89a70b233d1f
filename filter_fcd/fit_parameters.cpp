// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::Shown;

namespace {

/// Curves that lead a fit, and pairs that it is judged by.
void askCurvesAndChecks(Fields &fields, FitMeshParam &param) {
    if (fields.hasNewer("curves_file"))
        fields.openFile(
            "curves_file", param.curveFile, Shown::Advanced, {"*.csv"}, "Curves (.csv)",
            "Lines of the two layers that belong together and slide along each other, such as lips, a ridge or a "
            "tooth's margin. A table with a first row <i>curve, surface, x, y, z</i> and a row for each corner of a "
            "line: the name of the curve, <i>source</i> (the current layer) or <i>target</i>, and the place, in world "
            "coordinates, in order along the line. A line is closed if its last corner is its first. The vertices "
            "along the source's line are drawn to the target's line. <b>Empty</b> (the default): none.");
    if (!fields.hasNewer("check_file"))
        return;
    fields.openFile("check_file", param.checkFile, Shown::Advanced, {"*.csv", "*.pp"}, "Check pairs (.csv, .pp)",
                    "Pairs as in the landmark file, kept back from the fit to judge it. The log tells how far they are "
                    "from where they belong. <b>Empty</b> (the default): none.");
    fields.openFile("target_check_file", param.checkTargetFile, Shown::Advanced, {"*.pp"},
                    "Target's check points (.pp)",
                    "The same points on the target, with the same names, if the check pairs are picked points of the "
                    "current layer alone.");
    fields.field("leave_one_out", param.leaveOneOut, Shown::Advanced, "Leave one landmark out",
                 "Also fits without each landmark in turn, and logs how far that landmark is then off. Takes as many "
                 "more fits as there are landmarks.");
}

/// How much of the two layers counts.
void askWeights(Fields &fields, FitMeshParam &param) {
    if (!fields.hasNewer("weights"))
        return;
    askWeightSource(
        fields, "weights", param.weights, "Weights from",
        "How much each vertex of the current layer counts, from 0 to 1. What has 0 is not matched and is <b>carried "
        "along</b>, such as the gum of a dental scan. <b>All counts</b> (the default), the <b>vertex quality</b>, the "
        "<b>selection</b>, or an <b>attribute</b>. Quality or selection are then not read as handles. A separate part "
        "without a counterpart is carried in any case, by the parts around it: an eyeball by its head.");
    askWeightSource(fields, "target_weights", param.targetWeights, "Target weights from",
                    "The same for the target's vertices: what has 0 is ignored.");
    askWeightAttribute(fields, param.weightAttribute,
                       "Name of the scalar attribute per vertex, on either layer, with weights from 0 to 1.");
}

} // namespace

void ask(Fields &fields, FitMeshParam &param) {
    vcg::fcd::FitParam &fit = param.fit;
    askOtherLayer(
        fields, "target_layer", param.target, "Target",
        "The layer to lie on: triangles, or a point cloud. A cloud's normals tell its sides apart. It is not changed.");
    fields.openFile(
        "landmarks_file", param.landmarkFile, Shown::Always, {"*.csv", "*.pp"}, "Landmark file (.csv, .pp)",
        "Pairs of points that belong together, in world coordinates. A list has a line for each pair: <i>vertex, x, y, "
        "z</i> (number of the vertex of the current layer, from 0, and place on the target) or <i>x, y, z, x, y, z</i> "
        "(place on the current layer, place on the target). Commas, semicolons or blanks separate them; # begins a "
        "comment. Picked points (.pp) alternate source and target. A place stands for the vertex nearest to it. "
        "<b>Empty</b> (the default): none. Give some where limbs lie far from where they belong.");
    fields.openFile("target_landmarks_file", param.targetFile, Shown::Always, {"*.pp"}, "Target's picked points (.pp)",
                    "The same points on the target, with the same names, if the landmark file has picked points of the "
                    "current layer alone. <b>Empty</b> (the default): the landmark file holds both ends.");
    askLandmarkTolerance(fields, fit);
    askCurvesAndChecks(fields, param);
    fields.field(
        "landmarks_only", param.landmarksOnly, Shown::Advanced, "Landmarks only",
        "The surface follows the landmarks, as rigidly as 'rigidity' says. Nothing else of the target counts.");
    fields.choice(
        "start", fit.start, Shown::Always,
        {"As they lie", "Rigid, from landmarks", "Rigid and scaled, from landmarks", "Axes tried out"}, "Start",
        "How the current layer is first moved onto the target, if it does not lie there: by <b>landmarks</b> (at least "
        "three that are not on a line), or principal <b>axes</b> onto principal axes, in the best of 24 ways. Needs a "
        "layer without fixed vertices and handles. Without landmarks, and where the layers do not overlap, <b>As they "
        "lie</b> begins at the target's middle; the log says so. If the layer comes out strained, it is "
        "tried turned by its axes, and scaled, and the log says which.");
    askStiffness(fields, fit);
    if (fields.hasNewer("rigidity"))
        fields.field("rigidity", fit.fitRigidity, Shown::Advanced, rigidityText());
    askLargestDistance(fields, fit.largestDistance,
                       "What is farther from the target, in world units, has no counterpart and is carried along. "
                       "<b>0</b> (the default): no limit; the distances tell what is too far. <b>Lower it</b> where "
                       "the target lacks parts that something else lies near to.");
    fields.field("largest_angle", fit.largestAngle, Shown::Advanced, "Largest angle (degrees)",
                 "A place of the target whose normal differs by more is no counterpart. That keeps the two sides of "
                 "something thin apart. <b>180</b>: normals do not count.");
    fields.field(
        "both_ways", fit.bothWays, Shown::Advanced, "Match both ways",
        "Places of the target that nothing lies near draw what is nearest. So thin and long parts of the target are "
        "reached. <b>Off</b> (the default): tried if parts of the target are left, and kept if it reaches them and "
        "matches more of the layer. Leave it off if the target has parts that the layer lacks.");
    askWeights(fields, param);
    askSampling(fields, fit);
    askGraphLayers(fields, param.graphLayers);
    fields.choice("fit_quality", param.quality, Shown::Always, {"As the input", "Distance to the target", "Matched"},
                  "Result quality",
                  "The vertex quality of the result, to colour, select or save: that of the input, the <b>distance</b> "
                  "to the target in world units, or <b>matched</b>: 1 where it lies on the target, 0 where it has no "
                  "counterpart and was carried along.");
    askHandles(fields, param.handles, Shown::Advanced);
    param.handles.mayLack = true;
    if (fields.areRead())
        fit.Validate();
}
