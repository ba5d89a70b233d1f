// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_parameters.h"

using host::Shown;

void askTargetRadius(Fields &fields, vcg::fcd::GraphParam &graph, Shown shown) {
    fields.length("target_radius", graph.targetRadius, shown, "Patch radius",
                  "How far a patch reaches from its centre along the surface, in units of the layer. Larger patches "
                  "are split. <b>0</b> (the default): chosen from the number of patches and the area. <b>Raise it</b> "
                  "for fewer patches: faster and stiffer. <b>Lower it</b> for more: they follow tighter bends.");
}

void askInitialPatches(Fields &fields, vcg::fcd::GraphParam &graph, Shown shown) {
    fields.field(
        "initial_patches", graph.initialPatches, shown, "Initial patches",
        QString("Number of patches to start from, where the surface is free. Splitting adds to it. ") +
            (graph.initialPatches == 0
                 ? "<b>0</b> (the default): as many as the surface needs, whatever its number of vertices: some 300 "
                   "for most scans, 100 where little bends, up to 1500 where it is thin, folded or torn. "
                 : "A few hundred are enough for most scans, whatever their number of vertices. ") +
            "<b>Raise it</b> for finer bends; it takes longer.");
}

void askRandomSeed(Fields &fields, vcg::fcd::GraphParam &graph) {
    int seed = int(graph.randomSeed);
    fields.field("random_seed", seed, Shown::Advanced, "Random seed",
                 "Chooses where the first patches lie. The same seed gives exactly the same result; another one gives "
                 "another, equally good.");
    graph.randomSeed = unsigned(seed);
}

void askSmoothness(Fields &fields, double &smoothness, Shown shown) {
    fields.field(
        "smoothness", smoothness, shown, "Smoothness (0.001 loose, 0.1 stiff)",
        "How strongly neighbouring parts turn alike: 0.001 is loose, 0.1 is stiff. <b>Raise it</b> to spread bends and "
        "stiffen the surface. <b>Lower it</b> to keep lengths better; bends may then be sharp near handles.");
}

void askElasticity(Fields &fields, vcg::fcd::DeformationParam &deformation) {
    askSmoothness(fields, deformation.smoothness, Shown::Always);
    if (!host::scriptsMayLackParameters)
        return;
    fields.choice("falloff", deformation.falloff, Shown::Advanced, falloffText());
    fields.field("elastic", deformation.elastic, Shown::Advanced, elasticText());
    fields.field("rigidity", deformation.rigidity, Shown::Advanced, rigidityText());
}

void askBending(Fields &fields, vcg::fcd::DeformationParam &deformation, bool all) {
    using vcg::fcd::GraphWeights;
    using vcg::fcd::PatchMeasure;
    askElasticity(fields, deformation);
    fields.field("max_iterations", deformation.maxIterations, Shown::Advanced, "Maximum iterations",
                 "The shape is improved until it converges, at most this often. <b>Raise it</b> when the log says that "
                 "it did not converge. A converged result does not change.");
    fields.field("tolerance", deformation.tolerance, Shown::Advanced, "Tolerance",
                 "Converged means: no node is farther from its final place than ten times this fraction of the "
                 "bounding box diagonal, by estimate. <b>Raise it</b> to end sooner and less exactly.");
    int chosen = 0;
    fields.choice(
        "graph_weights", chosen, Shown::Advanced,
        {"Common border", "Uniform", "As in the paper", "The paper to the letter"}, "Graph weights",
        "For comparisons; leave it. How strongly neighbouring patches hold together. <i>Common border</i>: by the "
        "length of the border and the distance of the centres. The shape then hardly depends on where the patches lie. "
        "<i>Uniform</i>: all alike. <i>As in the paper</i>: all alike, and patches are balanced by number of vertices, "
        "not by area. <i>The paper to the letter</i>: all else is as printed, too. Vertices follow the nodes whose "
        "patch would reach them (Eqs. 7 and 8). Held parts do not give way or blend. Plain steps end when none moves a "
        "node by more than the tolerance. 'Distances' and 'Influence' are not read then.");
    deformation.graphWeights = chosen == 0   ? GraphWeights::Border
                               : chosen == 3 ? GraphWeights::Printed
                                             : GraphWeights::Uniform;
    deformation.graph.measure = chosen >= 2 ? PatchMeasure::Vertices : PatchMeasure::Area;
    fields.choice("weights", deformation.weights, Shown::Advanced, weightsText());
    fields.field("influence", deformation.influence, Shown::Advanced, "Influence",
                 "How far a node reaches, in radii of its patch. <b>Raise it</b> to blend over more nodes: smoother "
                 "and a little slower. Below 2 the patches begin to show.");
    fields.choice("loose_parts", deformation.looseParts, Shown::Advanced, {"Follow", "Stay"}, "Loose parts",
                  "What becomes of parts that are connected to no handle and nothing fixed. They <i>follow</i> the "
                  "nearest part that is (a button follows the sleeve), or <i>stay</i>.");
    if (all)
        fields.field("weld_distance", deformation.weldDistance, Shown::Advanced, "Weld distance",
                     "Vertices on open borders that are at most this far apart count as one, so a seam does not tear. "
                     "A fraction of the bounding box diagonal of what bends. <b>Raise it</b> when the log says that "
                     "close borders are not joined. <b>0</b>: only vertices at the same place count as one.");
    fields.field(
        "pose", deformation.pose, Shown::Always, "Pose (percent)",
        "How much of the motion is carried out: 0 is the mesh as it is, 100 the full motion. It may exceed 100.");
    if (all)
        fields.field(
            "pose_steps", deformation.steps, Shown::Advanced, "Pose in steps",
            "The least number of steps to the pose, each bent from the one before. A handle that turns takes at least "
            "one for each 60 degrees. <b>Raise it</b> (to 10, say) when the log says that the shape jumps on its way.");
    if (fields.areRead())
        deformation.Validate();
}

void askGraphLayers(Fields &fields, bool &graphLayers) {
    fields.field(
        "graph_layers", graphLayers, Shown::Advanced, "Add graph layers",
        "Also adds the deformation graph, at rest and deformed, as two layers. 'FCD: Apply Deformation to Layer' and "
        "'FCD: Save Deformation' need them. Their attribute <i>energy</i> says where the deformation costs most.");
}
