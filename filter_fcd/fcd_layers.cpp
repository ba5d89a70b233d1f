// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // these before Qt
#include <vcg_ext/handle_file.h>
#include <vcg_ext/motion_text.h>

#include "fcd_aside.h"
#include "fcd_layers.h"
#include "fcd_mesh_copy.h"
#include "fcd_normals.h"
#include "fcd_points.h"
#include "fcd_rest.h"

#include <vcg/complex/allocate.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <typeindex>

#include <QFile>
#include <QRegularExpression>

using vcg::fcd::Error;
using vcg::fcd::Handles;
using vcg::fcd::Index;
using vcg::fcd::Motion;
using vcg::fcd::MotionStep;

namespace {

std::string text(const QString &s) { return s.toStdString(); }

// --- tags ---

/// The meaning of the tags, for messages.
const char *const tagMeaning = "0 = fixed, 1 = free, 2, 3, ... = handles, negative = outside";

/// Tags from a number per slot, where \p of(slot) gives the number. \p what names the numbers in messages.
template <class NumberOf>
std::vector<int> tagsFrom(const MeshModel &layer, const std::string &what, const NumberOf &of) {
    const CMeshO &mesh = layer.cm;
    std::vector<int> tag(mesh.vert.size(), 1);
    const auto wholeOf = [](double number, double &whole) {
        whole = std::round(number);
        // The tolerance is for files that store numbers as text.
        return std::abs(number - whole) <= 1e-6 && whole >= std::numeric_limits<int>::lowest() &&
               whole <= std::numeric_limits<int>::max();
    };
    std::atomic<bool> isGood{true};
    vcg::fcd::ParallelFor(0, tag.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        double whole = 0;
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD()) {
                if (!wholeOf(of(i), whole))
                    isGood = false;
                else
                    tag[i] = int(whole);
            }
    });
    for (std::size_t i = 0; i < tag.size() && !isGood; ++i)
        if (double whole = 0; !mesh.vert[i].IsD() && !wholeOf(of(i), whole)) {
            std::ostringstream message;
            message << "The " << what << " of vertex " << i << " is " << of(i)
                    << ", but tags are whole numbers: " << tagMeaning
                    << ". Round them, or take the tags from another source.";
            throw Error(message.str());
        }
    return tag;
}

std::vector<int> tagsFromQuality(const MeshModel &layer, bool freeIfNone) {
    const CMeshO &mesh = layer.cm;
    const bool tagged = hasQuality(layer);
    if (!tagged && freeIfNone)
        return std::vector<int>(mesh.vert.size(), 1);
    if (!tagged)
        throw Error(std::string("No handle: the vertex quality of this layer is 0 everywhere, so nobody has tagged the "
                                "vertices yet. Set the quality to a tag per vertex (") +
                    tagMeaning +
                    "), for example with 'FCD: Tag Selection' (compute_fcd_tags_from_selection) or 'Per Vertex Quality "
                    "Function' (compute_scalar_by_function_per_vertex), or select the "
                    "handle and choose 'Selection' (1), an attribute (2) or files (3) as 'handles'.");
    return tagsFrom(layer, "quality", [&](std::size_t i) { return double(mesh.vert[i].cQ()); });
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
    const CMeshO &mesh = layer.cm;
    std::string others;
    for (const vcg::PointerToAttribute &attribute : mesh.vert_attr) {
        if (attribute._name != text(name)) {
            if (!attribute._name.empty())
                others += (others.empty() ? " It has: " : ", ") + attribute._name;
            continue;
        }
        // The handle's own index, not its operator[]: that one refers to the container the attribute was made for.
        const vcg::SimpleTempDataBase *data = attribute._handle;
        const std::string what = "attribute '" + text(name) + "'";
        if (attribute._type == typeid(float))
            return tagsFrom(layer, what,
                            [&](std::size_t i) { return double(*static_cast<const float *>(data->At(i))); });
        if (attribute._type == typeid(double))
            return tagsFrom(layer, what, [&](std::size_t i) { return *static_cast<const double *>(data->At(i)); });
        if (attribute._type == typeid(int))
            return tagsFrom(layer, what, [&](std::size_t i) { return double(*static_cast<const int *>(data->At(i))); });
        throw Error("The vertex attribute '" + text(name) +
                    "' does not hold one number per vertex. Use a scalar attribute (float, double or int).");
    }
    throw Error("This layer has no vertex attribute '" + text(name) +
                "'. Add a scalar attribute of that name with a tag per vertex (" + tagMeaning +
                "), or give its name as 'tag_attribute'." +
                (others.empty() ? " It has no attributes at all." : others + "."));
}

