// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/kept_deformation.h> // these before Qt
#include <layer_fcd/kept_graph.h>

#include "common_parameters.h"

using host::Shown;

namespace {

/// The layers of a deformation; the default is the last one.
void askLayers(Fields &fields, DeformationLayers &layers) {
    const DeformationLayers last = lastDeformation(fields.document);
    fields.layer(
        "source_layer", layers.source, last.source ? last.source : fields.document.mm(), Shown::Always, "Source layer",
        "The layer that was deformed, in the shape that it had then. By default that of the last deformation.");
    fields.layer("rest_graph", layers.restGraph, last.restGraph ? last.restGraph : likelyGraph(fields.document, false),
                 Shown::Always, "Graph at rest", "The layer with the deformation graph of the source.");
    fields.layer("deformed_graph", layers.deformedGraph,
                 last.deformedGraph ? last.deformedGraph : likelyGraph(fields.document, true), Shown::Always,
                 "Deformed graph", "The layer with the same graph, deformed.");
}

} // namespace

void ask(Fields &fields, BuildGraphParam &param) {
    askTargetRadius(fields, param.graph, Shown::Always);
    askInitialPatches(fields, param.graph, Shown::Always);
    fields.field("max_iterations", param.graph.maxIterations, Shown::Advanced, "Maximum iterations",
                 "Patches are improved until they hardly change, at most this often. <b>Raise it</b> when the log says "
                 "that they did not converge.");
    askRandomSeed(fields, param.graph);
    fields.field("patches_layer", param.patchesLayer, Shown::Always, "Add patch layer",
                 "Also adds a copy of the mesh, coloured by patch. Its quality is the number of the patch.");
    if (host::scriptsMayLackParameters)
        fields.field("surface_layer", param.surfaceLayer, Shown::Always, "Add graph as a surface",
                     "Also adds the graph as balls and tubes, for any viewer and every format.");
    else
        param.surfaceLayer = host::inWindow();
    if (fields.areRead())
        param.graph.Validate();
}

void ask(Fields &fields, DeformMeshParam &param) {
    vcg::fcd::DeformationParam &deformation = param.deformation;
    askHandles(fields, param.handles);

    // With which graph.
    fields.field("use_graph_layer", param.useGraphLayer, Shown::Advanced, "Use a graph layer",
                 "Takes the vertices of the layer below as nodes instead of building a graph. One graph can drive "
                 "several meshes, and you can place nodes by hand.");
    fields.layer("graph_layer", param.graphLayer, likelyGraph(fields.document, false), Shown::Advanced, "Graph layer",
                 "The layer whose vertices are the nodes. Only read when 'Use a graph layer' is ticked. Nodes that are "
                 "not on the surface are left out; if most are not, this is an error.");
    if (!param.useGraphLayer)
        param.graphLayer = nullptr;
    askTargetRadius(fields, deformation.graph);
    askInitialPatches(fields, deformation.graph);
    askRandomSeed(fields, deformation.graph);
    askBending(fields, deformation, host::scriptsMayLackParameters);
    askGraphLayers(fields, param.graphLayers);
    fields.choice(
        "deformed_quality", param.quality, Shown::Advanced, {"As the input", "Stretch", "Rotation angle", "Contact"},
        "Result quality",
        "The vertex quality of the result, to colour, select or save: that of the input, the <b>stretch</b> (length of "
        "edges over that at rest: 1.1 is 10 percent longer), the <b>angle</b> by which the surface turned, in degrees, "
        "or the <b>contact</b>: how far the surface passes through itself where it did not at rest. Up to 250 thousand "
        "faces the log tells of contact in any case; larger layers take a second for a million faces.");
    askDisplacement(fields, param.displacement);
    if (host::scriptsMayLackParameters)
        fields.field("stop_at_contact", param.stopAtContact, Shown::Advanced, "Stop at contact",
                     "Carries the motion out only until the surface would pass through itself, to a hundredth of the "
                     "motion. Solves eight poses; the log tells how far it came.");
    deformation.contact = param.quality == DeformMeshParam::Contact;
    deformation.measure = param.quality == DeformMeshParam::Stretch || param.quality == DeformMeshParam::Rotation;
    if (!host::dialogsFold) // the most important ones come first
        fields.order({"handles", "translation", "rotation_axis", "rotation_angle", "rotation_center", "rotation_point",
                      handleLayer, "smoothness", "pose", "graph_layers", "transforms"},
                     true);
}

