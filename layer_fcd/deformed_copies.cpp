// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // these before Qt
#include <vcg_ext/field/deformation_file.h>

#include "deformed_copies.h"
#include "kept_deformation.h"
#include "layer_contents.h"
#include "layer_matrix.h"
#include "new_layers.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <mutex>
#include <sstream>
#include <utility>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <QFile>

using vcg::fcd::DeformationField;
using vcg::fcd::Error;
using vcg::fcd::Index;
using vcg::fcd::NearestPlace;
using vcg::fcd::Progress;

namespace {

/// The source as it was before it was deformed.
class Source {
  public:
    Source(MeshModel &layer, const Deformation &deformation)
        : position(positionsBefore(layer, deformation)), matrix(invertibleMatrixOf(layer)) {
        const CMeshO &mesh = layer.cm;
        std::vector<std::array<Index, 3>> triangle;
        triangle.reserve(std::size_t(mesh.fn));
        for (const CFaceO &face : mesh.face)
            if (!face.IsD())
                triangle.push_back({Index(vcg::tri::Index(mesh, face.cV(0))), Index(vcg::tri::Index(mesh, face.cV(1))),
                                    Index(vcg::tri::Index(mesh, face.cV(2)))});
        std::vector<char> isVertex(mesh.vert.size());
        for (std::size_t i = 0; i < isVertex.size(); ++i)
            isVertex[i] = !mesh.vert[i].IsD();
        places = std::make_unique<NearestPlace>(position, std::move(triangle), isVertex);
    }

    Eigen::Matrix3Xd position;
    Eigen::Affine3d matrix;
    std::unique_ptr<NearestPlace> places;
};

/// The vertices of the source by their places.
class VerticesAtPlaces {
  public:
    VerticesAtPlaces(const MeshModel &source, const Eigen::Matrix3Xd &position) : mesh(source.cm), position(position) {}

    /// The vertex at \p p: that of the same slot, where it is, as in a copy of the source; or else, of several, the one
    /// whose normal is nearest to \p normal. Less than 0 where there is none. \param slot of the vertex that asks
    std::ptrdiff_t operator()(std::size_t slot, const Eigen::Vector3d &p, const Eigen::Vector3d &normal) const {
        if (isAt(slot, p))
            return std::ptrdiff_t(slot);
        std::call_once(sorted, [this] { sort(); });
        const std::uint64_t place = placeOf(p);
        std::ptrdiff_t found = -1;
        double best = 0;
        for (auto at = std::lower_bound(places.begin(), places.end(), std::make_pair(place, std::uint32_t(0)));
             at != places.end() && at->first == place; ++at) {
            const double alike = toVector(mesh.vert[at->second].cN()).dot(normal);
            if (isAt(at->second, p) && (found < 0 || alike > best)) {
                found = std::ptrdiff_t(at->second);
                best = alike;
            }
        }
        return found;
    }

  private:
    bool isAt(std::size_t slot, const Eigen::Vector3d &p) const {
        return slot < mesh.vert.size() && !mesh.vert[slot].IsD() && position.col(Eigen::Index(slot)) == p;
    }
    static std::uint64_t placeOf(const Eigen::Vector3d &p) {
        const Eigen::Vector3d positive = p + Eigen::Vector3d::Zero(); // of -0, too
        return XXH3_64bits(positive.data(), 3 * sizeof(double));
    }
    void sort() const {
        places.resize(mesh.vert.size());
        vcg::fcd::ParallelFor(0, places.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                places[i] = {placeOf(position.col(Eigen::Index(i))), std::uint32_t(i)};
        });
        std::sort(places.begin(), places.end());
    }

    const CMeshO &mesh;
    const Eigen::Matrix3Xd &position;
    mutable std::once_flag sorted;
    mutable std::vector<std::pair<std::uint64_t, std::uint32_t>> places; ///< and slots
};

/// A vertex that is carried, in the coordinates of the source.
struct Carried {
    std::size_t slot;
    Eigen::Vector3d position, normal;
};

/// The displacement of a vertex, and how space turns and stretches there.
using Displacement = std::function<Eigen::Vector3d(const Carried &, Eigen::Matrix3f &)>;

/// The box of finite positions, in the world.
Eigen::AlignedBox3d boxOf(const Eigen::Matrix3Xd &position, const Eigen::Affine3d &matrix, const CMeshO *mesh) {
    Eigen::AlignedBox3d box;
    for (Eigen::Index i = 0; i < position.cols(); ++i)
        if ((!mesh || !mesh->vert[std::size_t(i)].IsD()) && position.col(i).allFinite())
            box.extend(matrix * Eigen::Vector3d(position.col(i)));
    return box;
}

/// What is to be said of a layer that is not where the source is, or of another size; both in the world.
std::string describeSpace(const MeshModel &target, const Eigen::AlignedBox3d &here, const Eigen::AlignedBox3d &source) {
    if (here.isEmpty() || source.isEmpty())
        return {};
    const double size = here.diagonal().norm(), sourceSize = source.diagonal().norm(),
                 gap = here.exteriorDistance(source);
    const bool isFar = gap > sourceSize, isLandmarks = target.cm.vn < 100; // a few points may lie close together
    if (!isFar && size <= 10 * sourceSize && (10 * size >= sourceSize || isLandmarks))
        return {};
    std::ostringstream text;
    text << "The layer '" << target.label().toStdString() << "' is " << size << " across and the source " << sourceSize;
    if (isFar)
        text << ", and they are " << gap << " apart";
    text << ": far from the source, what it does means nothing. Bring the layer to the same place and units first.";
    return text.str();
}

