// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

#include <cmath>

using host::addParameter;
using host::Shown;
using vcg::fcd::Error;

namespace {

Scalarm diagonal(const MeshDocument &document) {
    const MeshModel *layer = document.mm();
    const Scalarm length = layer && !layer->cm.bbox.IsNull() ? layer->cm.bbox.Diag() : 0;
    return length > 0 && std::isfinite(length) ? length : 1;
}

} // namespace

void addTargetRadius(RichParameterList &list, double targetRadius, const MeshDocument &document, Shown shown) {
    addParameter<host::RichPercentageParam>(
        list, shown, "target_radius", Scalarm(targetRadius), Scalarm(0), diagonal(document), "Patch radius",
        "How far a patch reaches from its centre along the surface, in units of the layer. Larger patches are split. "
        "<b>0</b> (the default): chosen from the number of patches and the area. <b>Raise it</b> for fewer patches: "
        "faster and stiffer. <b>Lower it</b> for more: they follow tighter bends.");
}

void addInitialPatches(RichParameterList &list, int initialPatches, Shown shown) {
    addParameter<RichInt>(
        list, shown, "initial_patches", initialPatches, "Initial patches",
        QString("Number of patches to start from, where the surface is free. Splitting adds to it. ") +
            (initialPatches == 0
                 ? "<b>0</b> (the default): as many as the surface is worth, whatever its number of vertices: some 300 "
                   "for most scans, 100 where little bends, up to 1500 where it is thin, folded or torn. "
                 : "A few hundred are enough for most scans, whatever their number of vertices. ") +
            "<b>Raise it</b> for finer bends; it takes longer.");
}

void addRandomSeed(RichParameterList &list, unsigned randomSeed) {
    addParameter<RichInt>(list, Shown::Advanced, "random_seed", int(randomSeed), "Random seed",
                          "Chooses where the first patches lie. The same seed gives exactly the same result; another "
                          "one gives another, equally good.");
}

vcg::fcd::GraphParam graphParam(const RichParameterList &list) {
    vcg::fcd::GraphParam param;
    param.targetRadius = asTyped(list.getAbsPerc("target_radius"));
    param.initialPatches = list.getInt("initial_patches");
    param.randomSeed = unsigned(list.getInt("random_seed"));
    return param;
}

void addSmoothness(RichParameterList &list, Shown shown, double smoothness) {
    addParameter<RichFloat>(
        list, shown, "smoothness", Scalarm(smoothness), "Smoothness (0.001 loose, 0.1 stiff)",
        "How strongly neighbouring parts turn alike: 0.001 is loose, 0.1 is stiff. <b>Raise it</b> to spread bends and "
        "stiffen the surface. <b>Lower it</b> to keep lengths better; bends may then be sharp near handles.");
}

void addFalloff(RichParameterList &list, vcg::fcd::Falloff falloff) {
    if (!host::scriptsMayLackParameters)
        return;
    const ParameterText text = falloffText();
    addParameter<RichEnum>(list, Shown::Advanced, "falloff", int(falloff), text.values, text.label, text.help);
}

void addElastic(RichParameterList &list, bool elastic) {
    if (!host::scriptsMayLackParameters)
        return;
    const ParameterText text = elasticText();
    addParameter<RichBool>(list, Shown::Advanced, "elastic", elastic, text.label, text.help);
}

bool elastic(const RichParameterList &list) { return list.hasParameter("elastic") && list.getBool("elastic"); }

vcg::fcd::Falloff falloff(const RichParameterList &list) {
    return vcg::fcd::Falloff(list.hasParameter("falloff") ? enumValue(list, "falloff", 4) : 0);
}

