// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // before Qt

#include "handle_sources.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "point_sources.h"

#include <Eigen/Geometry>

#include <cmath>
#include <limits>

#include <QRegularExpression>

using vcg::fcd::Error;
using vcg::fcd::Handles;
using vcg::fcd::Index;
using vcg::fcd::Motion;
using vcg::fcd::MotionStep;

namespace {

/// The motion of the handles of \p layer by the parameters of the dialog.
std::vector<MotionStep> stepsOf(const HandleParam &param, const MeshModel &layer) {
    std::vector<MotionStep> steps;
    if (param.likeLayer && param.likeLayer != &layer) {
        steps.push_back(MotionStep::Affine(motionTo(*param.likeLayer, layer)));
        try {
            vcg::fcd::ToMotion(steps, Eigen::Vector3d::Zero());
        } catch (const Error &e) {
            throw Error("The handles cannot move like the layer " + inQuotes(*param.likeLayer) + ": " + e.what());
        }
    }
    steps.push_back(MotionStep::Affine(param.matrix));
    if (param.rotationAngle != 0) {
        steps.push_back(MotionStep::Rotate(param.rotationAxis, param.rotationAngle));
        if (param.rotationCenter == HandleParam::Point)
            steps.back().about = param.rotationPoint;
        else if (param.rotationCenter == HandleParam::Origin)
            steps.back().about = Eigen::Vector3d(0, 0, 0);
    }
    steps.push_back(MotionStep::Translate(param.translation));
    return steps;
}

/// How far single precision may have moved \p point; 0 if it has more digits.
double singleError(const Eigen::Vector3d &point) {
    if (rounded<float>(point) != point)
        return 0;
    return point.cwiseAbs().maxCoeff() * std::numeric_limits<float>::epsilon() / 2;
}

/// \p steps with each "layer 'NAME'" replaced by the matrix that leads from \p layer to the layer of that name.
QString withLayers(const QString &steps, const MeshDocument &document, const MeshModel &layer) {
    static const char *const pattern = "\\blayer\\s*(?:'([^']*)'|\"([^\"]*)\")";
    const QRegularExpression step(pattern, QRegularExpression::CaseInsensitiveOption);
    QString result;
    int end = 0;
    for (QRegularExpressionMatchIterator i = step.globalMatch(steps); i.hasNext();) {
        const QRegularExpressionMatch match = i.next();
        const QString name = match.captured(1) + match.captured(2);
        std::vector<const MeshModel *> called;
        for (const MeshModel *other : host::layers(document))
            if (other->label() == name)
                called.push_back(other);
        if (called.empty())
            throw Error("transforms names the layer '" + name.toStdString() +
                        "', but no layer has that name. Write the name as the list of layers shows it.");
        if (called.size() > 1)
            throw Error("transforms names the layer '" + name.toStdString() + "', and " +
                        std::to_string(called.size()) + " layers have that name. Rename the one that is meant.");
        const Eigen::Matrix4d matrix = motionTo(*called.front(), layer);
        result += steps.mid(end, match.capturedStart() - end) + "matrix";
        for (int k = 0; k < 16; ++k)
            result += " " + QString::number(k < 12 ? matrix(k / 4, k % 4) : k == 15, 'g', 17);
        end = match.capturedEnd();
    }
    result += steps.mid(end);
    if (result.contains(QRegularExpression("\\blayer\\b", QRegularExpression::CaseInsensitiveOption)))
        throw Error("transforms has 'layer' without a name in quotes. Write layer 'NAME', with the name as the list of "
                    "layers shows it.");
    return result;
}

Eigen::Vector3d extentOf(const CMeshO &mesh) {
    Eigen::AlignedBox3d box;
    for (const CVertexO &vertex : mesh.vert)
        if (!vertex.IsD())
            box.extend(vcg::tri::PositionOf(vertex));
    return box.sizes();
}

/// "2, 3 and 7", cut short if there are very many.
template <class Map>
std::string listOfKeys(const Map &map) {
    std::string list;
    std::size_t n = 0;
    for (const auto &item : map) {
        if (++n > 20)
            return list + ", ...";
        list += (n == 1 ? "" : n == map.size() ? " and " : ", ") + std::to_string(item.first);
    }
    return list;
}

} // namespace

