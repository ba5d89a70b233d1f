// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::Shown;

void ask(Fields &fields, StraightenMeshParam &param) {
    const MeshModel *current = fields.document.mm();
    const MeshModel *line = current; // the only layer with edges, or else the current one, which is no line
    int lines = 0;
    for (const MeshModel *layer : host::layers(fields.document))
        if (layer != current && layer->cm.en > 0) {
            line = layer;
            ++lines;
        }
    fields.layer("line_layer", param.lineLayer, lines == 1 ? line : current, Shown::Always, "Line",
                 "A layer with edges that form one open path. <b>The current layer itself</b>: the line comes from the "
                 "file below.");
    fields.openFile("line_file", param.lineFile, Shown::Always, {"*.pp", "*.csv", "*.txt"},
                    "Line file (.pp, .csv, .txt)",
                    "Picked points (.pp) in their order, or a list with <i>x, y, z</i> in each line, with commas, "
                    "semicolons or blanks; lines that begin with # are comments. World coordinates. <b>Empty</b> (the "
                    "default): the layer above is the line.");
    fields.field(
        "line_smoothing", param.smoothing, Shown::Advanced, "Line smoothing (percent of its length)",
        "Removes wiggles shorter than about three times this part of the length, such as the steps of a skeleton of "
        "voxels. 1 is much. <b>0</b> (the default): the line goes through its points. Only jitter of close points that "
        "would stretch the surface by more than a hundredth is removed; the log says how much there was.",
        -2);
    const StraightenTexts texts = straightenTexts();
    fields.field("middle", param.middle, Shown::Always, texts.middle);
    fields.choice("to", param.shape, Shown::Always, texts.shape);
    fields.field("angle", param.angle, Shown::Always, texts.angle);
    fields.direction("direction", param.direction, Shown::Always, texts.direction.label, texts.direction.help);
    fields.direction("towards", param.towards, Shown::Always, texts.towards.label, texts.towards.help);
    fields.layer("target_layer", param.targetLayer, current, Shown::Always, texts.target.label, texts.target.help);
    fields.field("reverse", param.reverse, Shown::Advanced, texts.reverse);
    fields.field("length", param.length, Shown::Always, texts.length);
    fields.field("untwist", param.untwist, Shown::Always, texts.untwist);
    askInitialPatches(fields, param.bend.graph);
    askSmoothness(fields, param.bend.smoothness);
    askRandomSeed(fields, param.bend.graph);
    askGraphLayers(fields, param.graphLayers);
    fields.choice("straightened_quality", param.quality, Shown::Advanced, {"As the input", "Place along the line"},
                  "Result quality",
                  "The vertex quality of the result: that of the input, or how far along the line the vertex is, in "
                  "world units from its beginning, for profiles and cuts.");
    if (fields.areRead())
        param.bend.Validate();
}
