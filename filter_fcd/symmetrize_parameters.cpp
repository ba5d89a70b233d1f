// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::addParameter;
using host::Shown;

RichParameterList toRichParameters(const SymmetrizeParam &param, const MeshDocument &) {
    const vcg::fcd::FitParam &fit = param.fit;
    RichParameterList list;
    addParameter<host::RichFileParam>(
        list, Shown::Always, "pairs_file", param.pairsFile,
        QStringList() << "*.csv"
                      << "*.pp",
        "File with pairs, left and right (.csv, .pp)",
        "Landmarks that belong to each other's mirror image, in world coordinates. Either a list with a line for each "
        "pair: <i>x, y, z, x, y, z</i>, with commas, semicolons or blanks between; lines that begin with # are "
        "comments. Or MeshLab's picked points (.pp): left, right, left, right, and so on. <b>Empty</b> (the default): "
        "none; give some where the surface is too smooth to tell.");
    addParameter<host::RichFileParam>(
        list, Shown::Always, "midline_file", param.midlineFile,
        QStringList() << "*.pp"
                      << "*.csv"
                      << "*.txt",
        "File with points of the midline (.pp, .csv, .txt)",
        "Points of the surface that belong on the plane of symmetry: MeshLab's picked points (.pp), or a list with "
        "<i>x, y, z</i> in each line. World coordinates. <b>Empty</b> (the default): none.");
    addParameter<host::RichPositionParam>(list, Shown::Always, "plane_point", toPoint(param.planePoint),
                                          "A point on the plane",
                                          "Of symmetry, in world coordinates. Only read where its normal is given.");
    addParameter<host::RichDirectionParam>(
        list, Shown::Always, "plane_normal", toPoint(param.planeNormal), "Normal of the plane",
        "Of symmetry, of any length. <b>0 0 0</b> (the default): the plane is that of the pairs and the midline, or, "
        "where they do not tell one, that in which the surface is most like its mirror image.");
    addWeightSource(
        list, "weights", param.weights, "What counts",
        "How much each vertex counts: from 0, which is <b>carried along</b> and not matched, as a growth on "
        "one side, to 1. <b>All counts</b> (the default), the <b>vertex quality</b>, what is "
        "<b>selected</b>, or an <b>attribute</b>.");
    addWeightAttribute(list, param.weightAttribute,
                       "Name of the scalar attribute per vertex that tells how much it counts, 0 to 1.");
    addParameter<RichBool>(list, Shown::Always, "mirror_missing", param.mirrorMissing, "Mirror what is missing",
                           "Also adds a layer with the mirror images of what has no counterpart on the other side: the "
                           "good side over a missing one, to be joined with the result.");
    addStiffness(list, fit);
    addLargestDistance(list,
                       "What is farther than this from the mirror image, in world units, has no counterpart there "
                       "and is carried along. <b>0</b> (the default): no limit.");
    addLandmarkTolerance(list, fit);
    addSampling(list, fit);
    addGraphLayers(list, param.graphLayers);
    addParameter<RichEnum>(list, Shown::Always, "symmetrized_quality", int(param.quality),
                           QStringList() << "As the input"
                                         << "Asymmetry"
                                         << "Way moved"
                                         << "Matched",
                           "Quality of the result",
                           "What the vertex quality of the symmetrized layer is, to be coloured ('Colorize by vertex "
                           "Quality') or saved: that of the input, its <b>asymmetry</b> (how far it was from where the "
                           "mirror image of its counterpart is, in world units), the <b>way</b> that it was moved, or "
                           "whether it is <b>matched</b>: 1 where it has a counterpart on the other side, else 0.");
    return list;
}

SymmetrizeParam symmetrizeParam(const RichParameterList &list) {
    SymmetrizeParam param;
    param.pairsFile = list.getOpenFileName("pairs_file");
    param.midlineFile = list.getOpenFileName("midline_file");
    param.planePoint = toVector(list.getPoint3m("plane_point"));
    param.planeNormal = toVector(list.getPoint3m("plane_normal"));
    param.weights = FitMeshParam::Weights(enumValue(list, "weights", 4));
    param.weightAttribute = list.getString("weight_attribute");
    param.mirrorMissing = list.getBool("mirror_missing");
    readFitting(list, param.fit);
    param.fit.ValidateFit();
    param.graphLayers = list.getBool("graph_layers");
    param.quality = SymmetrizeParam::Quality(enumValue(list, "symmetrized_quality", 4));
    return param;
}
