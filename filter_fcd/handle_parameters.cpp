// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_parameters.h"

using host::Shown;
using vcg::fcd::Error;

namespace {

void askTagAttribute(Fields &fields, HandleParam &handles) {
    fields.field("tag_attribute", handles.tagAttribute, Shown::Advanced, "Attribute with tags",
                 "Name of the scalar attribute per vertex that holds the tags. Only read when handles come from a "
                 "custom attribute.");
}

void askMotionText(Fields &fields, HandleParam &handles, Shown shown = Shown::Always) {
    fields.field(
        "transforms", handles.transforms, shown, "Motions as text",
        "A motion for each handle, in world coordinates. For example <i>2: rotate 0 0 1 135 about 0 0 0 translate 0 0 "
        "5; 3: translate 1 0 0</i>: tag, colon, the steps in their order; a semicolon between handles. The steps "
        "are:<ul><li><i>translate x y z</i></li><li><i>rotate ax ay az degrees</i>: about the axis (ax, ay, az), "
        "counterclockwise when it points at you; any angle</li><li><i>scale s</i>, or <i>scale sx sy sz</i>: positive "
        "factors</li><li><i>matrix m11 m12 ... m44</i>: 16 numbers, row by row, the last row 0 0 0 1</li><li><i>layer "
        "'NAME'</i>: as the layer of that name lies to this one</li></ul><i>rotate</i> and <i>scale</i> may end in "
        "<i>about x y z</i>, the pivot. Without it, the pivot is the mean of the handle's vertices after the earlier "
        "steps. Case, line breaks and commas between numbers do not matter. Handles without a text move by the motion "
        "file, or else by the other parameters.");
}

void askMotion(Fields &fields, HandleParam &handles, Shown shown = Shown::Always) {
    fields.position("translation", handles.translation, shown, "Translation",
                    "How far handles move along x, y and z, in world units. Applied last.");
    fields.direction("rotation_axis", handles.rotationAxis, shown, "Rotation axis",
                     "The axis that handles turn about. Only its direction counts.");
    fields.field("rotation_angle", handles.rotationAngle, shown, "Rotation angle (degrees)",
                 "How far handles turn, counterclockwise when the axis points at you. Applied before the translation. "
                 "Any angle: 190 degrees twist by 190, not by 170 the other way, and half of 270 (pose 50) is 135. If "
                 "the matrix rotates, too, handles take the shortest way.");
    fields.choice("rotation_center", handles.rotationCenter, shown,
                  {"Barycentre of the handle", "Origin", "Rotation point"}, "Rotation centre",
                  "The pivot that a handle turns about: the mean of its vertices (after the matrix), the origin of the "
                  "world, or the point below.");
    fields.position("rotation_point", handles.rotationPoint, Shown::Advanced, "Rotation point",
                    "The pivot, in world coordinates. Only read when the rotation centre is 'Rotation point'. It is in "
                    "single precision: at 600 000, in steps of 0.06. 'Motions as text' keeps all digits.");
    fields.matrix("TransformMatrix", handles.matrix, Shown::Advanced, "Matrix",
                  "A 4x4 affine matrix in world coordinates (last row 0 0 0 1). It moves handles before rotation and "
                  "translation. It may scale or shear.");
    fields.layer(
        handleLayer, handles.likeLayer, fields.document.mm(), Shown::Advanced, "Move like layer",
        "Handles move from where the deformed layer is to where this one is. Duplicate the layer, move the copy with "
        "the manipulators until the handle is in its place, and choose it here. Only its matrix counts. Matrix, "
        "rotation and translation come on top. <b>The deformed layer itself</b> (the default): not used.");
    if (fields.isGiven(handleLayer) && !handles.likeLayer && fields.document.mm())
        throw Error("'handle_layer' names no layer of this document. Choose the layer that the handles move like, or, "
                    "for none, the layer that is deformed.");
}

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

void askHandles(Fields &fields, HandleParam &handles, Shown shown) {
    askTags(fields, handles, shown);
    fields.openFile("transform_file", handles.transformFile, Shown::Advanced, {"*.def"}, "Motion file (.def)",
                    "A 4x4 matrix for each handle, in world coordinates: the first moves handle 2, the second handle "
                    "3, and so on. May be empty. Handles without a matrix move by the other parameters.");
    askMotionText(fields, handles, shown);
    fields.openFile(
        "point_handles_file", handles.pointFile, Shown::Advanced, {"*.csv", "*.pp"}, "Point file (.csv, .pp)",
        "Points and where they go, in world coordinates. How the surface turns there is free. A list has a line for "
        "each point: <i>vertex, x, y, z</i> (number of the vertex, from 0, and target) or <i>x, y, z, x, y, z</i> "
        "(start and target). Commas, semicolons or blanks separate them; # begins a comment. Picked points "
        "(.pp) alternate start and target. The vertex nearest to a start moves as the start does. Points come in "
        "addition to tags, and belong where the surface is free. A layer without tags is all free then.");
    askMotion(fields, handles, shown);
    if (fields.areRead())
        handles.validate();
}

void askTags(Fields &fields, HandleParam &handles, Shown shown) {
    fields.choice("handles", handles.source, shown,
                  {"Vertex quality", "Selection", "Custom vertex attribute", "Files", "Tags of the layer"},
                  "Handles from",
                  "Where the tags are: <b>0</b> is fixed, <b>1</b> is free, and <b>2, 3, ...</b> are handles. "
                  "<b>Negative</b> is outside: it never moves.<ul><li><i>Vertex "
                  "quality</i>: the quality is the tag. 'FCD: Tag' writes it.</li><li><i>Selection</i>: selected "
                  "vertices are the handle, vertices of selected faces are fixed, the rest is free. The handle wins "
                  "where both are selected.</li><li><i>Custom vertex attribute</i>: the attribute "
                  "below.</li><li><i>Files</i>: the tag file below.</li><li><i>Tags of the layer</i>: marks of the "
                  "tool, or what 'FCD: Tag' wrote, whatever the quality is now; without these, all is free.</li></ul>");
    askTagAttribute(fields, handles);
    fields.openFile("tag_file", handles.tagFile, Shown::Advanced, {"*.sel"}, "Tag file (.sel)",
                    "One tag a line, in the order of the vertices. Lines that begin with # are comments. Only read "
                    "when handles come from files.");
}

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