bool isPlace(const MeshModel &layer, const Eigen::Matrix3Xd &position, std::size_t i) {
    return !layer.cm.vert[i].IsD() && position.col(Eigen::Index(i)).allFinite();
}

/// Positions and maps of the vertices of \p target. \param matrix from the coordinates of \p displacement to the world
void carry(const MeshModel &target, const Eigen::Affine3d &matrix, const Displacement &displacement,
           const Progress &progress, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> &linear) {
    const CMeshO &mesh = target.cm;
    const Eigen::Affine3d here = invertibleMatrixOf(target);
    const bool isSame = here.matrix() == matrix.matrix();
    const Eigen::Affine3d to = isSame ? Eigen::Affine3d::Identity() : matrix.inverse() * here;
    const Eigen::Matrix3d back = isSame ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(to.linear().inverse());
    linear.assign(mesh.vert.size(), Eigen::Matrix3f::Identity());
    ParallelFor(progress, "Mapping to the layer", mesh.vert.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
        Eigen::Matrix3f map;
        for (std::size_t i = first; i < last; ++i) {
            const Eigen::Vector3d p = position.col(Eigen::Index(i));
            if (!isPlace(target, position, i))
                continue;
            const Eigen::Vector3d normal = toVector(mesh.vert[i].cN());
            const Eigen::Vector3d way =
                displacement({i, isSame ? p : to * p, isSame ? normal : to.linear() * normal}, map);
            if (way.isZero(0)) // what is fixed keeps its bits
                continue;
            position.col(Eigen::Index(i)) = p + back * way;
            linear[i] = isSame ? map : Eigen::Matrix3f((back * map.cast<double>() * to.linear()).cast<float>());
        }
    });
}

} // namespace

DeformedCopies copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                               const Remark &remark, const Progress &progress) {
    progress(0, "Reading the source");
    std::unique_ptr<const Source> source;
    std::unique_ptr<const vcg::fcd::Carrier> carrier;
    std::unique_ptr<const VerticesAtPlaces> vertices;
    std::unique_ptr<const DeformationField> field;
    Displacement displacement;
    int sides = 0; // of the source, as the normals of the layer at hand tell them
    Eigen::Affine3d matrix = Eigen::Affine3d::Identity();
    if (param.file.isEmpty()) {
        const Deformation &deformation = deformationOf(param.source, param.restGraph, param.deformedGraph);
        source = std::make_unique<Source>(*param.source, deformation);
        carrier = std::make_unique<vcg::fcd::Carrier>(*deformation.prepared->deformer, deformation.pose);
        vertices = std::make_unique<VerticesAtPlaces>(*param.source, source->position);
        displacement = [&](const Carried &vertex, Eigen::Matrix3f &map) {
            // Where parts touch, the nearest place may be another part's.
            const Eigen::Vector3d &x = vertex.position;
            if (const std::ptrdiff_t same = (*vertices)(vertex.slot, x, vertex.normal); same >= 0)
                return Eigen::Vector3d((*carrier)(std::size_t(same), x, map) - x);
            NearestPlace::Hint none;
            const vcg::fcd::SurfacePlace place =
                sides == 0 ? (*source->places)(x, none) : (*source->places)(x, none, sides * vertex.normal);
            return carrier->Displacement(place, x, map);
        };
        matrix = source->matrix;
    } else {
        field = std::make_unique<DeformationField>(
            vcg::fcd::ReadDeformationFile(QFile::encodeName(param.file).toStdString()));
        displacement = [&field](const Carried &vertex, Eigen::Matrix3f &map) {
            return (*field)(vertex.position, &map);
        };
    }

    std::vector<std::unique_ptr<NewLayers>> added;
    const MeshModel *last = targets.back();
    DeformedCopies made;
    const Eigen::AlignedBox3d sourceBox =
        source ? boxOf(source->position, matrix, &param.source->cm) : boxOf(field->samples.position, matrix, nullptr);
    for (std::size_t t = 0; t < targets.size(); ++t) {
        const MeshModel &target = *targets[t];
        Eigen::Matrix3Xd position = positionsOf(target);
        std::vector<Eigen::Matrix3f> linear;
        if (std::string text =
                describeSpace(target, boxOf(position, invertibleMatrixOf(target), &target.cm), sourceBox);
            !text.empty())
            made.warnings.push_back(std::move(text));
        if (source) { // a file takes points as they come, in any pieces
            const Eigen::Affine3d to = matrix.inverse() * invertibleMatrixOf(target);
            sides = source->places->SidesTold(
                target.cm.vert.size(),
                [&](std::size_t i) { return Eigen::Vector3d(to * Eigen::Vector3d(position.col(Eigen::Index(i)))); },
                [&](std::size_t i) {
                    return isPlace(target, position, i)
                               ? Eigen::Vector3d(to.linear() * toVector(target.cm.vert[i].cN()))
                               : Eigen::Vector3d(Eigen::Vector3d::Zero());
                });
        }
        carry(target, matrix, displacement,
              progress.Slice(0.2 + 0.8 * double(t) / double(targets.size()),
                             0.2 + 0.8 * double(t + 1) / double(targets.size())),
              position, linear);
        if (!hasDirections(target))
            linear.clear();
        added.push_back(std::make_unique<NewLayers>(document, target, remark));
        MeshModel &copy = added.back()->addDeformed("deformed", position, linear, {});
        if (param.displacement)
            added.back()->addDisplacement(copy, position);
        last = &copy;
        made.vertices += target.cm.vn;
    }
    NewLayers::keep(added, *last, progress);
    return made;
}