Handles readHandles(const MeshModel &layer, const Point3m *rest, const HandleParam &param, const Remark &remark) {
    Handles handles;
    handles.tag = readTags(layer, param);
    tellOfTags(layer, param, handles.tag, remark);
    handles.world = invertibleMatrixOf(layer);
    if (!param.pointFile.isEmpty())
        handles.point = readPointHandles(layer, rest, param.pointFile, remark);
    return handles;
}

std::map<int, std::vector<MotionStep>> readMotionSteps(const MeshDocument &document, const MeshModel &layer,
                                                       const QString &text) {
    return vcg::fcd::ReadMotionText(withLayers(text, document, layer).toStdString());
}

bool readMotions(const MeshDocument &document, const MeshModel &layer, const Point3m *rest, const HandleParam &param,
                 const std::map<Index, Eigen::Vector3d> &centers, const Remark &remark, Handles &handles) {
    const CMeshO &mesh = layer.cm;
    std::vector<Eigen::Matrix4d> listed;
    if (!param.transformFile.isEmpty())
        listed = vcg::fcd::ReadTransformFile(pathOf(param.transformFile), mostBytes(layer, 1000));

    const std::map<int, std::vector<MotionStep>> told = readMotionSteps(document, layer, param.transforms);
    for (const auto &clause : told)
        if (!centers.count(clause.first)) {
            const std::string tag = std::to_string(clause.first);
            throw Error("transforms moves handle " + tag + ", but no vertex has tag " + tag + "; " +
                        (centers.empty()       ? "the handles are points."
                         : centers.size() == 1 ? "the only handle is " + listOfKeys(centers) + "."
                                               : "the handles are " + listOfKeys(centers) + "."));
        }

    bool moves = false, aboutPoint = false;
    for (const auto &[tag, center] : centers) {
        const std::size_t place = std::size_t(tag) - 2;
        const Eigen::Vector3d barycenter = handles.world * center;
        Motion world;
        if (const auto clause = told.find(tag); clause != told.end()) {
            try {
                world = vcg::fcd::ToMotion(clause->second, barycenter);
            } catch (const Error &e) {
                throw Error("transforms, handle " + std::to_string(tag) + ": " + e.what());
            }
        } else if (place < listed.size()) {
            if (!listed[place].allFinite() || listed[place].row(3) != Eigen::RowVector4d(0, 0, 0, 1))
                throw Error(param.transformFile.toStdString() + ": the matrix of handle " + std::to_string(tag) +
                            " is not affine. Its last row must be 0 0 0 1 and all its entries finite numbers.");
            world = Motion(listed[place]);
        } else {
            world = vcg::fcd::ToMotion(stepsOf(param, layer), barycenter);
            aboutPoint = param.rotationAngle != 0 && param.rotationCenter == HandleParam::Point;
            if (!told.empty() && listed.empty())
                remark("Handle " + std::to_string(tag) + " is not in transforms: " +
                       (world.matrix.isIdentity(0) && world.turn.isZero(0)
                            ? "it stays where it is."
                            : "translation, rotation and matrix of the dialog move it."));
            if (!listed.empty())
                remark("Handle " + std::to_string(tag) + " has no matrix in " + param.transformFile.toStdString() +
                       ": translation, rotation and matrix of the dialog move it.");
        }
        moves = moves || !world.matrix.isIdentity(0) || !world.turn.isZero(0);
        handles.motion[tag] = world;
    }

    for (std::size_t place = 0; place < listed.size(); ++place)
        if (!centers.count(int(place) + 2))
            remark("No vertex has tag " + std::to_string(place + 2) + ": its matrix in " +
                   param.transformFile.toStdString() + " is not used.");
    if (const double error = aboutPoint ? singleError(param.rotationPoint) : 0;
        error > 0 && error > 1e-5 * (handles.world.linear() * extentOf(mesh)).norm())
        remark(inWords(
            "rotation_point reaches the filter in single precision, which far from the origin is coarse: ", error,
            " units there. For an exact centre write the rotation as text in 'transforms': ", centers.begin()->first,
            ": rotate ax ay az degrees about x y z."));
    for (const vcg::fcd::PointHandle &point : handles.point)
        moves = moves || point.target != toVector(rest ? rest[point.vertex] : mesh.vert[point.vertex].cP());
    if (!moves && !(centers.empty() && handles.point.empty()))
        remark("No handle moves: all motions lead to where the handles are already. Give other motions.");
    return moves;
}
