// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameters.h"

#include "save_files.h"

#include <vcg_ext/base/words.h>

#include <cmath>
#include <string>

using vcg::fcd::Error;

void HandleParam::validate() const {
    if (!translation.allFinite() || !rotationAxis.allFinite() || !rotationPoint.allFinite() ||
        !std::isfinite(rotationAngle))
        throw Error("translation, rotation_axis, rotation_angle and rotation_point must be finite numbers.");
    if (rotationAngle != 0 && !(rotationAxis.norm() > 0))
        throw Error("rotation_axis is 0 0 0, which is no direction. Give an axis, or set rotation_angle to 0.");
    if (!matrix.allFinite() || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw Error("TransformMatrix is not affine: its last row must be 0 0 0 1 and all its entries finite numbers.");
    if (source == Attribute && tagAttribute.isEmpty())
        throw Error("tag_attribute is empty. Give the name of the per-vertex attribute that holds the tags.");
    if (source == Files && tagFile.isEmpty() && pointFile.isEmpty())
        throw Error("tag_file is empty. Give the .sel file with one tag per vertex, or a file with point handles, or "
                    "choose another source of handles.");
}

void SequenceParam::validate() const {
    if (!(rate > 0) || std::isinf(rate))
        throw Error("frames_per_second must be a positive number.");
    if (layers == None && gltfFile.isEmpty() && pc2File.isEmpty() && mddFile.isEmpty() && saveFile.isEmpty())
        throw Error("There is nothing to make: choose 'frame_layers', or give a gltf_file, a pc2_file, an "
                    "mdd_file or a save_poses_file.");
    const QStringList files = {saveFile, gltfFile, pc2File, mddFile};
    for (int i = 0; i < files.size(); ++i)
        for (int j = 0; j < i; ++j)
            if (!files[i].isEmpty() && !files[j].isEmpty() && isSameFile(files[i], files[j]))
                throw Error("Two of save_poses_file, gltf_file, pc2_file and mdd_file are the same file. Give "
                            "different files.");
}

void SaveDeformationParam::validate() const {
    if (file.isEmpty())
        throw Error("deformation_file is empty. Give the .ply file to write the deformation to.");
}

void TagParam::validate() const {
    if (role == Handle && handleNumber < 2)
        throw Error("handle_number is " + std::to_string(handleNumber) +
                    "; handles are numbered from 2 (0 is the tag of fixed vertices, 1 that of free ones).");
    if (role == FromFile && tagFile.isEmpty())
        throw Error("tag_file is empty. Give the .sel file with one tag per vertex.");
    if (role != FromFile && !tagFile.isEmpty() && !host::inWindow()) // dialogs remember the last file
        throw Error(
            "tag_file would not be read: role takes other tags. Give role 4, the tags of the file, or no file.");
    const auto expectOther = [&](const char *name, const QString &file) {
        if (!file.isEmpty() && !save.transformFile.isEmpty() && isSameFile(file, save.transformFile))
            throw Error(std::string(name) + " and save_transform_file are the same file. Give two different files.");
    };
    expectOther("save_tag_file", save.tagFile);
    if (role == FromFile)
        expectOther("tag_file", tagFile);
    if (role == AsTheyAre && save.tagFile.isEmpty() && save.transformFile.isEmpty())
        throw Error("There is nothing to do: say what the selection becomes, or give a file to write.");
}

void SaveTagsParam::validate() const {
    if (tagFile.isEmpty())
        throw Error("tag_file is empty. Give the .sel file to write the tags to.");
    if (!transformFile.isEmpty() && isSameFile(tagFile, transformFile))
        throw Error("tag_file and transform_file are the same file. Give two different files.");
}

double asTyped(double value, int exponent) {
    if (!std::isfinite(value))
        return value;
    std::string text = vcg::fcd::detail::ToText(float(value));
    const std::size_t e = text.find('e');
    if (e != std::string::npos) {
        exponent += std::stoi(text.substr(e + 1));
        text.resize(e);
    }
    text += "e" + std::to_string(exponent);
    double typed = value; // stays if the decimal is beyond a double
    vcg::fcd::detail::ToNumber(text.data(), text.data() + text.size(), typed);
    return typed;
}

vcg::fcd::DeformationParam asHandedOver(vcg::fcd::DeformationParam param) {
    const auto round = [](double &number) { number = asTyped(number); };
    round(param.graph.targetRadius);
    round(param.smoothness);
    round(param.rigidity);
    round(param.tolerance);
    round(param.influence);
    round(param.pose);
    if (host::scriptsMayLackParameters) // otherwise it is no parameter
        round(param.weldDistance);
    return param;
}

ParameterText falloffText() {
    return {"Falloff",
            "How the motion of a handle fades towards other handles and fixed parts. <i>Smooth</i>: evenly. "
            "<i>Linear</i>: straight, with the bends near both ends. <i>Sharp</i>: to a peak at the handle. "
            "<i>Constant</i>: the surface around the handle goes along, and bends far from it.",
            {"Smooth", "Linear", "Sharp", "Constant"}};
}

ParameterText elasticText() {
    return {"Elastic (keep volume)",
            "The bent part keeps its volume: a squeezed limb gets thicker, a pulled one thinner, and a bend loses "
            "none. Each connected part keeps its own volume. A cloud and an open sheet have none."};
}

ParameterText rigidityText() {
    return {
        "Rigidity (1 rigid, 0 smooth)",
        "How strongly the surface resists stretching. <b>1</b> (the default): as rigid as possible, for what bends, "
        "as bodies do. <b>0</b>: as smooth as possible, like a thin-plate spline, for what is sheared, scaled or "
        "grown all over, such as one skull fitted to another. Large turns need rigidity."};
}

ParameterText weightsText() {
    return {"Distances",
            "How a vertex finds the nodes that move it. <i>Along the surface</i>: close parts that are not connected "
            "(fingers, lips, folds) do not drag each other along. <i>Euclidean</i>: by straight distance, as in the "
            "paper.",
            {"Along the surface", "Euclidean"}};
}

StraightenTexts straightenTexts() {
    StraightenTexts texts;
    texts.middle = {"Through the middle",
                    "Moves the line into the middles of the surface's cross-sections. So you may pick its points on "
                    "the surface. If moving it would stretch the surface more, the line stays; the log says so."};
    texts.shape = {"New shape",
                   "What the line becomes. The middle of a straight line or an arc is at the middle of the line. The "
                   "frames along the line turn as little as possible.",
                   {"A straight line", "An arc", "The line of a layer"}};
    texts.angle = {"Angle of the arc (degrees)",
                   "How far the arc bends from end to end, less than 360. Negative: to the other side."};
    texts.direction = {"Direction",
                       "Direction of the straight line, or of the middle of the arc. <b>0 0 0</b> (the default): from "
                       "end to end of the line."};
    texts.towards = {"Bends towards",
                     "The direction to which the ends of the arc bend. <b>0 0 0</b> (the default): where the ends of "
                     "the line bend to."};
    texts.target = {"Target line",
                    "A layer with edges that form one open path. The line is laid along it from its beginning, and "
                    "goes on straight if it is longer. Only read for 'The line of a layer'."};
    texts.reverse = {"Reverse the target line",
                     "Lays the line along the target line from its other end. A line of a layer begins at the end "
                     "whose vertex has the smaller number."};
    texts.length = {"Length", "The new length of the line, in world units. The surface stretches along it and keeps "
                              "its cross-sections. <b>0</b> (the default): as long as it is."};
    texts.untwist = {"Remove twist", "Turns cross-sections about the line until their longest axes point the same way "
                                     "as in the middle. They must not be round."};
    return texts;
}
