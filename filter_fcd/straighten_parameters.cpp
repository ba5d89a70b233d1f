// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::addParameter;
using host::Shown;

RichParameterList toRichParameters(const StraightenMeshParam &param, const MeshDocument &document) {
    const MeshModel *current = const_cast<MeshDocument &>(document).mm(); // which is not changed
    const MeshModel *line = current; // the only one with edges, or else the current one, which is no line
    int lines = 0;
    for (const MeshModel *layer : host::layers(document))
        if (layer != current && layer->cm.en > 0) {
            line = layer;
            ++lines;
        }
    RichParameterList list;
    host::addLayerParameter(
        list, Shown::Always, "line_layer", lines == 1 ? line : current, document, "Line",
        "A layer with edges that form one open path: the line that the current layer is straightened along. <b>The "
        "current layer itself</b>: the line comes from the file below.");
    addParameter<host::RichFileParam>(
        list, Shown::Always, "line_file", param.lineFile,
        QStringList() << "*.pp"
                      << "*.csv"
                      << "*.txt",
        "File with the line (.pp, .csv, .txt)",
        "MeshLab's picked points (.pp), in their order, or a list with <i>x, y, z</i> in each line, with commas, "
        "semicolons or blanks between; lines that begin with # are comments. World coordinates. <b>Empty</b> (the "
        "default): the line is that of the layer above.");
    addParameter<RichFloat>(
        list, Shown::Always, "line_smoothing", Scalarm(100 * param.smoothing),
        "Smooth the line (percent of its length)",
        "Smooths wiggles of the line away that are shorter than some six times this part of its length, such as the "
        "steps of a skeleton of voxels; 1 is much. <b>0</b> (the default): the line goes through its points.");
    addParameter<RichBool>(
        list, Shown::Always, "middle", param.middle, "Through the middle",
        "Takes the line through the middles of the surface's cross-sections along the given one, which may then lie on "
        "the surface, as picked points do. Without it, what lies beside the line at the inner side of a bend gets "
        "longer, and the line keeps its length.");
    addParameter<RichEnum>(list, Shown::Always, "to", int(param.shape),
                           QStringList() << "A straight line"
                                         << "An arc"
                                         << "The line of a layer",
                           "Becomes",
                           "What the line becomes. A straight line, or an arc of a circle, lies where the line does: "
                           "their middles are at one place. The frames along the line turn as little as they may.");
    addParameter<RichFloat>(list, Shown::Always, "angle", Scalarm(param.angle), "Angle of the arc (degrees)",
                            "By how much the arc bends from end to end, less than 360; negative: to the other side.");
    addParameter<host::RichDirectionParam>(
        list, Shown::Always, "direction", toPoint(param.direction), "Direction",
        "That of the straight line, or of the middle of the arc. <b>0 0 0</b> (the default): from end to end of the "
        "line.");
    addParameter<host::RichDirectionParam>(list, Shown::Always, "towards", toPoint(param.towards), "Bends towards",
                                           "The direction to which the ends of the arc bend. <b>0 0 0</b> (the "
                                           "default): to where those of the line do.");
    host::addLayerParameter(
        list, Shown::Always, "target_layer", current, document, "Line of a layer",
        "A layer with edges that form one open path. The line is laid along it from its beginning, "
        "and goes on straight where it is longer. Only read when the line becomes that of a layer.");
    addParameter<RichBool>(list, Shown::Always, "reverse", param.reverse, "From its other end",
                           "Lays the line along that of the layer from its other end. A line of a layer begins at the "
                           "end whose vertex has the smaller number.");
    addParameter<RichFloat>(list, Shown::Always, "length", Scalarm(param.length), "Length",
                            "How long the line gets, in world units: the surface is stretched along it, and keeps its "
                            "cross-sections. <b>0</b> (the default): as long as it is.");
    addParameter<RichBool>(list, Shown::Always, "untwist", param.untwist, "Take the twist out",
                           "Turns the cross-sections about the line so that their longest axes lie alike, as that in "
                           "the middle. They must "
                           "not be round. Without it, the twist stays as it is.");
    addInitialPatches(list, param.bend.graph.initialPatches);
    addSmoothness(list, Shown::Advanced, param.bend.smoothness);
    addRandomSeed(list, param.bend.graph.randomSeed);
    addGraphLayers(list, param.graphLayers);
    addParameter<RichEnum>(list, Shown::Always, "straightened_quality", int(param.quality),
                           QStringList() << "As the input"
                                         << "Place along the line",
                           "Quality of the result",
                           "What the vertex quality of the straightened layer is: that of the input, or how far along "
                           "the line the vertex is, in world units from its beginning, for profiles and cuts.");
    return list;
}

StraightenMeshParam straightenMeshParam(const RichParameterList &list, const MeshDocument &document) {
    StraightenMeshParam param;
    param.lineLayer = host::layerParameter(list, "line_layer", document);
    param.lineFile = list.getOpenFileName("line_file");
    param.smoothing = list.getFloat("line_smoothing") / 100;
    param.middle = list.getBool("middle");
    param.shape = StraightenMeshParam::Shape(enumValue(list, "to", 3));
    param.angle = list.getFloat("angle");
    param.direction = toVector(list.getPoint3m("direction"));
    param.towards = toVector(list.getPoint3m("towards"));
    param.targetLayer = host::layerParameter(list, "target_layer", document);
    param.reverse = list.getBool("reverse");
    param.length = list.getFloat("length");
    param.untwist = list.getBool("untwist");
    param.bend.graph.initialPatches = list.getInt("initial_patches");
    param.bend.graph.randomSeed = unsigned(list.getInt("random_seed"));
    param.bend.smoothness = list.getFloat("smoothness");
    param.bend.Validate();
    param.graphLayers = list.getBool("graph_layers");
    param.quality = StraightenMeshParam::Quality(enumValue(list, "straightened_quality", 2));
    return param;
}
