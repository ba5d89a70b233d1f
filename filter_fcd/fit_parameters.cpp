// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_parameters.h"

#include <limits>

using host::Shown;

// The filters that match surfaces.

namespace {

/// The target. The default is the only other layer, or else the current one, which is no target.
void askOtherLayer(Fields &fields, const QString &name, const MeshModel *&layer, const QString &label,
                   const QString &help) {
    const MeshModel *current = fields.document.mm();
    const std::vector<const MeshModel *> layers = host::layers(fields.document);
    const MeshModel *likely = layers.size() != 2 ? current : layers[layers[0] == current ? 1 : 0];
    fields.layer(name, layer, likely, Shown::Always, label, help);
}

void askWeightSource(Fields &fields, const QString &name, FitMeshParam::Weights &weights, const QString &label,
                     const QString &help) {
    fields.choice(name, weights, Shown::Always, {"All counts", "Vertex quality", "Selected vertices", "Attribute"},
                  label, help);
}

void askWeightAttribute(Fields &fields, QString &name, const QString &help) {
    fields.field("weight_attribute", name, Shown::Advanced, "Attribute with weights", help);
}

void askStiffness(Fields &fields, vcg::fcd::FitParam &fit) {
    fields.field("stiffness", fit.stiffness, Shown::Always, "Stiffness (1 is the default, 10 stiff)",
                 "How rigid the surface is in the end. <b>Raise it</b> to smooth over noise and holes of the target. "
                 "<b>Lower it</b> to follow finer detail.");
}

/// 0 for infinite.
void askLargestDistance(Fields &fields, double &distance, const QString &help) {
    double limit = 0;
    fields.field("largest_distance", limit, Shown::Always, "Largest distance", help);
    distance = limit == 0 ? std::numeric_limits<double>::infinity() : limit;
}

void askLandmarkTolerance(Fields &fields, vcg::fcd::FitParam &fit) {
    fields.field("landmark_tolerance", fit.landmarkTolerance, Shown::Advanced, "Landmark tolerance",
                 "How far a landmark may stay from where it belongs, in world units. <b>0</b> (the default): it is "
                 "exact. <b>Raise it</b> to the error of measured or picked points. The fit then leaves out pairs that "
                 "the others contradict, such as two that are mixed up. The log names them in any case.");
}

void askSamples(Fields &fields, int &samples, const QString &help) {
    fields.field("samples", samples, Shown::Advanced, "Samples", help);
}

/// The graph, samples and steps.
void askSampling(Fields &fields, vcg::fcd::FitParam &fit) {
    askInitialPatches(fields, fit.graph);
    askSmoothness(fields, fit.smoothness);
    askRandomSeed(fields, fit.graph);
    askSamples(fields, fit.samples,
               "How many places of the surface the fit matches, evenly spread. <b>Raise it</b> where there are many "
               "patches; it takes longer.");
    fields.field("fit_steps", fit.fitSteps, Shown::Advanced, "Steps",
                 "The most steps from stiff to soft; the less the surface moves, the fewer it takes. <b>Raise it</b> "
                 "where it has far to go, or when the log says that it did not converge.");
}

/// Curves that lead a fit, and pairs that it is judged by.
void askCurvesAndChecks(Fields &fields, FitMeshParam &param) {
    if (fields.hasNewer("curves_file"))
        fields.openFile(
            "curves_file", param.curveFile, Shown::Advanced, {"*.csv"}, "Curves (.csv)",
            "Lines of the two layers that belong together and slide along each other, such as lips, a ridge or a "
            "tooth's margin. A table with a first row <i>curve, surface, x, y, z</i> and a row for each corner of a "
            "line: the name of the curve, <i>source</i> (the current layer) or <i>target</i>, and the place, in world "
            "coordinates, in order along the line. A line is closed if its last corner is its first. The vertices "
            "along the source's line slide along the target's line. <b>Empty</b> (the default): none.");
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
        "How much each vertex of the current layer counts, from 0 to 1. Vertices of weight 0 are not matched and go "
        "along, such as the gum of a dental scan. <b>All counts</b> (the default), the <b>vertex quality</b>, the "
        "<b>selection</b>, or an <b>attribute</b>. Quality or selection are then not read as handles. A separate part "
        "without a counterpart goes along in any case, with the parts around it: an eyeball with its head.");
    askWeightSource(fields, "target_weights", param.targetWeights, "Target weights from",
                    "The same for the target: the fit ignores vertices of weight 0.");
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
        "comment. Picked points (.pp) alternate source and target. A place between vertices goes with the nearest one. "
        "<b>Empty</b> (the default): none. Give some where limbs lie far from where they belong.");
    fields.openFile("target_landmarks_file", param.targetFile, Shown::Always, {"*.pp"}, "Target's picked points (.pp)",
                    "The same points on the target, with the same names, if the landmark file has picked points of the "
                    "current layer alone. <b>Empty</b> (the default): the landmark file holds both ends.");
    askLandmarkTolerance(fields, fit);
    askCurvesAndChecks(fields, param);
    fields.field(
        "landmarks_only", param.landmarksOnly, Shown::Advanced, "Landmarks only",
        "The surface follows the landmarks, as rigidly as 'rigidity' says. Nothing else of the target counts.");
    fields.choice("start", fit.start, Shown::Always,
                  {"As they lie", "Rigid, from landmarks", "Rigid and scaled, from landmarks", "Axes tried out"},
                  "Start",
                  "How the fit first moves the layer onto the target, if it does not lie there: by <b>landmarks</b> "
                  "(at least three that are not on a line), or principal <b>axes</b> onto principal axes, in the best "
                  "of 24 ways. Needs a layer without fixed vertices and handles. <b>As they lie</b> (the default) "
                  "moves nothing, or, if the layers do not overlap and there are no landmarks, begins at the target's "
                  "middle. If that strains the layer, the fit tries to turn and scale it. The log says what it did.");
    askStiffness(fields, fit);
    if (fields.hasNewer("rigidity"))
        fields.field("rigidity", fit.fitRigidity, Shown::Advanced, rigidityText());
    askLargestDistance(fields, fit.largestDistance,
                       "Parts farther than this from the target, in world units, have no counterpart and go along. "
                       "<b>0</b> (the default): no limit; the distances tell what is too far. <b>Lower it</b> if the "
                       "target lacks a part and something else lies near its place.");
    fields.field("largest_angle", fit.largestAngle, Shown::Advanced, "Largest angle (degrees)",
                 "A place of the target is no counterpart if its normal differs by more. That keeps the two sides of "
                 "thin parts apart. <b>180</b>: normals do not count.");
    fields.field("both_ways", fit.bothWays, Shown::Advanced, "Match both ways",
                 "Places of the target with nothing near them draw the nearest surface. So the fit reaches thin and "
                 "long parts of the target. <b>Off</b> (the default): the fit tries this only if parts of the target "
                 "are left, and keeps it if it reaches them and matches more of the layer. Leave it off if the target "
                 "has parts that the layer lacks.");
    askWeights(fields, param);
    askSampling(fields, fit);
    askGraphLayers(fields, param.graphLayers);
    fields.choice(
        "fit_quality", param.quality, Shown::Always, {"As the input", "Distance to the target", "Matched"},
        "Result quality",
        "The vertex quality of the result, to colour, select or save: that of the input, the <b>distance</b> to the "
        "target in world units, or <b>matched</b>: 1 where it lies on the target, 0 where it has no counterpart.");
    askHandles(fields, param.handles, Shown::Advanced);
    param.handles.mayLack = true;
    fit.Validate();
}