std::vector<int> tagsFromFile(const MeshModel &layer, const QString &path) {
    const CMeshO &mesh = layer.cm;
    const std::vector<int> listed = vcg::fcd::ReadTagFile(QFile::encodeName(path).toStdString(), mostBytes(layer, 100));
    if (listed.size() != std::size_t(mesh.vn))
        throw Error(text(path) + " has " + std::to_string(listed.size()) + " tags, but the layer '" +
                    text(layer.label()) + "' has " + std::to_string(mesh.vn) +
                    " vertices. It must list one tag per vertex of this very mesh, in the order of the vertices.");
    std::vector<int> tag(mesh.vert.size(), 1);
    std::size_t next = 0;
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (!mesh.vert[i].IsD())
            tag[i] = listed[next++];
    return tag;
}

// --- motions ---

/// The motion from where \p layer lies to where \p other does.
Eigen::Matrix4d motionTo(const MeshModel &other, const MeshModel &layer) {
    return (matrixOf(other) * invertibleMatrixOf(layer).inverse()).matrix();
}

/// The motion of the handles of \p layer that the parameters of the dialog describe.
std::vector<MotionStep> stepsOf(const HandleParam &param, const MeshModel &layer) {
    std::vector<MotionStep> steps;
    if (param.likeLayer && param.likeLayer != &layer) {
        steps.push_back(MotionStep::Affine(motionTo(*param.likeLayer, layer)));
        try {
            vcg::fcd::ToMotion(steps, Eigen::Vector3d::Zero());
        } catch (const Error &e) {
            throw Error("The handles cannot move like the layer '" + text(param.likeLayer->label()) + "': " + e.what());
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

/// How far single precision may have moved \p point; 0 where it has more digits than that.
double singleError(const Eigen::Vector3d &point) {
    if (point.cast<float>().cast<double>() != point)
        return 0;
    return point.cwiseAbs().maxCoeff() * std::numeric_limits<float>::epsilon() / 2;
}

/// \p steps with each "layer 'NAME'" written as the matrix that leads from \p layer to the layer of that name.
QString withLayers(const QString &steps, const MeshDocument &document, const MeshModel &layer) {
    static const char *const pattern = "\\blayer\\s*(?:'([^']*)'|\"([^\"]*)\")";
    const QRegularExpression step(pattern, QRegularExpression::CaseInsensitiveOption);
    QString result;
    int end = 0;
    for (QRegularExpressionMatchIterator i = step.globalMatch(steps); i.hasNext();) {
        const QRegularExpressionMatch match = i.next();
        const QString name = match.captured(1) + match.captured(2);
        const MeshModel *found = nullptr;
        for (const MeshModel *other : host::layers(document))
            if (other->label() == name)
                found = other;
        if (!found)
            throw Error("transforms names the layer '" + text(name) +
                        "', but no layer has that name. Write the name as the list of layers shows it.");
        const Eigen::Matrix4d matrix = motionTo(*found, layer);
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

/// "2, 3 and 7", cut short when there are very many.
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

Eigen::Affine3d matrixOf(const MeshModel &layer) {
    Eigen::Matrix4d matrix;
    layer.cm.Tr.ToEigenMatrix(matrix);
    const std::string name = "The matrix of the layer '" + text(layer.label()) + "' ";
    if (!matrix.allFinite())
        throw Error(name + "holds a number that is not finite. Reset the matrix.");
    if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw Error(name + "is a projection: its last row is not 0 0 0 1. Reset the matrix.");
    return Eigen::Affine3d(matrix);
}

namespace {

bool isInvertible(const Eigen::Matrix3d &linear) {
    return linear.allFinite() && Eigen::FullPivLU<Eigen::Matrix3d>(linear).isInvertible() &&
           std::isnormal(linear.determinant()); // not beyond the range of numbers
}

} // namespace

Eigen::Matrix3d metricOf(const MeshModel &layer) {
    Eigen::Matrix4d matrix;
    layer.cm.Tr.ToEigenMatrix(matrix);
    const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
    return isInvertible(linear) ? linear : Eigen::Matrix3d::Identity();
}

Eigen::Affine3d invertibleMatrixOf(const MeshModel &layer) {
    const Eigen::Affine3d matrix = matrixOf(layer);
    if (!isInvertible(matrix.linear()))
        throw Error("The matrix of the layer '" + text(layer.label()) +
                    "' cannot be inverted, so its world coordinates have no way back. Reset the matrix, or freeze it.");
    return matrix;
}

Eigen::Matrix3Xd positionsOf(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    Eigen::Matrix3Xd position(3, Eigen::Index(mesh.vert.size()));
    vcg::fcd::ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            position.col(Eigen::Index(i)) = vcg::tri::PositionOf(mesh.vert[i]);
    });
    return position;
}

std::size_t mostBytes(const MeshModel &layer, std::size_t each) { return 1000000 + each * std::size_t(layer.cm.vn); }

std::vector<char> onSelectedFaces(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    std::vector<char> on(mesh.vert.size(), 0);
    for (const CFaceO &face : mesh.face)
        if (!face.IsD() && face.IsS())
            for (int k = 0; k < 3; ++k)
                on[vcg::tri::Index(mesh, face.cV(k))] = 1;
    return on;
}

bool hasQuality(const MeshModel &layer) {
    return layer.hasDataMask(MeshModel::MM_VERTQUALITY) &&
           std::any_of(layer.cm.vert.begin(), layer.cm.vert.end(),
                       [](const CVertexO &vertex) { return !vertex.IsD() && vertex.cQ() != 0; });
}

bool mayHaveTags(const MeshModel &layer) {
    return hasQuality(layer) && std::all_of(layer.cm.vert.begin(), layer.cm.vert.end(), [](const CVertexO &vertex) {
               return vertex.IsD() || vertex.cQ() == std::round(vertex.cQ());
           });
}

std::vector<int> readTags(const MeshModel &layer, const HandleParam &param) {
    const bool freeIfNone = !param.pointFile.isEmpty();
    switch (param.source) {
    case HandleParam::Quality: return tagsFromQuality(layer, freeIfNone);
    case HandleParam::Selection: return tagsFromSelection(layer, freeIfNone);
    case HandleParam::Attribute: return tagsFromAttribute(layer, param.tagAttribute);
    case HandleParam::Files:
        if (freeIfNone && param.tagFile.isEmpty())
            return std::vector<int>(layer.cm.vert.size(), 1);
        return tagsFromFile(layer, param.tagFile);
    }
    throw Error("Unknown source of tags.");
}

Handles readHandles(const MeshModel &layer, const HandleParam &param) {
    Handles handles;
    handles.tag = readTags(layer, param);
    handles.world = invertibleMatrixOf(layer);
    if (!param.pointFile.isEmpty())
        handles.point = readPointHandles(layer, param.pointFile);
    return handles;
}

bool readMotions(const MeshDocument &document, const MeshModel &layer, const HandleParam &param,
                 const std::map<Index, Eigen::Vector3d> &centers, const Remark &remark, Handles &handles) {
    const CMeshO &mesh = layer.cm;
    std::vector<Eigen::Matrix4d> listed;
    if (!param.transformFile.isEmpty())
        listed =
            vcg::fcd::ReadTransformFile(QFile::encodeName(param.transformFile).toStdString(), mostBytes(layer, 1000));

    const std::map<int, std::vector<MotionStep>> told =
        vcg::fcd::ReadMotionText(text(withLayers(param.transforms, document, layer)));
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
                throw Error(text(param.transformFile) + ": the matrix of handle " + std::to_string(tag) +
                            " is not affine. Its last row must be 0 0 0 1 and all its entries finite numbers.");
            world = Motion(listed[place]);
        } else {
            world = vcg::fcd::ToMotion(stepsOf(param, layer), barycenter);
            aboutPoint = param.rotationAngle != 0 && param.rotationCenter == HandleParam::Point;
            if (!told.empty() && listed.empty())
                remark("Handle " + std::to_string(tag) +
                       " is not in transforms: translation, rotation and matrix of the dialog move it.");
            if (!listed.empty())
                remark("Handle " + std::to_string(tag) + " has no matrix in " + text(param.transformFile) +
                       ": translation, rotation and matrix of the dialog move it.");
        }
        moves = moves || !world.matrix.isIdentity(0) || !world.turn.isZero(0);
        handles.motion[tag] = world;
    }

    for (std::size_t place = 0; place < listed.size(); ++place)
        if (!centers.count(int(place) + 2))
            remark("No vertex has tag " + std::to_string(place + 2) + ": its matrix in " + text(param.transformFile) +
                   " is not used.");
    if (const double error = aboutPoint ? singleError(param.rotationPoint) : 0;
        error > 0 && error > 1e-5 * (handles.world.linear() * extentOf(mesh)).norm()) {
        std::ostringstream line;
        line << "rotation_point reaches the filter in single precision, which far from the origin is coarse: " << error
             << " units there. For an exact centre write the rotation as text in 'transforms': "
             << centers.begin()->first << ": rotate ax ay az degrees about x y z.";
        remark(line.str());
    }
    for (const vcg::fcd::PointHandle &point : handles.point)
        moves = moves || point.target != vcg::tri::PositionOf(mesh.vert[point.vertex]);
    if (!moves && !(centers.empty() && handles.point.empty()))
        remark("No handle moves: nothing that was given leads them away from where they are.");
    return moves;
}

bool isGraph(const MeshModel &layer) {
    Scalarm least = 0, greatest = 0;
    for (const CVertexO &vertex : layer.cm.vert)
        if (!vertex.IsD()) {
            least = std::min(least, Scalarm(vertex.cQ()));
            greatest = std::max(greatest, Scalarm(vertex.cQ()));
        }
    return layer.cm.fn == 0 && least == 0 && greatest > 0;
}

Eigen::Matrix3Xd readNodes(const MeshModel &layer, const MeshModel *graph) {
    if (!graph)
        throw Error(
            "'graph_layer' names no layer of this document. Choose the layer whose vertices are the nodes, or untick "
            "'use_graph_layer'.");
    if (graph == &layer)
        throw Error(
            "'graph_layer' is the layer to deform itself. Choose the layer whose vertices are the nodes (one that "
            "'FCD: Build Deformation Graph' made, for example), or untick 'use_graph_layer'.");
    if (graph->cm.vn == 0)
        throw Error("The graph layer '" + text(graph->label()) +
                    "' has no vertices, so there are no nodes. Choose another "
                    "layer, or untick 'use_graph_layer'.");
    const Eigen::Affine3d from = matrixOf(*graph), to = invertibleMatrixOf(layer);
    const bool same = from.matrix() == to.matrix();
    const Eigen::Affine3d change = to.inverse() * from;
    Eigen::Matrix3Xd nodes(3, graph->cm.vn);
    Eigen::Index next = 0;
    for (const CVertexO &vertex : graph->cm.vert)
        if (!vertex.IsD()) {
            const Eigen::Vector3d position = vcg::tri::PositionOf(vertex);
            nodes.col(next++) = same ? position : change * position;
        }
    return nodes;
}

// --- new layers ---

namespace {

/// The label without what is, or looks like, the extension of a file.
QString nameOf(const MeshModel &layer) {
    QString name = layer.label().trimmed();
    name.remove(QRegularExpression("\\.[A-Za-z][A-Za-z0-9]{0,4}$"));
    return name.isEmpty() ? QString("mesh") : name;
}

/// "NAME what"; "NAME what 2" where \p base is "NAME deformed", and so on.
QString labelOf(const MeshModel &base, const QString &what) {
    const QString name = nameOf(base);
    const QRegularExpressionMatch result =
        QRegularExpression("^(.+) deformed(?: (\\d{1,6}))?(?:\\(\\d+\\))?$").match(name);
    if (!result.hasMatch())
        return name + " " + what;
    const int times = result.captured(2).isEmpty() ? 1 : result.captured(2).toInt();
    return QString("%1 %2 %3").arg(result.captured(1), what).arg(times + 1);
}

/// \p label, or "LABEL(n)" where a layer that is not among \p but has it. MeshLab does so too, but takes a dot for the
/// beginning of an extension.
QString unusedLabel(const MeshDocument &document, const QString &label, const std::vector<MeshModel *> &but) {
    const std::vector<const MeshModel *> layers = host::layers(document);
    for (int n = 0;; ++n) {
        const QString tried = n ? QString("%1(%2)").arg(label).arg(n) : label;
        bool taken = false;
        for (const MeshModel *layer : layers)
            taken = taken || (layer->label() == tried && std::find(but.begin(), but.end(), layer) == but.end());
        if (!taken)
            return tried;
    }
}

/// Makes attributes in a mesh, by the type of their values.
struct AttributeMakers {
    using Make = void (*)(CMeshO &, const std::string &);
    std::map<std::type_index, Make> vertex, face;

    AttributeMakers() {
        add<bool, char, signed char, unsigned char, short, unsigned short, int, unsigned, long, unsigned long,
            long long, unsigned long long, float, double>();
        add<vcg::Point2f, vcg::Point2d, vcg::Point2i, vcg::Point3f, vcg::Point3d, vcg::Point3i, vcg::Point4f,
            vcg::Point4d, vcg::Color4b, vcg::Color4f, vcg::Matrix33f, vcg::Matrix33d, vcg::Matrix44f, vcg::Matrix44d,
            std::string>();
    }

  private:
    template <class... Types>
    void add() {
        (vertex.emplace(typeid(Types),
                        [](CMeshO &mesh, const std::string &name) {
                            vcg::tri::Allocator<CMeshO>::template AddPerVertexAttribute<Types>(mesh, name);
                        }),
         ...);
        (face.emplace(typeid(Types),
                      [](CMeshO &mesh, const std::string &name) {
                          vcg::tri::Allocator<CMeshO>::template AddPerFaceAttribute<Types>(mesh, name);
                      }),
         ...);
    }
};

/// Adds to \p to, empty, the attributes of \p from, without values. Tells about those of types that are not known.
void addAttributes(CMeshO &to, const CMeshO &from, const Remark &remark) {
    const AttributeMakers makers;
    const auto add = [&](const auto &attributes, const auto &makersOfKind, const char *kind) {
        for (const vcg::PointerToAttribute &attribute : attributes) {
            if (attribute._name.empty() || isOfRest(attribute._name) || isAside(attribute._name))
                continue; // scratch data of some algorithm, or what belongs to the layer alone
            const auto maker = makersOfKind.find(attribute._type);
            if (maker == makersOfKind.end())
                remark(std::string("The ") + kind + " attribute '" + attribute._name +
                       "' has values of an unknown type; the new layer does not have it.");
            else
                maker->second(to, attribute._name);
        }
    };
    add(from.vert_attr, makers.vertex, "vertex");
    add(from.face_attr, makers.face, "face");
}

} // namespace

NewLayers::NewLayers(MeshDocument &document, const MeshModel &base, const Remark &remark,
                     std::vector<MeshModel *> replaced)
    : document(document), base(base), remark(remark), replaced(std::move(replaced)) {}

NewLayers::~NewLayers() {
    if (kept)
        return;
    for (auto layer = added.rbegin(); layer != added.rend(); ++layer)
        host::removeLayer(document, *layer);
    if (!added.empty() && document.mm() != &base)
        document.setCurrentMesh(base.id());
}

void NewLayers::keep(const MeshModel &current) {
    kept = true;
    for (MeshModel *layer : replaced)
        host::removeLayer(document, layer);
    document.setCurrentMesh(current.id());         // last: removing a layer may make another one the current
    for (std::size_t i = 0; i < added.size(); ++i) // the host has changed those that were taken
        added[i]->setLabel(labels[i]);
}

MeshModel &NewLayers::add(const QString &what) {
    const QString label = unusedLabel(document, labelOf(base, what), replaced);
    labels.push_back(label);
    added.reserve(added.size() + 1); // nothing can fail between adding and remembering
    MeshModel *layer = document.addNewMesh("", label, false);
    added.push_back(layer);
    layer->cm.Tr = base.cm.Tr;
    return *layer;
}

MeshModel &NewLayers::addCopy(const QString &what, int withoutElements, const Eigen::Matrix3Xd *position) {
    // Adjacencies are not copied; whoever needs them computes them.
    const int elements = base.dataMask() & ~(MeshModel::MM_FACEFACETOPO | MeshModel::MM_VERTFACETOPO | withoutElements);
    MeshModel &layer = add(what);
    CMeshO &to = layer.cm;
    const CMeshO &from = base.cm;
    layer.updateDataMask(elements);
    addAttributes(to, from, remark);
    copyElements(to, from, position);
    to.sfn = from.sfn;
    to.svn = from.svn;
    to.pvn = from.pvn;
    to.pfn = from.pfn;
    to.shot = from.shot;
    to.imark = from.imark;
    if (!position)
        to.bbox = from.bbox;
    bringBackTo(layer, base);
    if (withoutElements & MeshModel::MM_WEDGTEXCOORD) {
        to.textures.clear();
    } else {
        to.normalmaps = from.normalmaps;
        host::copyTextures(layer, base);
    }
    return layer;
}

MeshModel &NewLayers::addDeformed(const QString &what, const Eigen::Matrix3Xd &position,
                                  const std::vector<Eigen::Matrix3f> &linear, const std::vector<float> &quality) {
    MeshModel &layer = addCopy(what, MeshModel::MM_NONE, &position);
    const Packing packing(base.cm.vert, base.cm.vn);
    if (!quality.empty()) {
        layer.updateDataMask(MeshModel::MM_VERTQUALITY);
        packing.forEach(
            [&](std::size_t i, std::size_t j) { layer.cm.vert[j].Q() = CVertexO::QualityType(quality[i]); });
    }
    computeNormals(layer.cm);
    if (linear.empty())
        return layer;
    const bool ownNormals = hasOwnNormals(base), directions = base.hasDataMask(MeshModel::MM_VERTCURVDIR);
    const auto turn = [](const Eigen::Matrix3d &map, auto &v) {
        const Eigen::Vector3d turned = (map * Eigen::Vector3d(v[0], v[1], v[2])).stableNormalized();
        for (int d = 0; d < 3; ++d)
            v[d] = turned[d];
    };
    packing.forEach([&](std::size_t i, std::size_t j) {
        CVertexO &vertex = layer.cm.vert[j];
        const Eigen::Matrix3d map = linear[i].cast<double>();
        if (ownNormals) {
            vertex.N() = base.cm.vert[i].cN();
            turn(vcg::fcd::Cofactors(map), vertex.N());
        }
        if (directions) {
            turn(map, vertex.PD1());
            turn(map, vertex.PD2());
        }
    });
    return layer;
}

bool hasDirections(const MeshModel &layer) {
    return layer.hasDataMask(MeshModel::MM_VERTCURVDIR) || hasOwnNormals(layer);
}

MeshModel &NewLayers::addPatches(const QString &what, const std::vector<Index> &patchOf,
                                 const std::vector<vcg::Color4b> &color) {
    MeshModel &layer = addCopy(what, MeshModel::MM_WEDGTEXCOORD | MeshModel::MM_VERTTEXCOORD | MeshModel::MM_FACECOLOR);
    layer.updateDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY |
                         (base.cm.fn > 0 ? MeshModel::MM_FACECOLOR : MeshModel::MM_NONE));
    Packing(base.cm.vert, base.cm.vn).forEach([&](std::size_t i, std::size_t j) {
        CVertexO &vertex = layer.cm.vert[j];
        const Index patch = patchOf[i];
        vertex.Q() = CVertexO::QualityType(patch);
        vertex.C() = patch >= 0 ? color[std::size_t(patch)] : vcg::Color4b(vcg::Color4b::Gray);
    });
    // A face has one colour, so that borders of patches are sharp: that of two of its vertices, if two are of one
    // patch.
    for (CFaceO &face : layer.cm.face)
        face.C() = face.cV(1)->cQ() == face.cV(2)->cQ() ? face.cV(1)->cC() : face.cV(0)->cC();
    return layer;
}

