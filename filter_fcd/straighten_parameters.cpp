// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

#include <layer_fcd/straighten_texts.h>

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
    host::addLayerParameter(list, Shown::Always, "line_layer", lines == 1 ? line : current, document, "Line",
                            "A layer with edges that form one open path. <b>The current layer itself</b>: the line "
                            "comes from the file below.");
    addParameter<host::RichFileParam>(list, Shown::Always, "line_file", param.lineFile,
                                      QStringList() << "*.pp"
                                                    << "*.csv"
                                                    << "*.txt",
                                      "Line file (.pp, .csv, .txt)",
                                      "Picked points (.pp) in their order, or a list with <i>x, y, z</i> in each line, "
                                      "with commas, semicolons or blanks; lines that begin with # are comments. World "
                                      "coordinates. <b>Empty</b> (the default): the layer above is the line.");
    addParameter<RichFloat>(
        list, Shown::Advanced, "line_smoothing", Scalarm(100 * param.smoothing),
        "Line smoothing (percent of its length)",
        "Takes out wiggles shorter than some six times this part of the length, such as the steps of a skeleton of "
        "voxels. 1 is much. <b>0</b> (the default): the line goes through its points. Only jitter of close points is "
        "taken out where it would stretch the surface by more than a hundredth; the log says how much there was.");
    const StraightenTexts texts = straightenTexts();
    addParameter<RichBool>(list, Shown::Always, "middle", param.middle, texts.middle.label, texts.middle.help);
    addParameter<RichEnum>(list, Shown::Always, "to", int(param.shape), texts.shape.values, texts.shape.label,
                           texts.shape.help);
    addParameter<RichFloat>(list, Shown::Always, "angle", Scalarm(param.angle), texts.angle.label, texts.angle.help);
    addParameter<host::RichDirectionParam>(list, Shown::Always, "direction", toPoint(param.direction),
                                           texts.direction.label, texts.direction.help);
    addParameter<host::RichDirectionParam>(list, Shown::Always, "towards", toPoint(param.towards), texts.towards.label,
                                           texts.towards.help);
    host::addLayerParameter(list, Shown::Always, "target_layer", current, document, texts.target.label,
                            texts.target.help);
    addParameter<RichBool>(list, Shown::Advanced, "reverse", param.reverse, texts.reverse.label, texts.reverse.help);
    addParameter<RichFloat>(list, Shown::Always, "length", Scalarm(param.length), texts.length.label,
                            texts.length.help);
    addParameter<RichBool>(list, Shown::Always, "untwist", param.untwist, texts.untwist.label, texts.untwist.help);
    addInitialPatches(list, param.bend.graph.initialPatches);
    addSmoothness(list, Shown::Advanced, param.bend.smoothness);
    addRandomSeed(list, param.bend.graph.randomSeed);
    addGraphLayers(list, param.graphLayers);
    addParameter<RichEnum>(list, Shown::Advanced, "straightened_quality", int(param.quality),
                           QStringList() << "As the input"
                                         << "Place along the line",
                           "Result quality",
                           "The vertex quality of the result: that of the input, or how far along the line the vertex "
                           "is, in world units from its beginning, for profiles and cuts.");
    return list;
}

StraightenMeshParam straightenMeshParam(const RichParameterList &list, const MeshDocument &document) {
    StraightenMeshParam param;
    param.lineLayer = host::layerParameter(list, "line_layer", document);
    param.lineFile = list.getOpenFileName("line_file");
    param.smoothing = asTyped(list.getFloat("line_smoothing"), -2);
    param.middle = list.getBool("middle");
    param.shape = StraightenMeshParam::Shape(enumValue(list, "to", 3));
    param.angle = asTyped(list.getFloat("angle"));
    param.direction = toVector(list.getPoint3m("direction"));
    param.towards = toVector(list.getPoint3m("towards"));
    param.targetLayer = host::layerParameter(list, "target_layer", document);
    param.reverse = list.getBool("reverse");
    param.length = asTyped(list.getFloat("length"));
    param.untwist = list.getBool("untwist");
    param.bend.graph.initialPatches = list.getInt("initial_patches");
    param.bend.graph.randomSeed = unsigned(list.getInt("random_seed"));
    param.bend.smoothness = asTyped(list.getFloat("smoothness"));
    param.bend.Validate();
    param.graphLayers = list.getBool("graph_layers");
    param.quality = StraightenMeshParam::Quality(enumValue(list, "straightened_quality", 2));
    return param;
}
