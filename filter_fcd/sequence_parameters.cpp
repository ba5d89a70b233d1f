// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::Shown;

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
                  "What becomes a new layer, with all that the layer carries. A layer of a million vertices takes some "
                  "hundred MB.");
    fields.saveFile("gltf_file", param.gltfFile, Shown::Always, "*.glb", "Write animation to (.glb)",
                    "glTF 2.0 with morph targets (shape keys) and their animation, for Blender and web pages, with the "
                    "layer's colours and textures. World coordinates; single precision. An existing file is replaced. "
                    "<b>Empty</b> (the default): none is written.");
    fields.choice("gltf_shapes", param.shapes, Shown::Always, {"Each frame", "Each pose"}, "Morph targets",
                  "<i>Each frame</i>: one for each frame; the animation is exact, and the file large. <i>Each "
                  "pose</i>: one for each pose, by its name, to mix by hand. Mixed poses move in straight lines, so "
                  "what turns shrinks; the log says by how much.");
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
    askSmoothness(fields, param.deformation.smoothness, Shown::Always);
    askFalloff(fields, param.deformation.falloff);
    askElastic(fields, param.deformation.elastic);
    askRigidity(fields, param.deformation.rigidity);
    askRandomSeed(fields, param.deformation.graph);
    askTags(fields, param.handles);
    if (!fields.areRead())
        return;
    param.handles.validate();
    param.deformation.Validate();
    param.deformation = asHandedOver(param.deformation); // so that deformers are shared with the other filters
    param.validate();
}