void addBending(RichParameterList &list, const vcg::fcd::DeformationParam &deformation, bool all) {
    addSmoothness(list, Shown::Always, deformation.smoothness);
    addFalloff(list, deformation.falloff);
    addElastic(list, deformation.elastic);
    addParameter<RichInt>(list, Shown::Advanced, "max_iterations", deformation.maxIterations, "Maximum iterations",
                          "The shape is improved until it converges, at most this often. <b>Raise it</b> when the log "
                          "says that it did not converge. A converged result does not change.");
    addParameter<RichFloat>(list, Shown::Advanced, "tolerance", Scalarm(deformation.tolerance), "Tolerance",
                            "Converged means: no node is farther from its final place than ten times this fraction of "
                            "the bounding box diagonal, by estimate. <b>Raise it</b> to end sooner and less exactly.");
    addParameter<RichEnum>(
        list, Shown::Advanced, "graph_weights", int(deformation.graphWeights),
        QStringList() << "Common border"
                      << "Uniform"
                      << "As in the paper"
                      << "The paper to the letter",
        "Graph weights",
        "For comparisons; leave it. How strongly neighbouring patches hold together. <i>Common border</i>: by the "
        "length of the border and the distance of the centres. The shape then hardly depends on where the patches lie. "
        "<i>Uniform</i>: all alike. <i>As in the paper</i>: all alike, and patches are balanced by number of vertices, "
        "not by area. <i>The paper to the letter</i>: all else is as printed, too: vertices follow the nodes whose "
        "patch would reach them (Eqs. 7 and 8), held parts do not give way and do not blend, and plain steps end when "
        "none moves a node by more than the tolerance. 'Distances' and 'Influence' are not read then.");
    const ParameterText weights = weightsText();
    addParameter<RichEnum>(list, Shown::Advanced, "weights", int(deformation.weights), weights.values, weights.label,
                           weights.help);
    addParameter<RichFloat>(list, Shown::Advanced, "influence", Scalarm(deformation.influence), "Influence",
                            "How far a node reaches, in radii of its patch. <b>Raise it</b> to blend over more nodes: "
                            "smoother and a little slower. Below 2 the patches begin to show.");
    addParameter<RichEnum>(list, Shown::Advanced, "loose_parts", int(deformation.looseParts),
                           QStringList() << "Follow"
                                         << "Stay",
                           "Loose parts",
                           "What becomes of parts that are connected to no handle and nothing fixed. They "
                           "<i>follow</i> the nearest part that is (a button follows the sleeve), or <i>stay</i>.");
    if (all)
        addParameter<RichFloat>(
            list, Shown::Advanced, "weld_distance", Scalarm(deformation.weldDistance), "Weld distance",
            "Vertices on open borders that are at most this far apart count as one, so a seam does not tear. A "
            "fraction of the bounding box diagonal of what bends. <b>Raise it</b> when the log says that close borders "
            "are not joined. <b>0</b>: only vertices at the same place count as one.");
    addParameter<RichFloat>(
        list, Shown::Always, "pose", Scalarm(deformation.pose), "Pose (percent)",
        "How much of the motion is carried out: 0 is the mesh as it is, 100 the full motion. It may exceed 100.");
    if (all)
        addParameter<RichInt>(
            list, Shown::Advanced, "pose_steps", deformation.steps, "Pose in steps",
            "The least number of steps to the pose, each bent from the one before. A handle that turns takes at least "
            "one for each 60 degrees. <b>Raise it</b> (to 10, say) when the log says that the shape jumps on its way.");
}

vcg::fcd::DeformationParam deformationParam(const RichParameterList &list, bool all) {
    vcg::fcd::DeformationParam deformation;
    deformation.graph = graphParam(list);
    deformation.smoothness = asTyped(list.getFloat("smoothness"));
    deformation.falloff = falloff(list);
    deformation.elastic = elastic(list);
    deformation.maxIterations = list.getInt("max_iterations");
    deformation.tolerance = asTyped(list.getFloat("tolerance"));
    using vcg::fcd::GraphWeights;
    using vcg::fcd::PatchMeasure;
    const GraphWeights graphWeights[] = {GraphWeights::Border, GraphWeights::Uniform, GraphWeights::Uniform,
                                         GraphWeights::Printed};
    const int chosen = enumValue(list, "graph_weights", 4);
    deformation.graphWeights = graphWeights[chosen];
    deformation.graph.measure = chosen >= 2 ? PatchMeasure::Vertices : PatchMeasure::Area;
    deformation.weights = vcg::fcd::MappingWeights(enumValue(list, "weights", 2));
    deformation.influence = asTyped(list.getFloat("influence"));
    deformation.looseParts = vcg::fcd::LooseParts(enumValue(list, "loose_parts", 2));
    deformation.pose = asTyped(list.getFloat("pose"));
    if (all) {
        deformation.weldDistance = asTyped(list.getFloat("weld_distance"));
        deformation.steps = list.getInt("pose_steps");
    }
    deformation.Validate();
    return deformation;
}

void addDisplacement(RichParameterList &list, bool displacement) {
    if (host::scriptsMayLackParameters)
        addParameter<RichBool>(list, Shown::Advanced, "displacement", displacement, "Add displacement",
                               "Also gives the vertices of the result the vector attribute 'fcd_displacement': the way "
                               "that each went, in the layer's coordinates. Scripts read it as "
                               "vertex_custom_point_attribute_matrix.");
}

bool displacement(const RichParameterList &list) {
    return list.hasParameter("displacement") && list.getBool("displacement");
}

void addGraphLayers(RichParameterList &list, bool graphLayers) {
    addParameter<RichBool>(
        list, Shown::Advanced, "graph_layers", graphLayers, "Add graph layers",
        "Also adds the deformation graph, at rest and deformed, as two layers. 'FCD: Apply Deformation to Layer' and "
        "'FCD: Save Deformation' need them. Their attribute <i>energy</i> says where the deformation costs most.");
}

RichParameterList inOrder(const RichParameterList &list, QStringList first, bool others) {
    if (host::firstMayBeLacking())
        first.prepend(handleLayer);
    first.removeDuplicates();
    RichParameterList ordered;
    for (const QString &name : first)
        ordered.addParam(list.getParameterByName(name));
    for (const RichParameter &parameter : list)
        if (others && !ordered.hasParameter(parameter.name()))
            ordered.addParam(parameter);
    return ordered;
}

int enumValue(const RichParameterList &list, const char *name, int count) {
    const int value = list.getEnum(name);
    if (value < 0 || value >= count)
        throw Error(std::string(name) + " is " + std::to_string(value) + "; it must be from 0 to " +
                    std::to_string(count - 1) + ".");
    return value;
}
