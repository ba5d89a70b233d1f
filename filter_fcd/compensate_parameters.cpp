// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::addParameter;
using host::Shown;

RichParameterList toRichParameters(const CompensateLayerParam &param, const MeshDocument &document) {
    RichParameterList list;
    addOtherLayer(list, "scan_layer", param.scan, document, "Scan",
                  "The scan of the printed part: triangles, or a point cloud. A cloud's normals tell the two sides of "
                  "something thin apart. It is not changed.");
    addParameter<RichInt>(list, Shown::Always, "degree", param.compensation.degree, "Degree of the warp (1 to 7)",
                          "Of the polynomial that warps: <b>1</b> is shrinkage and shear. <b>Raise it</b> for finer "
                          "warps; <b>lower it</b> where little is scanned, or the log says that the warp cannot be "
                          "turned round.");
    addLargestDistance(list, "What is farther than this from the scan, in world units, is not scanned. <b>0</b> (the "
                             "default): no limit. <b>Lower it</b> where the scan has more than the part, such as a "
                             "table.");
    addSamples(list, param.compensation.samples,
               "How many places of the nominal part are matched, evenly spread. <b>Raise it</b> for a noisy scan.");
    addParameter<RichEnum>(list, Shown::Always, "compensated_quality", int(param.quality),
                           QStringList() << "As the input"
                                         << "Change",
                           "Result quality",
                           "The vertex quality of the result, to colour, select or save: that of the input, or the "
                           "<b>change</b>: how far it is from the nominal part, in world units.");
    return list;
}

CompensateLayerParam compensateParam(const RichParameterList &list, const MeshDocument &document) {
    CompensateLayerParam param;
    param.scan = host::layerParameter(list, "scan_layer", document);
    param.compensation.degree = list.getInt("degree");
    param.compensation.largestDistance = largestDistance(list);
    param.compensation.samples = list.getInt("samples");
    param.quality = CompensateLayerParam::Quality(enumValue(list, "compensated_quality", 2));
    return param;
}
