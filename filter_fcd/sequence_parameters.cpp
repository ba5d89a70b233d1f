// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::addParameter;
using host::Shown;

namespace {

/// Where the tags are, as in "FCD: Deform Mesh".
QStringList tagParameters() { return {"handles", "tag_attribute", "tag_file"}; }

} // namespace

RichParameterList toRichParameters(const SequenceParam &param, const MeshDocument &document) {
    RichParameterList list;
    addParameter<host::RichFileParam>(
        list, Shown::Always, "poses_file", param.posesFile, QStringList("*.csv"), "Pose table (.csv)",
        "A table with commas, semicolons or tabs. The first row is <i>time, easing</i> and the names of the poses. A "
        "row that begins with <i>motions</i> has their motions, as in 'Motions as text' (quoted where they hold the "
        "separator). Each further row is a key frame: time in seconds, easing up to the next one (<i>linear</i>, "
        "<i>smooth</i> or <i>hold</i>), and the percentage of each pose. Without key frames, poses follow each other, "
        "a second each. <b>Empty</b> (the default): the poses that the layer keeps in this session.");
    addParameter<RichFloat>(list, Shown::Always, "frames_per_second", Scalarm(param.rate), "Frames per second",
                            "The rate of frames in files, and in layers where each frame is one.");
    addParameter<RichEnum>(list, Shown::Always, "frame_layers", int(param.layers),
                           QStringList() << "None"
                                         << "Each key frame"
                                         << "Each frame",
                           "New layers",
                           "What becomes a new layer, with all that the layer carries. A layer of a million vertices "
                           "takes some hundred MB.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "gltf_file", param.gltfFile, "*.glb", "Write animation to (.glb)",
        "glTF 2.0 with morph targets (shape keys) and their animation, for Blender and web pages, with the layer's "
        "colours and textures. World coordinates; single precision. An existing file is replaced. <b>Empty</b> (the "
        "default): none is written.");
    addParameter<RichEnum>(list, Shown::Always, "gltf_shapes", int(param.shapes),
                           QStringList() << "Each frame"
                                         << "Each pose",
                           "Morph targets",
                           "<i>Each frame</i>: the animation is what it is here, in a large file. <i>Each pose</i>: "
                           "one for each pose, by its name, to mix by hand. Mixed poses move in straight lines, so "
                           "what turns shrinks. The log says by how much.");
    if (host::scriptsMayLackParameters)
        addParameter<RichBool>(list, Shown::Always, "all_visible", param.allVisible, "All visible layers",
                               "The .glb file also has the other visible layers, but for those of edges alone, as "
                               "graphs are. They go along with the "
                               "current one, as 'FCD: Apply Deformation to Layer' takes them: eyes in a head, say.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "pc2_file", param.cacheFile, "*.pc2", "Write point cache to (.pc2)",
        "Positions of all vertices in each frame, in the layer's own coordinates and in single precision, for the mesh "
        "as the layer is saved (Blender's modifier 'Mesh Cache'). An existing file is replaced. <b>Empty</b> (the "
        "default): none is written.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "save_poses_file", param.saveFile, "*.csv", "Write poses to (.csv)",
        "The table again, with all key frames, and with a row that tells the surface: with another surface the table "
        "is an error. An existing file is replaced. <b>Empty</b> (the default): none is written.");
    addInitialPatches(list, param.deformation.graph.initialPatches);
    addSmoothness(list, Shown::Always, param.deformation.smoothness);
    addFalloff(list, param.deformation.falloff);
    addElastic(list, param.deformation.elastic);
    addRandomSeed(list, param.deformation.graph.randomSeed);
    RichParameterList handles;
    addHandles(handles, param.handles, document);
    for (const QString &name : tagParameters())
        list.addParam(handles.getParameterByName(name));
    return list;
}

SequenceParam sequenceParam(const RichParameterList &list, const MeshDocument &document) {
    SequenceParam param;
    RichParameterList handles;
    addHandles(handles, param.handles, document);
    for (const QString &name : tagParameters())
        handles.setValue(name, list.getParameterByName(name).value());
    param.handles = handleParam(handles, document);
    param.posesFile = list.getOpenFileName("poses_file");
    param.rate = asTyped(list.getFloat("frames_per_second"));
    param.layers = SequenceParam::Layers(enumValue(list, "frame_layers", 3));
    param.gltfFile = list.getSaveFileName("gltf_file");
    param.shapes = vcg::fcd::SequenceOutput::Shapes(enumValue(list, "gltf_shapes", 2));
    param.allVisible = list.hasParameter("all_visible") && list.getBool("all_visible");
    param.cacheFile = list.getSaveFileName("pc2_file");
    param.saveFile = list.getSaveFileName("save_poses_file");
    param.deformation.graph.initialPatches = list.getInt("initial_patches");
    param.deformation.graph.randomSeed = unsigned(list.getInt("random_seed"));
    param.deformation.smoothness = asTyped(list.getFloat("smoothness"));
    param.deformation.falloff = falloff(list);
    param.deformation.elastic = elastic(list);
    param.deformation.Validate();
    param.deformation = asHandedOver(param.deformation); // so that what is prepared is that of the other filters
    param.validate();
    return param;
}