void ask(Fields &fields, PoseParam &param) {
    fields.letLack(); // parameters that dialogs which do not fold leave out
    askHandles(fields, param.handles);
    askTargetRadius(fields, param.deformation.graph);
    askInitialPatches(fields, param.deformation.graph);
    askRandomSeed(fields, param.deformation.graph);
    askBending(fields, param.deformation, true);
    fields.field("exact_normals", param.exactNormals, Shown::Advanced, "Exact normals",
                 "Computes normals of what moves from the faces, as MeshLab does. Without it they turn with the "
                 "surface: a tenth faster, and some degrees off where it bends. A layer's own normals, and those of "
                 "clouds, turn in any case.");
    if (host::scriptsMayLackParameters)
        fields.field("contact", param.contact, Shown::Advanced, "Look for contact",
                     "Counts the triangles that pass through the layer and did not at rest, and tells how far. Takes "
                     "several times as long as the pose, in each step of a preview, too.");
    if (!host::dialogsFold)
        fields.order({"handles", "translation", "rotation_axis", "rotation_angle", "rotation_center", "rotation_point",
                      handleLayer, "smoothness", "pose", "transforms", "tag_attribute", "initial_patches"},
                     false);
}

void ask(Fields &fields, CopyParam &param) {
    // The first parameter, since meshlabserver 2020.09 fills in a missing first parameter only.
    fields.openFile("deformation_file", param.file, Shown::Always, {"*.ply"}, "Saved deformation (.ply)",
                    "A file of 'FCD: Save Deformation', in world coordinates. The three layers below are not read "
                    "then. <b>Empty</b> (the default): these layers have the deformation.");
    askLayers(fields, param);
    fields.field("all_visible", param.allVisible, Shown::Always, "All visible layers",
                 "Deforms every visible layer but those above, instead of the current one.");
    askDisplacement(fields, param.displacement);
}

void ask(Fields &fields, ResetPoseParam &param) {
    fields.choice(
        "to", param.to, Shown::Always,
        {"The shape before the last pose", "The shape as loaded",
         "The shape before the last pose, whatever has moved it"},
        "Back to",
        "<b>The shape before the last pose</b> (0): one step; if the layer has that shape already, one more. 'Apply' "
        "in the tool 'FCD: Bend' and 'Keep the present shape' end a step.<br><b>The shape as loaded</b> (1): that "
        "before the first pose.<br><b>The shape before the last pose, whatever has moved it</b> (2): also undoes what "
        "another filter has moved since (smoothed, say). New vertices or other faces are an error.");
    fields.field("keep_shape", param.keepShape, Shown::Always, "Keep the present shape",
                 "Ticked, the layer stays as it is, and later poses begin from this shape.");
}

void ask(Fields &fields, SaveDeformationParam &param) {
    askLayers(fields, param);
    fields.saveFile("deformation_file", param.file, Shown::Always, "*.ply", "Write deformation to (.ply)",
                    "The file to write. An existing file is replaced.");
    if (host::scriptsMayLackParameters) {
        fields.field(
            "accuracy", param.accuracy, Shown::Always, "Accuracy",
            "How far a vertex of the source may be off, in world units. A tenth of it takes about five times as many "
            "samples, of some 115 bytes each, up to a million. The log tells size and time. <b>0</b> (the default): a "
            "fiftieth of the largest motion, at most 0.01 percent of the diagonal of what moves.");
        fields.field("inverse", param.inverse, Shown::Always, "Inverse",
                     "Writes the way back, from the deformed shape to the original. It carries landmarks and "
                     "measurements onto the original. Folds have no way back; the log counts their vertices.");
    }
    if (fields.areRead())
        param.validate();
}
