// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::Shown;

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
