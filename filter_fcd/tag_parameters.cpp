// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::addParameter;
using host::Shown;

namespace {

/// The parameters that "FCD: Save Tags" has in common with "FCD: Deform Mesh": those that say how handles move, and
/// where their tags are.
QStringList motionParameters() {
    return {"transforms",      "translation",    "rotation_axis",   "rotation_angle",
            "rotation_center", "rotation_point", "TransformMatrix", handleLayer};
}
QStringList sourceParameters() { return {"handles", "tag_attribute"}; }

void addTarget(RichParameterList &list, const TagTarget &target) {
    addParameter<RichString>(
        list, Shown::Advanced, "tag_attribute", target.attribute, "Attribute for the tags",
        "Name of the per-vertex scalar attribute that holds the tags; it is added where the layer does not have it. "
        "<b>Empty</b> (the default): the tags are the vertex quality.");
    addParameter<RichBool>(list, Shown::Always, "colorize", target.colorize, "Colour by tag",
                           "Colours the vertices by their tags: fixed blue, free yellow, handles red (each number "
                           "another shade), outside grey. The layer keeps its own colours aside: deformed layers have "
                           "them, and 'FCD: Clear "
                           "Tags' brings them back.");
}

TagTarget target(const RichParameterList &list) {
    TagTarget target;
    target.attribute = list.getString("tag_attribute");
    target.colorize = list.getBool("colorize");
    return target;
}

} // namespace

RichParameterList toRichParameters(const TagSelectionParam &param) {
    RichParameterList list;
    addParameter<RichEnum>(list, Shown::Always, "role", int(param.role),
                           QStringList() << "Fixed"
                                         << "Free"
                                         << "Handle"
                                         << "Outside",
                           "The selection is",
                           "What the selected vertices, and the vertices of selected faces, become."
                           "<ul><li><i>Fixed</i>: stays where it is (tag 0).</li>"
                           "<li><i>Free</i>: follows (tag 1).</li>"
                           "<li><i>Handle</i>: moves as told (the tag is the number below).</li>"
                           "<li><i>Outside</i>: outside the region of influence, never moved (tag -1).</li></ul>");
    addParameter<RichInt>(list, Shown::Always, "handle_number", param.handleNumber, "Handle number",
                          "Which handle the selection becomes: 2 is the first, 3 the second, and so on. Handles with "
                          "different numbers can move differently. Only read when the selection is a handle.");
    addTarget(list, param.target);
    return list;
}

TagSelectionParam tagSelectionParam(const RichParameterList &list) {
    TagSelectionParam param;
    param.role = TagSelectionParam::Role(enumValue(list, "role", 4));
    param.handleNumber = list.getInt("handle_number");
    param.target = target(list);
    param.validate();
    return param;
}

RichParameterList toRichParameters(const TagsFromFilesParam &param) {
    RichParameterList list;
    addParameter<host::RichFileParam>(
        list, Shown::Always, "tag_file", param.tagFile, QStringList("*.sel"), "File with the tags (.sel)",
        "One tag per line for each vertex, in the order of the vertices; lines that begin with # are comments.");
    addTarget(list, param.target);
    return list;
}

TagsFromFilesParam tagsFromFilesParam(const RichParameterList &list) {
    TagsFromFilesParam param;
    param.tagFile = list.getOpenFileName("tag_file");
    param.target = target(list);
    param.validate();
    return param;
}

RichParameterList toRichParameters(const SaveTagsParam &param, const MeshDocument &document) {
    DeformMeshParam deform;
    deform.handles = param.handles;
    const RichParameterList all = toRichParameters(deform, document);
    RichParameterList list;
    addParameter<RichEnum>(list, Shown::Always, "handles", int(param.handles.source),
                           QStringList() << "Vertex quality"
                                         << "Selection"
                                         << "Custom vertex attribute",
                           "Tags from",
                           "Where the tags are that are to be saved, as in 'FCD: Deform Mesh'."
                           "<ul><li><i>Vertex quality</i>: the quality is the tag.</li>"
                           "<li><i>Selection</i>: the selected vertices are the handle, the vertices of selected faces "
                           "stay fixed (where both are selected the handle wins), all else is free.</li>"
                           "<li><i>Custom vertex attribute</i>: the attribute named below holds the tags.</li></ul>");
    list.addParam(all.getParameterByName("tag_attribute"));
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "tag_file", param.tagFile, "*.sel", "Tags go to (.sel)",
        "The file to write: one tag per line for each vertex, in the order of the vertices. An existing file is "
        "replaced.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "transform_file", param.transformFile, "*.def", "Motions go to (.def)",
        "The file to write the motions below to: one 4x4 matrix per handle, in world coordinates, for handle 2, 3, and "
        "so on (the identity for a number that no vertex has). An existing file is replaced. <b>Empty</b> (the "
        "default): only the tags are saved, and the motions below are not used.");
    for (const QString &name : motionParameters())
        list.addParam(all.getParameterByName(name));
    return inOrder(list, {}, true);
}

SaveTagsParam saveTagsParam(const RichParameterList &list, const MeshDocument &document) {
    SaveTagsParam param;
    enumValue(list, "handles", 3);
    RichParameterList all = toRichParameters(DeformMeshParam(), document);
    for (const QString &name : sourceParameters() + motionParameters())
        if (list.hasParameter(name))
            all.setValue(name, list.getParameterByName(name).value());
    param.handles = deformMeshParam(all, document).handles;
    param.tagFile = list.getSaveFileName("tag_file");
    param.transformFile = list.getSaveFileName("transform_file");
    param.validate();
    return param;
}