MeshModel &NewLayers::addGraphSurface(const QString &what, const vcg::fcd::GraphGeometry &graph) {
    // Thick enough to stand out of the surface, thin enough not to cover the patches.
    const double ball = 0.2, tube = 0.07; // of the mean radius of the patches
    const double radius = graph.radius.size() > 0 ? graph.radius.mean() : 0;
    const int around = 8, along = 6; // corners of a ring; rings of a ball from pole to pole
    const std::size_t nodes = std::size_t(graph.position.cols()), edges = graph.edge.size();

    MeshModel &layer = add(what);
    CMeshO &mesh = layer.cm;
    layer.updateDataMask(MeshModel::MM_VERTCOLOR);
    auto vertex = vcg::tri::Allocator<CMeshO>::AddVertices(mesh, std::size_t(around) *
                                                                     (2 * edges + std::size_t(along + 1) * nodes));
    auto face =
        vcg::tri::Allocator<CMeshO>::AddFaces(mesh, std::size_t(2 * around) * (edges + std::size_t(along) * nodes));
    // Rings about the line through centre along axis, at heights and with radii as given, joined to the next one.
    const auto addRings = [&](const Eigen::Vector3d &center, const Eigen::Vector3d &axis, int rings, const auto &at,
                              const vcg::Color4b &color) {
        const Eigen::Vector3d u = axis.unitOrthogonal(), v = axis.cross(u);
        for (int r = 0; r < rings; ++r)
            for (int k = 0; k < around; ++k) {
                const double angle = 2 * double(EIGEN_PI) * k / around;
                const auto [height, width] = at(r);
                vertex->P() = toPoint(center + height * axis + width * (std::cos(angle) * u + std::sin(angle) * v));
                vertex->C() = color;
                if (r + 1 < rings) {
                    const int next = (k + 1) % around - k;
                    CVertexO *low = &*vertex, *right = low + next;
                    CVertexO *const corners[2][3] = {{low, right, right + around}, {low, right + around, low + around}};
                    for (const auto &corner : corners) {
                        for (int c = 0; c < 3; ++c)
                            face->V(c) = corner[c];
                        ++face;
                    }
                }
                ++vertex;
            }
    };
    for (const auto &ends : graph.edge) {
        const Eigen::Vector3d from = graph.position.col(ends[0]), way = graph.position.col(ends[1]) - from;
        const double length = way.norm();
        addRings(
            from, length > 0 ? Eigen::Vector3d(way / length) : Eigen::Vector3d::UnitZ(), 2,
            [&](int r) { return std::pair<double, double>(r * length, tube * radius); }, vcg::Color4b(60, 60, 60, 255));
    }
    for (std::size_t i = 0; i < nodes; ++i)
        addRings(
            graph.position.col(Eigen::Index(i)), Eigen::Vector3d::UnitZ(), along + 1,
            [&](int r) {
                const double angle = double(EIGEN_PI) * r / along;
                return std::pair<double, double>(-ball * radius * std::cos(angle), ball * radius * std::sin(angle));
            },
            graph.color[i]);
    computeBoxAndNormals(layer.cm);
    return layer;
}

