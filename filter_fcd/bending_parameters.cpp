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

void addTargetRadius(RichParameterList &list, double targetRadius, const MeshDocument &document) {
    addParameter<host::RichPercentageParam>(
        list, Shown::Always, "target_radius", Scalarm(targetRadius), Scalarm(0), diagonal(document), "Patch radius",
        "How far a patch reaches from its centre, in units of the layer, measured along the surface. Patches that grow "
        "beyond it are split. <b>0</b> (the default) chooses it from the number of patches and the area to cover. "
        "<b>Raising it</b> gives "
        "fewer "
        "and larger patches: faster, and the deformation bends more stiffly. <b>Lowering it</b> gives more patches, "
        "which "
        "can follow tighter bends.");
}

void addInitialPatches(RichParameterList &list, int initialPatches) {
    addParameter<RichInt>(
        list, Shown::Always, "initial_patches", initialPatches, "Initial patches",
        QString("Number of patches to start from, all of them where the surface is free; splitting adds to it. ") +
            (initialPatches == 0
                 ? "<b>0</b> (the default): as many as the surface is worth, whatever its number of vertices: some 300 "
                   "for most scans, 100 where little bends, and up to 1500 where it is thin, folded or torn. "
                 : "A few hundred are enough for most scans, whatever their number of vertices. ") +
            "<b>Raising it</b> lets the deformation bend in finer detail, and takes longer.");
}

void addRandomSeed(RichParameterList &list, unsigned randomSeed) {
    addParameter<RichInt>(
        list, Shown::Advanced, "random_seed", int(randomSeed), "Random seed",
        "Chooses where the first patches are placed. The same seed on the same mesh gives exactly the same result; "
        "another seed gives another, equally good, set of patches.");
}

vcg::fcd::GraphParam graphParam(const RichParameterList &list) {
    vcg::fcd::GraphParam param;
    param.targetRadius = asTyped(list.getAbsPerc("target_radius"));
    param.initialPatches = list.getInt("initial_patches");
    param.randomSeed = unsigned(list.getInt("random_seed"));
    return param;
}

void addSmoothness(RichParameterList &list, Shown shown, double smoothness) {
    addParameter<RichFloat>(list, shown, "smoothness", Scalarm(smoothness), "Smoothness (0.001 loose, 0.1 stiff)",
                            "How strongly neighbouring parts must turn alike: 0.001 is loose, 0.1 is stiff. <b>Raising "
                            "it</b> spreads bends over more of the surface and stiffens it; <b>lowering it</b> keeps "
                            "lengths better but lets bends become sharp near the handles.");
}

void addBending(RichParameterList &list, const vcg::fcd::DeformationParam &deformation, bool all) {
    addSmoothness(list, Shown::Always, deformation.smoothness);
    addParameter<RichInt>(
        list, Shown::Advanced, "max_iterations", deformation.maxIterations, "Maximum iterations",
        "The shape is improved until it comes to rest, at most this often. <b>Raise it</b> when the log "
        "says that it did not converge; a converged result does not change.");
    addParameter<RichFloat>(list, Shown::Advanced, "tolerance", Scalarm(deformation.tolerance), "Tolerance",
                            "At rest means that no node is farther from where it comes to rest than ten times this "
                            "fraction of the bounding box diagonal (estimated from how fast the steps get shorter; "
                            "where these tell too little, as of springs, by a step of Newton's method). "
                            "<b>Raising it</b> ends sooner and less exactly.");
    addParameter<RichEnum>(
        list, Shown::Advanced, "graph_weights", int(deformation.graphWeights),
        QStringList() << "Common border"
                      << "Uniform"
                      << "As in the paper"
                      << "The paper to the letter",
        "Graph weights",
        "How strongly neighbouring patches hold together. <i>Common border</i>: the more, the longer "
        "their border and the closer their centres, so that the shape hardly depends on where the "
        "patches lie. <i>Uniform</i>: all alike. <i>As in the paper</i>: all alike, and the patches are balanced by "
        "their number of vertices instead of their area, so that denser parts get more of them. <i>The paper to the "
        "letter</i>: all else, too, is as it is printed, to compare with it: vertices follow the nodes whose patch "
        "would reach them (Eqs. 7 and 8), whatever is held gives no way and nothing runs over into it, and the shape "
        "is improved by plain steps until one moves no node by more than the tolerance. 'Distances' and 'Influence' "
        "are not read.");
    const ParameterText weights = weightsText();
    addParameter<RichEnum>(list, Shown::Advanced, "weights", int(deformation.weights), weights.values, weights.label,
                           weights.help);
    addParameter<RichFloat>(list, Shown::Advanced, "influence", Scalarm(deformation.influence), "Influence",
                            "A node moves vertices up to this many times the radius of its patch. <b>Raising it</b> "
                            "blends over more nodes: "
                            "smoother and a little slower. Below about 2 the patches begin to show.");
    addParameter<RichEnum>(list, Shown::Advanced, "loose_parts", int(deformation.looseParts),
                           QStringList() << "Follow"
                                         << "Stay",
                           "Loose parts",
                           "What becomes of parts that are not connected to any handle or fixed vertex: <i>Follow</i> "
                           "the nearest part that is "
                           "(a button follows the sleeve), or <i>Stay</i> where they are.");
    if (all)
        addParameter<RichFloat>(
            list, Shown::Advanced, "weld_distance", Scalarm(deformation.weldDistance), "Weld distance",
            "Vertices on open borders that are at most this far apart count as one, so that a seam does not tear; a "
            "fraction of the bounding box diagonal of what bends. <b>Raise it</b> when the log says that borders lie "
            "close to each other and are not joined; with <b>0</b>, only vertices at the same place count as one.");
    addParameter<RichFloat>(
        list, Shown::Always, "pose", Scalarm(deformation.pose), "Pose (percent)",
        "How much of the motion of the handles is carried out: 0 is the mesh as it is, 100 the full motion; "
        "it may exceed 100.");
    if (all)
        addParameter<RichInt>(
            list, Shown::Advanced, "pose_steps", deformation.steps, "Pose in steps",
            "The pose is reached over at least so many steps, each bent from the one before; over more where a handle "
            "turns by more than 60 degrees a step against what else is held, so that a turn of 190 degrees or of twice "
            "round is what it says. <b>Raise it</b> (to 10, say) where the log says that the shape jumps on its way.");
}

vcg::fcd::DeformationParam deformationParam(const RichParameterList &list, bool all) {
    vcg::fcd::DeformationParam deformation;
    deformation.graph = graphParam(list);
    deformation.smoothness = asTyped(list.getFloat("smoothness"));
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

void addGraphLayers(RichParameterList &list, bool graphLayers) {
    addParameter<RichBool>(list, Shown::Always, "graph_layers", graphLayers, "Layers with the graph",
                           "Also adds the deformation graph at rest and deformed, as two layers, which keep the "
                           "deformation for 'FCD: Apply Deformation to Layer' and 'FCD: Save Deformation'; their "
                           "attribute <i>energy</i> says where the deformation costs most.");
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
