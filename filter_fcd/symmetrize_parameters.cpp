// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

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