MeshModel &NewLayers::addGraph(const QString &what, const vcg::fcd::GraphGeometry &graph) {
    MeshModel &layer = add(what);
    CMeshO &mesh = layer.cm;
    layer.updateDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY);
    vcg::tri::Allocator<CMeshO>::AddVertices(mesh, std::size_t(graph.position.cols()));
    for (Eigen::Index i = 0; i < graph.position.cols(); ++i) {
        CVertexO &vertex = mesh.vert[std::size_t(i)];
        vertex.P() = toPoint(graph.position.col(i));
        vertex.N() = toPoint(graph.normal.col(i)).Normalize(); // without a normal, MeshLab draws it black
        vertex.Q() = CVertexO::QualityType(graph.radius[i]);
        vertex.C() = graph.color[std::size_t(i)];
    }
    if (graph.energy.size() > 0) {
        auto energy = vcg::tri::Allocator<CMeshO>::AddPerVertexAttribute<Scalarm>(mesh, "energy");
        for (Eigen::Index i = 0; i < graph.energy.size(); ++i)
            energy[std::size_t(i)] = Scalarm(graph.energy[i]);
    }
    auto edge = vcg::tri::Allocator<CMeshO>::AddEdges(mesh, graph.edge.size());
    for (const auto &ends : graph.edge) {
        edge->V(0) = &mesh.vert[std::size_t(ends[0])];
        edge->V(1) = &mesh.vert[std::size_t(ends[1])];
        ++edge;
    }
    computeBoxAndNormals(layer.cm);
    return layer;
}
