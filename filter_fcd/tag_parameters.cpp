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
    addParameter<RichString>(list, Shown::Advanced, "tag_attribute", target.attribute, "Attribute for tags",
                             "Name of the scalar attribute per vertex that gets the tags. It is added where it is "
                             "lacking. <b>Empty</b> (the default): the vertex quality gets them.");
    addParameter<RichBool>(
        list, Shown::Always, "colorize", target.colorize, "Colour by tag",
        "Colours vertices by tag: fixed blue, free yellow, handles red in shades, outside grey. The layer's own "
        "colours are kept aside. Deformed layers have them, and 'FCD: Clear Tags' brings them back.");
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
    addParameter<RichEnum>(
        list, Shown::Always, "role", int(param.role),
        QStringList() << "Fixed"
                      << "Free"
                      << "Handle"
                      << "Outside",
        "The selection is",
        "What selected vertices, and the vertices of selected faces, become.<ul><li><i>Fixed</i>: stays where it is "
        "(tag 0).</li><li><i>Free</i>: follows (tag 1).</li><li><i>Handle</i>: moves as you say (the tag is the number "
        "below).</li><li><i>Outside</i>: is ignored, and never moves (tag -1).</li></ul>");
    addParameter<RichInt>(list, Shown::Always, "handle_number", param.handleNumber, "Handle number",
                          "Which handle the selection becomes: 2 is the first, 3 the second, and so on. Handles with "
                          "different numbers can move differently. Only read for handles.");
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
        list, Shown::Always, "tag_file", param.tagFile, QStringList("*.sel"), "Tag file (.sel)",
        "One tag a line, in the order of the vertices. Lines that begin with # are comments.");
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
                           "Where the tags are, as in 'FCD: Deform Mesh'.<ul><li><i>Vertex quality</i>: the quality is "
                           "the tag.</li><li><i>Selection</i>: selected vertices are the handle, vertices of selected "
                           "faces are fixed, the rest is free. The handle wins where both are "
                           "selected.</li><li><i>Custom vertex attribute</i>: the attribute below.</li></ul>");
    list.addParam(all.getParameterByName("tag_attribute"));
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "tag_file", param.tagFile, "*.sel", "Write tags to (.sel)",
        "The file to write: one tag a line, in the order of the vertices. An existing file is replaced.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Always, "transform_file", param.transformFile, "*.def", "Write motions to (.def)",
        "The file to write the motions below to: a 4x4 matrix for each handle, in world coordinates, for handle 2, 3, "
        "and so on (the identity for a number without vertices). An existing file is replaced. <b>Empty</b> (the "
        "default): only tags are saved.");
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