// Parameters of the filters that match surfaces, and of two of them.

using host::Shown;

void ask(Fields &fields, SymmetrizeParam &param) {
    vcg::fcd::FitParam &fit = param.fit;
    fields.openFile("pairs_file", param.pairsFile, Shown::Always, {"*.csv", "*.pp"},
                    "File with pairs, left and right (.csv, .pp)",
                    "Landmarks that are mirror images of each other, in world coordinates. Either a list with a line "
                    "for each pair: <i>x, y, z, x, y, z</i>, with commas, semicolons or blanks between; lines that "
                    "begin with # are comments. Or MeshLab's picked points (.pp): left, right, left, right, and so on. "
                    "<b>Empty</b> (the default): none; give some where the surface is too smooth to tell.");
    fields.openFile("midline_file", param.midlineFile, Shown::Always, {"*.pp", "*.csv", "*.txt"},
                    "File with points of the midline (.pp, .csv, .txt)",
                    "Points of the surface that belong on the plane of symmetry: MeshLab's picked points (.pp), or a "
                    "list with <i>x, y, z</i> in each line. World coordinates. <b>Empty</b> (the default): none.");
    fields.position("plane_point", param.planePoint, Shown::Always, "A point on the plane",
                    "A point on the plane of symmetry, in world coordinates. Only read if you give its normal.");
    fields.direction(
        "plane_normal", param.planeNormal, Shown::Always, "Normal of the plane",
        "Normal of the plane of symmetry, of any length. <b>0 0 0</b> (the default): the plane follows from the pairs "
        "and the midline; without these, it is the one in which the surface is most like its mirror image.");
    askWeightSource(fields, "weights", param.weights, "Weights from",
                    "How much each vertex counts, from 0 to 1. Vertices of weight 0 are not matched and go along, such "
                    "as a growth on one side. <b>All counts</b> (the default), the <b>vertex quality</b>, the "
                    "<b>selection</b>, or an <b>attribute</b>.");
    askWeightAttribute(fields, param.weightAttribute,
                       "Name of the scalar attribute per vertex with weights from 0 to 1.");
    fields.field("mirror_missing", param.mirrorMissing, Shown::Always, "Mirror what is missing",
                 "Also adds a layer with the mirror image of all parts that have no counterpart on the other side. "
                 "Join it with the result to fill what is missing.");
    askStiffness(fields, fit);
    askLargestDistance(fields, fit.largestDistance,
                       "Parts farther than this from the mirror image, in world units, have no counterpart there and "
                       "go along. <b>0</b> (the default): no limit.");
    askLandmarkTolerance(fields, fit);
    askSampling(fields, fit);
    askGraphLayers(fields, param.graphLayers);
    fields.choice("symmetrized_quality", param.quality, Shown::Always,
                  {"As the input", "Asymmetry", "Way moved", "Matched"}, "Result quality",
                  "The vertex quality of the result, to colour, select or save. <b>Asymmetry</b>: how far the vertex "
                  "was from the mirror image of its counterpart. <b>Way moved</b>: how far it moved. Both in world "
                  "units. <b>Matched</b>: 1 where it has a counterpart on the other side, else 0.");
    fit.ValidateFit();
}

void ask(Fields &fields, CompensateLayerParam &param) {
    askOtherLayer(fields, "scan_layer", param.scan, "Scan",
                  "The scan of the printed part: triangles, or a point cloud. A cloud's normals tell the two sides of "
                  "something thin apart. It is not changed.");
    fields.field("degree", param.compensation.degree, Shown::Always, "Degree of the warp (1 to 7)",
                 "Degree of the polynomial: <b>1</b> is shrinkage and shear. <b>Raise it</b> for finer warps; <b>lower "
                 "it</b> where little is scanned, or the log says that the warp cannot be turned round.");
    askLargestDistance(fields, param.compensation.largestDistance,
                       "Parts farther than this from the scan, in world units, count as not scanned. <b>0</b> (the "
                       "default): no limit. <b>Lower it</b> if the scan has more than the part, such as a table.");
    askSamples(
        fields, param.compensation.samples,
        "How many places of the nominal part the filter matches, evenly spread. <b>Raise it</b> for a noisy scan.");
    fields.choice("compensated_quality", param.quality, Shown::Always, {"As the input", "Change"}, "Result quality",
                  "The vertex quality of the result, to colour, select or save: that of the input, or the "
                  "<b>change</b>: how far it is from the nominal part, in world units.");
}
