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
        list, Shown::Always, "poses_file", param.posesFile, QStringList("*.csv"), "File with the poses (.csv)",
        "A table with commas, semicolons or tabs between its cells. The first row is <i>time, easing</i> and the names "
        "of the poses, a column for each; a row that begins with <i>motions</i> has their motions, as 'Motions as "
        "text' of 'FCD: Deform Mesh' has them (quoted where they hold commas or semicolons); each further row is a key "
        "frame: the time in seconds, the easing up to the next one (<i>linear</i>, <i>smooth</i> or <i>hold</i>), and "
        "of each pose how many percent of it there are. Without key frames, the poses follow each other, a second "
        "each. <b>Empty</b> (the default): the poses that the layer keeps, those of the last time in this session; no "
        "file of MeshLab has room for them.");
    addParameter<RichFloat>(list, Shown::Always, "frames_per_second", Scalarm(param.rate), "Frames per second",
                            "How many frames files have, and layers where each frame is one.");
    addParameter<RichEnum>(
        list, Shown::Always, "frame_layers", int(param.layers),
        QStringList() << "None"
                      << "Each key frame"
                      << "Each frame",
        "New layers",
        "What becomes a new layer, with all that the layer carries: each of a million vertices takes "
        "some hundred MB.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "gltf_file", param.gltfFile, "*.glb", "Animation goes to (.glb)",
        "A file to write: glTF 2.0, with morph targets (shape keys) and their animation, for Blender, web pages and "
        "the like. World coordinates; positions and normals in single precision, neither colours nor textures. An "
        "existing file is replaced. <b>Empty</b> (the default): none is written.");
    addParameter<RichEnum>(
        list, Shown::Always, "gltf_shapes", int(param.shapes),
        QStringList() << "Each frame"
                      << "Each pose",
        "Shapes in it",
        "What is a morph target. <i>Each frame</i>: the animation is what it is here, in a large file. <i>Each "
        "pose</i>: one for each pose, by its name, to be mixed by hand, too; mixed they move in straight lines, so "
        "that "
        "turns shrink what turns. The log says by how much.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "pc2_file", param.cacheFile, "*.pc2", "Point cache goes to (.pc2)",
        "A file to write: the positions of all vertices in each frame, in the layer's own coordinates and in single "
        "precision, for the mesh as the layer is saved (Blender's modifier 'Mesh Cache'). An existing file is "
        "replaced. <b>Empty</b> (the default): none is written.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "save_poses_file", param.saveFile, "*.csv", "Poses go to (.csv)",
        "A file to write: the table again, with all of its key frames, and with a row that tells of which surface the "
        "poses are: with another one, they are an error then. An existing file is replaced. <b>Empty</b> (the "
        "default): none is written.");
    addInitialPatches(list, param.deformation.graph.initialPatches);
    addSmoothness(list, Shown::Always, param.deformation.smoothness);
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
    param.cacheFile = list.getSaveFileName("pc2_file");
    param.saveFile = list.getSaveFileName("save_poses_file");
    param.deformation.graph.initialPatches = list.getInt("initial_patches");
    param.deformation.graph.randomSeed = unsigned(list.getInt("random_seed"));
    param.deformation.smoothness = asTyped(list.getFloat("smoothness"));
    param.deformation.Validate();
    param.deformation = asHandedOver(param.deformation); // so that what is prepared is that of the other filters
    param.validate();
    return param;
}
