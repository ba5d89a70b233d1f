// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_file.h> // before Qt

#include "deformation_uses.h"
#include "kept_graph.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "new_layers.h"
#include "save_files.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include <xxhash.h>

using vcg::fcd::DeformationField;
using vcg::fcd::Index;
using vcg::fcd::NearestPlace;
using vcg::fcd::Progress;

DeformedCopies copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                               const Remark &remark, const Progress &progress) {
    progress(0, "Reading the source");
    std::unique_ptr<const CarryingSurface> source;
    std::unique_ptr<const vcg::fcd::Carrier> carrier;
    std::unique_ptr<const DeformationField> field;
    Displacements displacements;
    int sides = 0; // CarryingSurface::sidesTold for the present layer
    Eigen::Affine3d matrix = Eigen::Affine3d::Identity();
    if (param.file.isEmpty()) {
        DeformationThen then = deformationOf(param, false, remark);
        source = std::make_unique<const CarryingSurface>(*param.source, std::move(then.position));
        carrier = std::make_unique<vcg::fcd::Carrier>(*then.deformation.prepared->deformer, then.deformation.pose);
        displacements = [&](const CarriedVertices &vertices, auto &displacement, auto &linear) {
            std::vector<vcg::fcd::SurfacePlace> places(vertices.slot.size());
            vcg::fcd::NearestPlace::Hint hint;
            for (std::size_t n = 0; n < places.size(); ++n)
                places[n] = (*source)(vertices, n, sides, hint);
            carrier->Displacements(places, vertices.position, displacement, linear);
        };
        matrix = source->matrix;
    } else {
        field = std::make_unique<DeformationField>(vcg::fcd::ReadDeformationFile(pathOf(param.file)));
        displacements = [&field](const CarriedVertices &vertices, auto &displacement, auto &linear) {
            linear.resize(vertices.slot.size());
            for (std::size_t n = 0; n < linear.size(); ++n)
                displacement.push_back((*field)(vertices.position[n], &linear[n]));
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
                describeSpace(target, boxOf(position, invertibleMatrixOf(target), &target.cm), sourceBox, true);
            !text.empty())
            made.warnings.push_back(std::move(text));
        if (source) // a saved deformation goes by distance alone
            sides = source->sidesTold(target, position);
        carry(target, matrix, displacements,
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

/// Maps positions and linear maps from the coordinates of a layer to the world. Vertices at rest stay so, to the bit.
static void toWorld(const Eigen::Affine3d &matrix, Eigen::Matrix3Xd &rest, Eigen::Matrix3Xd &deformed,
                    std::vector<Eigen::Matrix3f> &linear) {
    if (matrix.matrix().isIdentity(0))
        return;
    const Eigen::Matrix3d to = matrix.linear(), back = to.inverse();
    forEach(linear.size(), [&](std::size_t slot) {
        const auto i = Eigen::Index(slot);
        rest.col(i) = matrix * Eigen::Vector3d(rest.col(i));
        deformed.col(i) = matrix * Eigen::Vector3d(deformed.col(i));
        if (linear[slot] != Eigen::Matrix3f::Identity())
            linear[slot] = (to * linear[slot].cast<double>() * back).cast<float>();
    });
}

SavedDeformation saveDeformation(const SaveDeformationParam &param, const Remark &remark,
                                 const vcg::fcd::Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    SavedDeformation saved;
    progress(0, "Reading the source");
    const DeformationThen then = deformationOf(param, true, remark);
    const Deformation &deformation = then.deformation;
    const Eigen::Affine3d &matrix = then.matrix;
    Eigen::Matrix3Xd rest = then.position, deformed = rest;
    std::vector<Eigen::Matrix3f> linear;
    vcg::fcd::Carrier(*deformation.prepared->deformer, deformation.pose, progress.threads)
        .Apply(deformed, &linear, progress.Slice(0, 0.1));
    toWorld(matrix, rest, deformed, linear);
    if (param.inverse) {
        rest.swap(deformed);
        saved.folded = vcg::fcd::Invert(linear);
    }
    const vcg::fcd::SurfaceArrays surface = vcg::tri::ReadSurface(param.source->cm);
    vcg::fcd::FieldParam sampling;
    sampling.accuracy = param.accuracy;
    saved.field =
        vcg::fcd::SampleField(surface.View().With(then.position), rest, deformed, linear, sampling,
                              progress.Slice(0.1, 0.95), matrix.linear(), deformation.prepared->deformer->FreeIn());
    progress(1, "Done");
    const std::string text = vcg::fcd::DeformationText(saved.field.samples);
    saved.bytes = text.size();
    saveFiles({{param.file, text}});
    saved.seconds = watch.Seconds();
    return saved;
}

static bool isPlace(const MeshModel &layer, const Eigen::Matrix3Xd &position, std::size_t i) {
    return !layer.cm.vert[i].IsD() && position.col(Eigen::Index(i)).allFinite();
}

/// Finds the vertex of the surface at a position.
class CarryingSurface::VerticesAtPlaces {
  public:
    VerticesAtPlaces(const MeshModel &source, const Eigen::Matrix3Xd &position) : mesh(source.cm), position(position) {}

    /// The slot of the vertex at \p p: \p slot if that is there, as in a copy of the source; else, of several, the one
    /// whose normal is nearest to \p normal; < 0: none.
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
        const Eigen::Vector3d positive = p + Eigen::Vector3d::Zero(); // no negative zero
        return XXH3_64bits(positive.data(), 3 * sizeof(double));
    }
    void sort() const {
        places.resize(mesh.vert.size());
        forEach(places.size(), [&](std::size_t i) {
            places[i] = {placeOf(position.col(Eigen::Index(i))), std::uint32_t(i)};
        });
        std::sort(places.begin(), places.end());
    }

    const CMeshO &mesh;
    const Eigen::Matrix3Xd &position;
    mutable std::once_flag sorted;
    mutable std::vector<std::pair<std::uint64_t, std::uint32_t>> places; ///< and slots
};

CarryingSurface::CarryingSurface(const MeshModel &layer, Eigen::Matrix3Xd given)
    : position(std::move(given)), matrix(invertibleMatrixOf(layer)) {
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
    ownVertices = std::make_unique<VerticesAtPlaces>(layer, position);
}

CarryingSurface::~CarryingSurface() = default;

int CarryingSurface::sidesTold(const MeshModel &target, const Eigen::Matrix3Xd &at) const {
    const Eigen::Affine3d to = matrix.inverse() * invertibleMatrixOf(target);
    return places->SidesTold(
        target.cm.vert.size(),
        [&](std::size_t i) { return Eigen::Vector3d(to * Eigen::Vector3d(at.col(Eigen::Index(i)))); },
        [&](std::size_t i) {
            return isPlace(target, at, i) ? Eigen::Vector3d(to.linear() * toVector(target.cm.vert[i].cN()))
                                          : Eigen::Vector3d(Eigen::Vector3d::Zero());
        });
}

vcg::fcd::SurfacePlace CarryingSurface::operator()(const CarriedVertices &vertices, std::size_t n, int sides,
                                                   NearestPlace::Hint &hint) const {
    const Eigen::Vector3d &p = vertices.position[n], &normal = vertices.normal[n];
    // First look for a vertex at the same position: where parts touch, the nearest place may be another part's.
    if (const std::ptrdiff_t same = (*ownVertices)(vertices.slot[n], p, normal); same >= 0)
        return vcg::fcd::SurfacePlace::AtVertex(Index(same));
    return sides == 0 ? (*places)(p, hint) : (*places)(p, hint, sides * normal);
}

Eigen::AlignedBox3d boxOf(const Eigen::Matrix3Xd &position, const Eigen::Affine3d &matrix, const CMeshO *mesh) {
    Eigen::AlignedBox3d box;
    for (Eigen::Index i = 0; i < position.cols(); ++i)
        if ((!mesh || !mesh->vert[std::size_t(i)].IsD()) && position.col(i).allFinite())
            box.extend(matrix * Eigen::Vector3d(position.col(i)));
    return box;
}

std::string describeSpace(const MeshModel &target, const Eigen::AlignedBox3d &here, const Eigen::AlignedBox3d &source,
                          bool isWhole) {
    const bool mayBeSmall = !isWhole || target.cm.vn < 100; // a few points may lie close together
    return vcg::fcd::SpaceRemark("The layer " + inQuotes(target) + " is", here, source, mayBeSmall ? 0 : 0.1);
}

void carry(const MeshModel &target, const Eigen::Affine3d &matrix, const Displacements &displacements,
           const Progress &progress, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> &linear) {
    const CMeshO &mesh = target.cm;
    const Eigen::Affine3d here = invertibleMatrixOf(target);
    const bool isSame = here.matrix() == matrix.matrix();
    const Eigen::Affine3d to = isSame ? Eigen::Affine3d::Identity() : matrix.inverse() * here;
    const Eigen::Matrix3d back = isSame ? Eigen::Matrix3d::Identity() : Eigen::Matrix3d(to.linear().inverse());
    linear.assign(mesh.vert.size(), Eigen::Matrix3f::Identity());
    ParallelFor(progress, "Mapping to the layer", mesh.vert.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
        CarriedVertices vertices;
        for (std::size_t i = first; i < last; ++i) {
            if (!isPlace(target, position, i))
                continue;
            const Eigen::Vector3d p = position.col(Eigen::Index(i)), normal = toVector(mesh.vert[i].cN());
            vertices.slot.push_back(i);
            vertices.position.push_back(isSame ? p : to * p);
            vertices.normal.push_back(isSame ? normal : to.linear() * normal);
        }
        std::vector<Eigen::Vector3d> displacement;
        std::vector<Eigen::Matrix3f> map;
        displacements(vertices, displacement, map);
        for (std::size_t n = 0; n < vertices.slot.size(); ++n) {
            if (displacement[n].isZero(0)) // fixed vertices keep their bits
                continue;
            const std::size_t i = vertices.slot[n];
            position.col(Eigen::Index(i)) += back * displacement[n];
            linear[i] = isSame ? map[n] : Eigen::Matrix3f((back * map[n].cast<double>() * to.linear()).cast<float>());
        }
    });
}
