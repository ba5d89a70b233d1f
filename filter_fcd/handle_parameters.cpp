// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::addParameter;
using host::Shown;
using vcg::fcd::Error;

void addHandles(RichParameterList &list, const HandleParam &handles, const MeshDocument &document, Shown shown) {
    addParameter<RichEnum>(
        list, shown, "handles", int(handles.source),
        QStringList() << "Vertex quality"
                      << "Selection"
                      << "Custom vertex attribute"
                      << "Files"
                      << "Tags of the layer",
        "Handles from",
        "Where the tags are. A vertex with tag <b>0</b> is fixed, with <b>1</b> free, with <b>2, 3, ...</b> of handle "
        "2, 3, ..., and with a <b>negative</b> tag outside: it never moves.<ul><li><i>Vertex quality</i>: the quality "
        "is the tag. 'FCD: Tag' writes it.</li><li><i>Selection</i>: selected vertices are the handle, "
        "vertices of selected faces are fixed, the rest is free. The handle wins where both are "
        "selected.</li><li><i>Custom vertex attribute</i>: the attribute below.</li><li><i>Files</i>: the tag file "
        "below.</li><li><i>Tags of the layer</i>: marks of the tool, or what 'FCD: Tag' wrote, whatever the "
        "quality is now; without these, all is free.</li></ul>");
    addParameter<RichString>(list, Shown::Advanced, "tag_attribute", handles.tagAttribute, "Attribute with tags",
                             "Name of the scalar attribute per vertex that holds the tags. Only read when handles come "
                             "from a custom attribute.");
    addParameter<host::RichFileParam>(list, Shown::Advanced, "tag_file", handles.tagFile, QStringList("*.sel"),
                                      "Tag file (.sel)",
                                      "One tag a line, in the order of the vertices. Lines that begin with # are "
                                      "comments. Only read when handles come from files.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "transform_file", handles.transformFile, QStringList("*.def"), "Motion file (.def)",
        "A 4x4 matrix for each handle, in world coordinates: the first moves handle 2, the second handle 3, and so on. "
        "May be empty. Handles without a matrix move by the other parameters.");
    addParameter<RichString>(
        list, shown, "transforms", handles.transforms, "Motions as text",
        "A motion for each handle, in world coordinates. For example <i>2: rotate 0 0 1 135 about 0 0 0 translate 0 0 "
        "5; 3: translate 1 0 0</i>: tag, colon, the steps in their order; a semicolon between handles. The steps "
        "are:<ul><li><i>translate x y z</i></li><li><i>rotate ax ay az degrees</i>: about the axis (ax, ay, az), "
        "counterclockwise when it points at you; any angle</li><li><i>scale s</i>, or <i>scale sx sy sz</i>: positive "
        "factors</li><li><i>matrix m11 m12 ... m44</i>: 16 numbers, row by row, the last row 0 0 0 1</li><li><i>layer "
        "'NAME'</i>: as the layer of that name lies to this one</li></ul><i>rotate</i> and <i>scale</i> may end in "
        "<i>about x y z</i>, the point that stays in place. Without it, that is the mean of the handle's vertices, "
        "where earlier steps have put it. Case, line breaks and commas between numbers do not matter. Handles without "
        "a text move by the motion file, or else by the other parameters.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "point_handles_file", handles.pointFile,
        QStringList() << "*.csv"
                      << "*.pp",
        "Point file (.csv, .pp)",
        "Points and where they go, in world coordinates. How the surface turns there is free. A list has a line for "
        "each point: <i>vertex, x, y, z</i> (number of the vertex, from 0, and target) or <i>x, y, z, x, y, z</i> "
        "(start and target), with commas, semicolons or blanks; lines that begin with # are comments. Picked points "
        "(.pp) alternate start and target. The vertex nearest to a start moves as the start does. Points come in "
        "addition to tags, and belong where the surface is free. A layer without tags is all free then.");

    // How it moves.
    addParameter<host::RichPositionParam>(list, shown, "translation", toPoint(handles.translation), "Translation",
                                          "How far handles move along x, y and z, in world units. Applied last.");
    addParameter<host::RichDirectionParam>(list, shown, "rotation_axis", toPoint(handles.rotationAxis), "Rotation axis",
                                           "The axis that handles turn about. Only its direction counts.");
    addParameter<RichFloat>(
        list, shown, "rotation_angle", Scalarm(handles.rotationAngle), "Rotation angle (degrees)",
        "How far handles turn, counterclockwise when the axis points at you. Applied before the translation. Any "
        "angle: 190 degrees twist the surface by 190 one way, not by 170 the other, and 270 at pose 50 are 135. With a "
        "matrix that rotates, too, handles take the shortest way.");
    addParameter<RichEnum>(list, shown, "rotation_center", int(handles.rotationCenter),
                           QStringList() << "Barycentre of the handle"
                                         << "Origin"
                                         << "Rotation point",
                           "Rotation centre",
                           "The point that stays in place when a handle turns: the mean of its vertices (where the "
                           "matrix has put them), the origin of the world, or the point below.");
    addParameter<host::RichPositionParam>(
        list, Shown::Advanced, "rotation_point", toPoint(handles.rotationPoint), "Rotation point",
        "Centre of the rotation, in world coordinates. Only read when the rotation centre is 'Rotation point'. It is "
        "in single precision: at 600 000, in steps of 0.06. 'Motions as text' keeps all digits.");
    Matrix44m matrix;
    matrix.FromEigenMatrix(handles.matrix);
    addParameter<host::RichMatrixParam>(list, Shown::Advanced, "TransformMatrix", matrix, "Matrix",
                                        "A 4x4 affine matrix in world coordinates (last row 0 0 0 1). It moves handles "
                                        "before rotation and translation. It may scale or shear.");
    host::addLayerParameter(
        list, Shown::Advanced, handleLayer, handles.likeLayer ? handles.likeLayer : document.mm(), document,
        "Move like layer",
        "Handles move as this layer lies to the one that is deformed. Duplicate the layer, put the copy where the "
        "handle belongs with the manipulators, and choose it here. Only its matrix counts. Matrix, rotation and "
        "translation come on top. <b>The deformed layer itself</b> (the default): not used.");
}

HandleParam handleParam(const RichParameterList &list, const MeshDocument &document) {
    HandleParam handles;
    handles.source = HandleParam::Source(enumValue(list, "handles", 5));
    handles.tagAttribute = list.getString("tag_attribute");
    handles.tagFile = list.getOpenFileName("tag_file");
    handles.transformFile = list.getOpenFileName("transform_file");
    handles.transforms = list.getString("transforms");
    handles.pointFile = list.getOpenFileName("point_handles_file");
    handles.translation = toVector(list.getPoint3m("translation"));
    handles.rotationAxis = toVector(list.getPoint3m("rotation_axis"));
    handles.rotationAngle = asTyped(list.getFloat("rotation_angle"));
    handles.rotationCenter = HandleParam::Center(enumValue(list, "rotation_center", 3));
    handles.rotationPoint = toVector(list.getPoint3m("rotation_point"));
    const Matrix44m matrix = host::matrixParameter(list, "TransformMatrix");
    matrix.ToEigenMatrix(handles.matrix);
    if (list.hasParameter(handleLayer)) { // the window of 2020.09 runs scripts that lack it as they are
        handles.likeLayer = host::layerParameter(list, handleLayer, document);
        if (!handles.likeLayer && document.mm())
            throw Error("'handle_layer' names no layer of this document. Choose the layer that the handles move like, "
                        "or, for none, the layer that is deformed.");
    }
    handles.validate();
    return handles;
}
