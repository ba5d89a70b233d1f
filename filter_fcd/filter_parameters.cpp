// SPDX-License-Identifier: GPL-3.0-or-later
#include <layer_fcd/kept_graph.h> // these before Qt

#include "filter_parameters.h"

using host::Shown;

/// The layers of a deformation; the default is the last one.
static void askLayers(Fields &fields, DeformationLayers &layers) {
    const DeformationLayers last = lastDeformation(fields.document);
    fields.layer(
        "source_layer", layers.source, last.source ? last.source : fields.document.mm(), Shown::Always, "Source layer",
        "The layer that you deformed, in the shape that it had before. By default that of the last deformation.");
    fields.layer("rest_graph", layers.restGraph, last.restGraph ? last.restGraph : likelyGraph(fields.document, false),
                 Shown::Always, "Graph at rest", "The layer with the graph of the source at rest.");
    fields.layer("deformed_graph", layers.deformedGraph,
                 last.deformedGraph ? last.deformedGraph : likelyGraph(fields.document, true), Shown::Always,
                 "Deformed graph", "The layer with the deformed graph of the source.");
}

/// Whether to add the attribute "fcd_displacement".
static void askDisplacement(Fields &fields, bool &displacement) {
    if (host::scriptsMayLackParameters)
        fields.field(
            "displacement", displacement, Shown::Advanced, "Add displacement",
            "Also gives the vertices of the result the vector attribute 'fcd_displacement': how far each went along x, "
            "y and z, in the layer's coordinates. Scripts read it as vertex_custom_point_attribute_matrix.");
}

void ask(Fields &fields, BuildGraphParam &param) {
    askTargetRadius(fields, param.graph, Shown::Always);
    askInitialPatches(fields, param.graph, Shown::Always);
    fields.field("max_iterations", param.graph.maxIterations, Shown::Advanced, "Maximum iterations",
                 "The most steps to improve the patches; fewer if they hardly change any more. <b>Raise it</b> when "
                 "the log says that they did not converge.");
    askRandomSeed(fields, param.graph);
    fields.field("patches_layer", param.patchesLayer, Shown::Always, "Add patch layer",
                 "Also adds a copy of the mesh, coloured by patch. Its quality is the number of the patch.");
    if (host::scriptsMayLackParameters)
        fields.field("surface_layer", param.surfaceLayer, Shown::Always, "Add graph as a surface",
                     "Also adds the graph as balls and tubes, for any viewer and every format.");
    else
        param.surfaceLayer = host::inWindow();
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
                     "Stops the motion before the surface passes through itself, to a hundredth of the motion. Solves "
                     "eight poses; the log tells how far they came.");
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
                 "Computes normals from the faces where the surface moves, as MeshLab does. Without it they turn with "
                 "the surface: a tenth faster, and some degrees off where it bends. A layer's own normals, and those "
                 "of clouds, turn in any case.");
    if (host::scriptsMayLackParameters)
        fields.field("contact", param.contact, Shown::Advanced, "Look for contact",
                     "Counts the triangles that pass through the layer and did not at rest, and tells how far. Takes "
                     "several times as long as the pose, also in each step of a preview.");
    if (!host::dialogsFold)
        fields.order({"handles", "translation", "rotation_axis", "rotation_angle", "rotation_center", "rotation_point",
                      handleLayer, "smoothness", "pose", "transforms", "tag_attribute", "initial_patches"},
                     false);
}

void ask(Fields &fields, CopyParam &param) {
    // The first parameter, since meshlabserver 2020.09 fills in a missing first parameter only.
    fields.openFile("deformation_file", param.file, Shown::Always, {"*.ply"}, "Saved deformation (.ply)",
                    "A file of 'FCD: Save Deformation', in world coordinates. <b>Empty</b> (the default): the three "
                    "layers below have the deformation.");
    askLayers(fields, param);
    fields.field("all_visible", param.allVisible, Shown::Always, "All visible layers",
                 "Deforms every visible layer but those above, instead of the current one.");
    askDisplacement(fields, param.displacement);
}

void ask(Fields &fields, ResetPoseParam &param) {
    fields.choice("to", param.to, Shown::Always,
                  {"The shape before the last pose", "The shape as loaded",
                   "The shape before the last pose, whatever has moved it"},
                  "Back to",
                  "<b>The shape before the last pose</b> (0): one step back; if the layer has that shape already, one "
                  "more. 'Apply' in the tool 'FCD: Bend' and 'Keep the present shape' end a step.<br><b>The shape as "
                  "loaded</b> (1): the shape before the first pose.<br><b>The shape before the last pose, whatever has "
                  "moved it</b> (2): also undoes how another filter has moved vertices since (smoothed them, say). New "
                  "vertices or other faces are an error.");
    fields.field("keep_shape", param.keepShape, Shown::Always, "Keep the present shape",
                 "Changes nothing now; later poses begin from the present shape.");
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
            "fiftieth of the largest motion, at most 0.01 percent of the diagonal of the part that moves.");
        fields.field("inverse", param.inverse, Shown::Always, "Inverse",
                     "Writes the way back, from the deformed shape to the original. It carries landmarks and "
                     "measurements onto the original. Folds have no way back; the log counts their vertices.");
    }
    if (fields.areRead())
        param.validate();
}

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
    param.bend.Validate();
}

