// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // before Qt

#include "handle_sources.h"
#include "kept_tool.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "measured_quality.h"
#include "point_sources.h"
#include "weight_sources.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include <QRegularExpression>

using vcg::fcd::Error;
using vcg::fcd::Handles;
using vcg::fcd::Index;
using vcg::fcd::Motion;
using vcg::fcd::MotionStep;

namespace {

/// The meaning of the tags, for messages.
const char *const tagMeaning = "0 = fixed, 1 = free, 2, 3, ... = handles, negative = outside";

/// Tags from the numbers of(slot). \param what name of the numbers, for messages
template <class NumberOf>
std::vector<int> tagsFrom(const MeshModel &layer, const std::string &what, const NumberOf &of) {
    const CMeshO &mesh = layer.cm;
    std::vector<int> tag(mesh.vert.size(), 1);
    std::atomic<std::size_t> wrong{tag.size()}; // the first one
    forVertices(mesh, [&](std::size_t i) {
        const double number = of(i), whole = std::round(number);
        // The tolerance is for files that store numbers as text.
        if (std::abs(number - whole) <= 1e-6 && whole >= std::numeric_limits<int>::lowest() &&
            whole <= std::numeric_limits<int>::max())
            tag[i] = int(whole);
        else
            for (std::size_t first = wrong; i < first && !wrong.compare_exchange_weak(first, i);) {
            }
    });
    if (const std::size_t i = wrong; i < tag.size())
        throw Error(inWords("The ", what, " of vertex ", i, " is ", of(i), ", but tags are whole numbers: ", tagMeaning,
                            ". Round them, or take the tags from another source."));
    return tag;
}

std::vector<int> tagsFromQuality(const MeshModel &layer, bool freeIfNone, bool mayLack) {
    const CMeshO &mesh = layer.cm;
    if (hasMarks(layer))
        return marksOf(layer);
    if (mayLack && !mayHaveTags(layer))
        return std::vector<int>(mesh.vert.size(), 1);
    std::vector<int> tag = tagsFrom(layer, "quality", [&](std::size_t i) { return double(mesh.vert[i].cQ()); });
    bool tagged = false;
    for (std::size_t i = 0; i < tag.size() && !tagged; ++i)
        tagged = tag[i] != 0 && !mesh.vert[i].IsD();
    if (!tagged && freeIfNone)
        return std::vector<int>(mesh.vert.size(), 1);
    if (!tagged)
        throw Error(std::string("No handle: the vertex quality of this layer is 0 everywhere: nobody has tagged the "
                                "vertices yet. Set the quality to a tag per vertex (") +
                    tagMeaning +
                    "), for example with 'FCD: Tag' (compute_fcd_tags) or 'Per Vertex Quality "
                    "Function' (compute_scalar_by_function_per_vertex), or select the "
                    "handle and choose 'Selection' (1), an attribute (2) or files (3) as 'handles'.");
    return tag;
}

std::vector<int> tagsFromSelection(const MeshModel &layer, bool freeIfNone) {
    const CMeshO &mesh = layer.cm;
    const std::vector<char> onFaces = onSelectedFaces(layer);
    std::vector<int> tag(mesh.vert.size(), 1);
    bool handle = false;
    for (std::size_t i = 0; i < tag.size(); ++i) {
        if (onFaces[i])
            tag[i] = 0;
        if (!mesh.vert[i].IsD() && mesh.vert[i].IsS()) {
            tag[i] = 2;
            handle = true;
        }
    }
    if (!handle && !freeIfNone)
        throw Error(
            "No handle: no vertex is selected. Select the vertices of the handle, and the faces of what stays fixed, "
            "or choose another source with 'handles'.");
    return tag;
}

std::vector<int> tagsFromAttribute(const MeshModel &layer, const QString &name) {
    return tagsFrom(layer, "attribute '" + name.toStdString() + "'",
                    attributeNumbers(layer, name,
                                     std::string("with a tag per vertex (") + tagMeaning +
                                         "), or give its name as 'tag_attribute'"));
}

std::vector<int> tagsFromFile(const MeshModel &layer, const QString &path) {
    const CMeshO &mesh = layer.cm;
    const std::vector<int> listed = vcg::fcd::ReadTagFile(pathOf(path), mostBytes(layer, 100));
    if (listed.size() != std::size_t(mesh.vn))
        throw Error(path.toStdString() + " has " + std::to_string(listed.size()) + " tags, but the layer " +
                    inQuotes(layer) + " has " + std::to_string(mesh.vn) +
                    " vertices. It must list one tag per vertex of this very mesh, in the order of the vertices.");
    std::vector<int> tag(mesh.vert.size(), 1);
    std::size_t next = 0;
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (!mesh.vert[i].IsD())
            tag[i] = listed[next++];
    return tag;
}

/// Says how many vertices are fixed by a quality of 0 that no filter for tags gave: others make new vertices with it.
void tellNewFixed(const MeshModel &layer, const std::vector<int> &tag, const Remark &remark) {
    const LayerState &state = LayerState::known(layer);
    const bool isTagged = state.scan && state.scan->quality, isResult = state.measured && state.measured->areTags;
    if (!remark || (!isTagged && !isResult) || hasMarks(layer))
        return;
    const auto isNew = [&](std::size_t i) {
        return isTagged ? state.scan->number[i] == 0 : state.measured->number[i] == 0;
    };
    if (const auto count = sumOfVertices(layer.cm, [&](std::size_t i) { return isNew(i) && tag[i] == 0; }))
        remark(counted(count, "vertex is", "vertices are") + " new since " + inQuotes(layer) +
               (isTagged ? " was tagged" : " was made") +
               ", and fixed, since their quality is 0. If that is wrong, tag them: 1 is free.");
}

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
    return result + steps.mid(end);
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

bool mayHaveTags(const MeshModel &layer) {
    if (hasMarks(layer))
        return true;
    return hasQuality(layer) && !isMeasured(layer) &&
           std::all_of(layer.cm.vert.begin(), layer.cm.vert.end(),
                       [](const CVertexO &vertex) { return vertex.IsD() || vertex.cQ() == std::round(vertex.cQ()); });
}

std::vector<int> readTags(const MeshModel &layer, const HandleParam &param) {
    if (param.allFree)
        return std::vector<int>(layer.cm.vert.size(), 1);
    const bool freeIfNone = param.mayLack || !param.pointFile.isEmpty();
    switch (param.source) {
    case HandleParam::Quality: return tagsFromQuality(layer, freeIfNone, param.mayLack);
    case HandleParam::Selection: return tagsFromSelection(layer, freeIfNone);
    case HandleParam::Attribute: return tagsFromAttribute(layer, param.tagAttribute);
    case HandleParam::Files:
        if (freeIfNone && param.tagFile.isEmpty())
            return std::vector<int>(layer.cm.vert.size(), 1);
        return tagsFromFile(layer, param.tagFile);
    case HandleParam::Known:
        return hasTags(layer) ? tagsFromQuality(layer, freeIfNone, true) : std::vector<int>(layer.cm.vert.size(), 1);
    }
    throw Error("Unknown source of tags.");
}

Handles readHandles(const MeshModel &layer, const Point3m *rest, const HandleParam &param, const Remark &remark) {
    Handles handles;
    handles.tag = readTags(layer, param);
    if (!param.allFree && (param.source == HandleParam::Quality || param.source == HandleParam::Known))
        tellNewFixed(layer, handles.tag, remark);
    handles.world = invertibleMatrixOf(layer);
    if (!param.pointFile.isEmpty())
        handles.point = readPointHandles(layer, rest, param.pointFile, {}, remark);
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
