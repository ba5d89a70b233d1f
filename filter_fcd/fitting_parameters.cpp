// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

#include <limits>

// Parameters of the filters that match surfaces, and of two of them.

using host::Shown;

namespace {

/// The default target: the only other layer, or else the current one, which is no target.
const MeshModel *likelyTarget(const MeshDocument &document) {
    const std::vector<const MeshModel *> layers = host::layers(document);
    if (layers.size() != 2)
        return document.mm();
    return layers[0] == document.mm() ? layers[1] : layers[0];
}

} // namespace

void askOtherLayer(Fields &fields, const QString &name, const MeshModel *&layer, const QString &label,
                   const QString &help) {
    fields.layer(name, layer, likelyTarget(fields.document), Shown::Always, label, help);
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

void askLargestDistance(Fields &fields, double &distance, const QString &help) {
    double limit = 0;
    fields.field("largest_distance", limit, Shown::Always, "Largest distance", help);
    distance = limit == 0 ? std::numeric_limits<double>::infinity() : limit;
}

void askLandmarkTolerance(Fields &fields, vcg::fcd::FitParam &fit) {
    fields.field("landmark_tolerance", fit.landmarkTolerance, Shown::Advanced, "Landmark tolerance",
                 "How far a landmark may stay from where it belongs, in world units. <b>0</b> (the default): it is "
                 "exact. <b>Raise it</b> to the error of measured or picked points. Pairs that the others contradict, "
                 "such as two that are mixed up, are then left out. The log names them in any case.");
}

void askSamples(Fields &fields, int &samples, const QString &help) {
    fields.field("samples", samples, Shown::Advanced, "Samples", help);
}

void askSampling(Fields &fields, vcg::fcd::FitParam &fit) {
    askInitialPatches(fields, fit.graph);
    askSmoothness(fields, fit.smoothness);
    askRandomSeed(fields, fit.graph);
    askSamples(fields, fit.samples,
               "How many places of the surface are matched, evenly spread. <b>Raise it</b> where there are many "
               "patches; it takes longer.");
    fields.field("fit_steps", fit.fitSteps, Shown::Advanced, "Steps",
                 "The most steps from stiff to soft; the less the surface moves, the fewer it takes. <b>Raise it</b> "
                 "where it has far to go, or when the log says that it did not converge.");
}

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
                    "A point on the plane of symmetry, in world coordinates. Only read if its normal is given.");
    fields.direction(
        "plane_normal", param.planeNormal, Shown::Always, "Normal of the plane",
        "Normal of the plane of symmetry, of any length. <b>0 0 0</b> (the default): the plane follows from the pairs "
        "and the midline, or else is the one in which the surface is most like its mirror image.");
    askWeightSource(fields, "weights", param.weights, "Weights from",
                    "How much each vertex counts, from 0 to 1. What has 0 is not matched and is <b>carried along</b>, "
                    "such as a growth on one side. <b>All counts</b> (the default), the <b>vertex quality</b>, what is "
                    "<b>selected</b>, or an <b>attribute</b>.");
    askWeightAttribute(fields, param.weightAttribute,
                       "Name of the scalar attribute per vertex with weights from 0 to 1.");
    fields.field("mirror_missing", param.mirrorMissing, Shown::Always, "Mirror what is missing",
                 "Also adds a layer with the mirror images of what has no counterpart on the other side: the good side "
                 "over a missing one, to be joined with the result.");
    askStiffness(fields, fit);
    askLargestDistance(fields, fit.largestDistance,
                       "What is farther than this from the mirror image, in world units, has no counterpart there and "
                       "is carried along. <b>0</b> (the default): no limit.");
    askLandmarkTolerance(fields, fit);
    askSampling(fields, fit);
    askGraphLayers(fields, param.graphLayers);
    fields.choice("symmetrized_quality", param.quality, Shown::Always,
                  {"As the input", "Asymmetry", "Way moved", "Matched"}, "Result quality",
                  "The vertex quality of the result, to colour, select or save. <b>Asymmetry</b>: how far the vertex "
                  "was from the mirror image of its counterpart. <b>Way moved</b>: how far it was moved. Both in world "
                  "units. <b>Matched</b>: 1 where it has a counterpart on the other side, else 0.");
    if (fields.areRead())
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
                       "What is farther than this from the scan, in world units, counts as not scanned. <b>0</b> (the "
                       "default): no limit. <b>Lower it</b> where the scan has more than the part, such as a table.");
    askSamples(fields, param.compensation.samples,
               "How many places of the nominal part are matched, evenly spread. <b>Raise it</b> for a noisy scan.");
    fields.choice("compensated_quality", param.quality, Shown::Always, {"As the input", "Change"}, "Result quality",
                  "The vertex quality of the result, to colour, select or save: that of the input, or the "
                  "<b>change</b>: how far it is from the nominal part, in world units.");
}
