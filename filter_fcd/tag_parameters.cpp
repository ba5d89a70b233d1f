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

void addRole(RichParameterList &list, const TagParam &param, bool all) {
    QStringList roles = {"Fixed", "Free", "Handle", "Outside"};
    QString help =
        "What selected vertices, and the vertices of selected faces, become.<ul><li><i>Fixed</i>: stays where "
        "it is (tag 0).</li><li><i>Free</i>: follows (tag 1).</li><li><i>Handle</i>: moves as you say (the "
        "tag is the number below).</li><li><i>Outside</i>: is ignored, and never moves (tag -1).</li>";
    if (all) {
        roles << "(all tags are in the file below)"
              << "(all tags stay as they are)";
        help += "<li>Or take all tags from a file.</li><li>Or leave them, and only write files.</li>";
    }
    addParameter<RichEnum>(list, Shown::Always, "role", int(param.role), roles, "The selection is", help + "</ul>");
    addParameter<RichInt>(list, Shown::Always, "handle_number", param.handleNumber, "Handle number",
                          "Which handle the selection becomes: 2 is the first, 3 the second, and so on. Handles with "
                          "different numbers can move differently. Only read for handles.");
}

void addTagFile(RichParameterList &list, const TagParam &param) {
    addParameter<host::RichFileParam>(
        list, Shown::Always, "tag_file", param.tagFile, QStringList("*.sel"), "All tags from (.sel)",
        "One tag a line, in the order of the vertices. Lines that begin with # are comments.");
}

} // namespace

RichParameterList toRichParameters(const TagParam &param, bool fromFile) {
    RichParameterList list;
    if (fromFile)
        addTagFile(list, param);
    else
        addRole(list, param, false);
    addTarget(list, param.target);
    return list;
}

TagParam tagParam(const RichParameterList &list, bool fromFile) {
    TagParam param;
    param.role = fromFile ? TagParam::FromFile : TagParam::Role(enumValue(list, "role", 4));
    if (fromFile)
        param.tagFile = list.getOpenFileName("tag_file");
    else
        param.handleNumber = list.getInt("handle_number");
    param.target = target(list);
    param.validate();
    return param;
}

RichParameterList toRichParameters(const TagParam &param, const MeshDocument &document) {
    DeformMeshParam deform;
    deform.handles = param.save.handles;
    RichParameterList list;
    addRole(list, param, true);
    addTagFile(list, param);
    addTarget(list, param.target);
    addParameter<host::RichSaveFileParam>(
        list, Shown::Advanced, "save_tag_file", param.save.tagFile, "*.sel", "Write tags to (.sel)",
        "The file to write all tags to: one a line, in the order of the vertices. An existing file is replaced. "
        "<b>Empty</b> (the default): none is written.");
    addParameter<host::RichSaveFileParam>(
        list, Shown::Advanced, "save_transform_file", param.save.transformFile, "*.def", "Write motions to (.def)",
        "The file to write the motions below to: a 4x4 matrix for each handle, in world coordinates, for handle 2, 3, "
        "and so on. An existing file is replaced. <b>Empty</b> (the default): none is written.");
    list.addParam(toRichParameters(deform, document).getParameterByName("transforms"));
    return list;
}

TagParam tagParam(const RichParameterList &list, const MeshDocument &document) {
    TagParam param;
    param.role = TagParam::Role(enumValue(list, "role", 6));
    param.handleNumber = list.getInt("handle_number");
    param.tagFile = list.getOpenFileName("tag_file");
    param.target = target(list);
    RichParameterList all = toRichParameters(DeformMeshParam(), document);
    all.setValue("transforms", list.getParameterByName("transforms").value());
    param.save.handles = deformMeshParam(all, document).handles;
    param.save.tagFile = list.getSaveFileName("save_tag_file");
    param.save.transformFile = list.getSaveFileName("save_transform_file");
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
