// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::Shown;

namespace {

void askTarget(Fields &fields, TagTarget &target) {
    fields.field("tag_attribute", target.attribute, Shown::Advanced, "Attribute for tags",
                 "Name of the scalar attribute per vertex that gets the tags. It is added where it is lacking. "
                 "<b>Empty</b> (the default): the vertex quality gets them.");
    fields.field("colorize", target.colorize, Shown::Always, "Colour by tag",
                 "Colours vertices by tag: fixed blue, free yellow, handles red in shades, outside grey. The layer's "
                 "own colours are kept aside. Deformed layers have them, and 'FCD: Clear Tags' brings them back.");
}

void askRole(Fields &fields, TagParam &param, bool all) {
    QStringList roles = {"Fixed", "Free", "Handle", "Outside"};
    QString help = "What selected vertices, and the vertices of selected faces, become.<ul><li><i>Fixed</i>: stays "
                   "where it is (tag 0).</li><li><i>Free</i>: follows (tag 1).</li><li><i>Handle</i>: moves as you say "
                   "(the tag is the number below).</li><li><i>Outside</i>: is ignored, and never moves (tag -1).</li>";
    if (all) {
        roles << "(all tags are in the file below)"
              << "(all tags stay as they are)";
        help += "<li>Or take all tags from a file.</li><li>Or leave them, and only write files.</li>";
    }
    fields.choice("role", param.role, Shown::Always, roles, "The selection is", help + "</ul>");
    fields.field("handle_number", param.handleNumber, Shown::Always, "Handle number",
                 "Which handle the selection becomes: 2 is the first, 3 the second, and so on. Handles with different "
                 "numbers can move differently. Only read for handles.");
}

void askTagFile(Fields &fields, TagParam &param) {
    fields.openFile("tag_file", param.tagFile, Shown::Always, {"*.sel"}, "All tags from (.sel)",
                    "One tag a line, in the order of the vertices. Lines that begin with # are comments.");
}

} // namespace

void ask(Fields &fields, TagSelectionParam &param) {
    askRole(fields, param, false);
    askTarget(fields, param.target);
    if (fields.areRead())
        param.validate();
}

void ask(Fields &fields, TagsFromFilesParam &param) {
    param.role = TagParam::FromFile;
    askTagFile(fields, param);
    askTarget(fields, param.target);
    if (fields.areRead())
        param.validate();
}

void ask(Fields &fields, TagParam &param) {
    askRole(fields, param, true);
    askTagFile(fields, param);
    askTarget(fields, param.target);
    fields.saveFile("save_tag_file", param.save.tagFile, Shown::Advanced, "*.sel", "Write tags to (.sel)",
                    "The file to write all tags to: one a line, in the order of the vertices. An existing file is "
                    "replaced. <b>Empty</b> (the default): none is written.");
    fields.saveFile(
        "save_transform_file", param.save.transformFile, Shown::Advanced, "*.def", "Write motions to (.def)",
        "The file to write the motions below to: a 4x4 matrix for each handle, in world coordinates, for handle 2, 3, "
        "and so on. An existing file is replaced. <b>Empty</b> (the default): none is written.");
    askMotionText(fields, param.save.handles);
    if (fields.areRead())
        param.validate();
}

void ask(Fields &fields, SaveTagsParam &param) {
    fields.choice("handles", param.handles.source, Shown::Always,
                  {"Vertex quality", "Selection", "Custom vertex attribute"}, "Tags from",
                  "Where the tags are, as in 'FCD: Deform Mesh'.<ul><li><i>Vertex quality</i>: the quality is the "
                  "tag.</li><li><i>Selection</i>: selected vertices are the handle, vertices of selected faces are "
                  "fixed, the rest is free. The handle wins where both are selected.</li><li><i>Custom vertex "
                  "attribute</i>: the attribute below.</li></ul>");
    fields.letLack();
    askTagAttribute(fields, param.handles);
    fields.saveFile("tag_file", param.tagFile, Shown::Always, "*.sel", "Write tags to (.sel)",
                    "The file to write: one tag a line, in the order of the vertices. An existing file is replaced.");
    fields.saveFile("transform_file", param.transformFile, Shown::Always, "*.def", "Write motions to (.def)",
                    "The file to write the motions below to: a 4x4 matrix for each handle, in world coordinates, for "
                    "handle 2, 3, and so on (the identity for a number without vertices). An existing file is "
                    "replaced. <b>Empty</b> (the default): only tags are saved.");
    askMotionText(fields, param.handles);
    askMotion(fields, param.handles);
    fields.order({}, true);
    if (fields.areRead()) {
        param.handles.validate();
        param.validate();
    }
}
