// SPDX-License-Identifier: GPL-3.0-or-later
#include "common_parameters.h"

using host::addParameter;
using host::Shown;
using vcg::fcd::Error;

void addHandles(RichParameterList &list, const HandleParam &handles, const MeshDocument &document, Shown shown) {
    addParameter<RichEnum>(list, shown, "handles", int(handles.source),
                           QStringList() << "Vertex quality"
                                         << "Selection"
                                         << "Custom vertex attribute"
                                         << "Files"
                                         << "Tags of the layer",
                           "Handles from",
                           "Where it is written what moves and what stays. Each vertex has a <b>tag</b>: <b>0</b> "
                           "stays fixed, <b>1</b> is free "
                           "and follows, <b>2, 3, ...</b> belongs to handle 2, 3, ... and moves as told, a "
                           "<b>negative</b> tag lies outside the "
                           "region of influence and is never moved."
                           "<ul><li><i>Vertex quality</i>: the quality is the tag (set it for example with 'Per Vertex "
                           "Quality Function').</li>"
                           "<li><i>Selection</i>: the selected vertices are the handle, the vertices of selected faces "
                           "stay fixed (where both "
                           "are selected the handle wins), all else is free.</li>"
                           "<li><i>Custom vertex attribute</i>: the attribute named below holds the tags.</li>"
                           "<li><i>Files</i>: a .sel file holds the tags.</li>"
                           "<li><i>Tags of the layer</i>: marks of the tool, or what 'FCD: Tag Selection' wrote; where "
                           "there are none, all is free, whatever the quality is.</li></ul>");
    addParameter<RichString>(
        list, Shown::Advanced, "tag_attribute", handles.tagAttribute, "Attribute with the tags",
        "Name of the per-vertex scalar attribute that holds the tags. Only read when the handles come "
        "from a custom attribute.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "tag_file", handles.tagFile, QStringList("*.sel"), "File with the tags (.sel)",
        "One tag per line for each vertex, in the order of the vertices; lines that begin with "
        "# are comments. Only read when the handles come from files.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "transform_file", handles.transformFile, QStringList("*.def"),
        "File with the motions (.def)",
        "One 4x4 matrix per handle, in world coordinates: the first moves handle 2, the second handle 3, and so on. "
        "May be "
        "left empty, and may be given whatever the handles come from. Handles without a matrix in it move by the "
        "translation, rotation, matrix and layer below.");
    addParameter<RichString>(
        list, Shown::Advanced, "transforms", handles.transforms, "Motions as text",
        "A motion for each handle, in world coordinates, for example <i>2: rotate 0 0 1 135 about 0 0 0 translate 0 0 "
        "5; 3: translate 1 0 0</i>: the handle's tag, a colon and the steps of its motion in their order; a semicolon "
        "between handles. The steps are:"
        "<ul><li><i>translate x y z</i></li>"
        "<li><i>rotate ax ay az degrees</i>: about the axis (ax, ay, az), counterclockwise when it points at you; any "
        "angle</li>"
        "<li><i>scale s</i>, or <i>scale sx sy sz</i>: positive factors</li>"
        "<li><i>matrix m11 m12 ... m44</i>: 16 numbers, row by row, the last row 0 0 0 1</li>"
        "<li><i>layer 'NAME'</i>: as the layer of that name lies to this one, for example a copy of the handle that "
        "was "
        "put in place with MeshLab's manipulators</li></ul>"
        "<i>rotate</i> and <i>scale</i> may be followed by <i>about x y z</i>, the point that stays in place; without "
        "it, that is the mean of the handle's own vertices, where the steps before have put it. Upper and lower case, "
        "line breaks and commas between numbers make no difference. May be given whatever the handles come from. "
        "Handles that are not in it move by the file above or by the translation, rotation, "
        "matrix and layer below.");
    addParameter<host::RichFileParam>(
        list, Shown::Advanced, "point_handles_file", handles.pointFile,
        QStringList() << "*.csv"
                      << "*.pp",
        "File with point handles (.csv, .pp)",
        "Points and where they go, in world coordinates; between them the surface turns as it likes. Either a "
        "list with a line for each point: <i>vertex, x, y, z</i> (the number of a vertex, from 0, and its target) or "
        "<i>x, y, z, x, y, z</i> (start and target), with commas, semicolons or blanks between; lines that begin with "
        "# "
        "are comments. Or MeshLab's picked points (.pp): start, target, start, target, and so on. For a start that is "
        "no vertex, the nearest vertex moves as the start does. Points are handles in addition to the tags, and belong "
        "where the surface is free; with them, a layer without tags is all free.");

    // How it moves.
    addParameter<host::RichPositionParam>(list, shown, "translation", toPoint(handles.translation), "Translation",
                                          "How far the handles move along x, y and z, in world units. Applied last.");
    addParameter<host::RichDirectionParam>(list, shown, "rotation_axis", toPoint(handles.rotationAxis), "Rotation axis",
                                           "Axis that the handles turn about; only its direction counts.");
    addParameter<RichFloat>(
        list, shown, "rotation_angle", Scalarm(handles.rotationAngle), "Rotation angle (degrees)",
        "How far the handles turn, in degrees, counterclockwise when the axis points at you. Applied "
        "before the translation. Any angle; the pose follows it: 270 degrees at pose 50 are 135 (with a matrix below "
        "that rotates, too, the handles take the shortest way). A turn is what it "
        "says: the surface between is twisted by 190 degrees one way, not by 170 the other, and by 360 once round. (A "
        "matrix alone cannot say so, and takes the shortest way.)");
    addParameter<RichEnum>(
        list, shown, "rotation_center", int(handles.rotationCenter),
        QStringList() << "Barycentre of the handle"
                      << "Origin"
                      << "Rotation point",
        "Rotation centre",
        "The point that stays in place when a handle turns: the mean of the handle's own vertices (where "
        "the matrix below has put them), the origin of the world, or the point given below.");
    addParameter<host::RichPositionParam>(
        list, Shown::Advanced, "rotation_point", toPoint(handles.rotationPoint), "Rotation point",
        "Centre of the rotation in world coordinates. Only read when the rotation centre "
        "is 'Rotation point'. It comes here in single precision, which far from the origin is coarse (at 600 000, "
        "steps "
        "of 0.06): 'Motions as text' keeps all digits.");
    Matrix44m matrix;
    matrix.FromEigenMatrix(handles.matrix);
    addParameter<host::RichMatrixParam>(
        list, Shown::Advanced, "TransformMatrix", matrix, "Matrix",
        "A 4x4 affine matrix in world coordinates (last row 0 0 0 1) that moves the handles, "
        "applied before rotation and translation. May also scale or shear them.");
    host::addLayerParameter(
        list, Shown::Advanced, handleLayer, handles.likeLayer ? handles.likeLayer : document.mm(), document,
        "Handle moves like layer",
        "The handles move as this layer lies to the one that is deformed: duplicate the layer, put the copy where the "
        "handle belongs with MeshLab's manipulators, and choose it here. Only its matrix counts. Matrix, rotation and "
        "translation come on top of that. <b>The layer that is deformed itself</b> (the default): not used. As the "
        "other motions of the dialog, it moves the handles that neither a text nor a file moves.");
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