void ask(Fields &fields, SequenceParam &param) {
    fields.openFile(
        "poses_file", param.posesFile, Shown::Always, {"*.csv"}, "Pose table (.csv)",
        "A table with commas, semicolons or tabs. The first row is <i>time, easing</i> and the names of the poses. A "
        "row that begins with <i>motions</i> has their motions, as in 'Motions as text' (quoted where they hold the "
        "separator). Each further row is a key frame: time in seconds, easing up to the next one (<i>linear</i>, "
        "<i>smooth</i> or <i>hold</i>), and the percentage of each pose. Without key frames, poses follow each other, "
        "a second each. <b>Empty</b> (the default): the poses that the layer keeps in this session.");
    fields.field("frames_per_second", param.rate, Shown::Always, "Frames per second",
                 "The rate of frames in files, and in layers where each frame is one.");
    fields.choice("frame_layers", param.layers, Shown::Always, {"None", "Each key frame", "Each frame"}, "New layers",
                  "Which frames become new layers, with all that the layer carries. A layer of a million vertices "
                  "takes some hundred MB.");
    fields.saveFile("gltf_file", param.gltfFile, Shown::Always, "*.glb", "Write animation to (.glb)",
                    "glTF 2.0 with morph targets (shape keys) and their animation, for Blender and web pages, with the "
                    "layer's colours and textures. World coordinates; single precision. An existing file is replaced. "
                    "<b>Empty</b> (the default): none is written.");
    fields.choice("gltf_shapes", param.shapes, Shown::Always, {"Each frame", "Each pose"}, "Morph targets",
                  "<i>Each frame</i>: one for each frame; the animation is exact, and the file large. <i>Each "
                  "pose</i>: one for each pose, by its name, to mix by hand. Mixed poses move in straight lines, so "
                  "turning parts shrink; the log says by how much.");
    if (host::scriptsMayLackParameters)
        fields.field(
            "all_visible", param.allVisible, Shown::Always, "All visible layers",
            "The .glb file also has the other visible layers, except those of edges alone, such as graphs. They go "
            "along with the current one, as 'FCD: Apply Deformation to Layer' carries them: eyes in a head, say.");
    fields.saveFile("pc2_file", param.pc2File, Shown::Always, "*.pc2", "Write point cache to (.pc2)",
                    "Positions of all vertices in each frame, for the mesh as it is saved (Blender's modifier 'Mesh "
                    "Cache'). The layer's own coordinates; single precision. An existing file is "
                    "replaced. <b>Empty</b> (the default): none is written.");
    if (host::scriptsMayLackParameters)
        fields.saveFile("mdd_file", param.mddFile, Shown::Always, "*.mdd", "Write point cache to (.mdd)",
                        "The same in the format of LightWave, which other programs read as well. It has the time of "
                        "each frame. An existing file is replaced. <b>Empty</b> (the default): none is written.");
    fields.saveFile(
        "save_poses_file", param.saveFile, Shown::Always, "*.csv", "Write poses to (.csv)",
        "Writes poses and key frames as such a table, with a row that describes the surface: for another surface, the "
        "table is an error. An existing file is replaced. <b>Empty</b> (the default): none is written.");
    askInitialPatches(fields, param.deformation.graph);
    askElasticity(fields, param.deformation);
    askRandomSeed(fields, param.deformation.graph);
    askTags(fields, param.handles);
    if (!fields.areRead())
        return;
    param.handles.validate();
    param.deformation.Validate();
    param.deformation = asHandedOver(param.deformation); // so that deformers are shared with the other filters
    param.validate();
}

void ask(Fields &fields, SaveSessionParam &param) {
    fields.saveFile("session_file", param.file, Shown::Always, "*.fcd", "Write session to (.fcd)",
                    "The file to write. An existing file is replaced.");
    if (fields.areRead() && param.file.isEmpty())
        throw vcg::fcd::Error("session_file is empty. Give the .fcd file to write the session to.");
}

void ask(Fields &fields, LoadSessionParam &param) {
    fields.openFile("session_file", param.file, Shown::Always, {"*.fcd"}, "Session (.fcd)",
                    "A file of 'FCD: Save Session' for this layer.");
    if (fields.areRead() && param.file.isEmpty())
        throw vcg::fcd::Error("session_file is empty. Give the .fcd file with the session.");
}
