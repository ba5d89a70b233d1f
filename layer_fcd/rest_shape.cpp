// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // these before Qt
#include <vcg_ext/surface/read_surface.h>

#include "affine_map.h"
#include "layer_contents.h"
#include "layer_normals.h"
#include "parameters.h"
#include "rest_shape.h"

#include <vcg/complex/allocate.h>
#include <vcg/complex/algorithms/update/bounding.h>

#include <algorithm>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

using vcg::fcd::ParallelFor;

namespace {

const char *const positionName = "fcd_rest", *const normalName = "fcd_rest_normal", *const vertexName = "fcd_posed_2",
                  *const posedName = "fcd_posed_layer_3";
static_assert(std::is_trivial<PosedVertex>::value && std::is_trivially_copyable<Posed>::value,
              "plain data, whoever has made it; zero for new vertices");

template <class T>
T *values(const CMeshO &mesh, const std::string &name) {
    return host::vertexAttribute<T>(mesh, name.c_str());
}

/// The attribute of an earlier rest shape. \param what positionName, or normalName
std::string earlierName(const char *what, std::uint32_t number) { return what + ("_" + std::to_string(number)); }

/// The sum of shapeTerm over the live vertices.
template <class PositionOf>
std::uint64_t shapeSum(const CMeshO &mesh, const PositionOf &positionOf) {
    return sumOf(mesh.vert.size(), [&](std::size_t first, std::size_t last) {
        std::uint64_t sum = 0;
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD())
                sum += shapeTerm(i, positionOf(i));
        return sum;
    });
}

/// Turns the normals of a shape over that look to the other side than the faces there.
void turnToFaces(const CMeshO &mesh, const Point3m *position, Point3m *normal) {
    std::vector<Eigen::Vector3d> sum(mesh.vert.size(), Eigen::Vector3d::Zero());
    for (const CFaceO &face : mesh.face)
        if (!face.IsD()) {
            std::uint32_t corner[3];
            vcg::tri::ReadSlots(mesh, face, 3, corner);
            const auto at = [&](int k) { return toVector(position[corner[k]]); };
            const Eigen::Vector3d p = at(0), n = (at(1) - p).cross(at(2) - p);
            for (std::uint32_t slot : corner)
                sum[slot] += n;
        }
    forVertices(mesh, [&](std::size_t i) {
        if (toVector(normal[i]).dot(sum[i]) < 0)
            normal[i] = -normal[i];
    });
}

/// Gives a shape of the mesh the normals of its faces. Those of the mesh's own faces are to be computed anew then.
void takeNormals(CMeshO &mesh, Point3m *position, Point3m *normal) {
    const auto change = [&] {
        forVertices(mesh, [&](std::size_t i) {
            std::swap(mesh.vert[i].P(), position[i]);
            std::swap(mesh.vert[i].N(), normal[i]);
        });
    };
    change();
    computeNormals(mesh);
    change();
}

} // namespace

bool isOfRest(const std::string &attribute) {
    const auto isEarlier = [&](const std::string &name) {
        return attribute.rfind(name + "_", 0) == 0 &&
               attribute.find_first_not_of("0123456789", name.size() + 1) == std::string::npos;
    };
    return attribute == positionName || attribute == normalName || attribute == vertexName || isEarlier(positionName) ||
           isEarlier(normalName);
}

bool RestShape::exists(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    return values<Point3m>(mesh, positionName) && values<Point3m>(mesh, normalName) &&
           values<PosedVertex>(mesh, vertexName) && host::meshAttribute<Posed>(mesh, posedName);
}

const PosedVertex *RestShape::lastPlaces(const CMeshO &mesh) { return values<PosedVertex>(mesh, vertexName); }

void RestShape::keep(MeshModel &layer) {
    CMeshO &mesh = layer.cm;
    Posed kept;
    if (exists(layer)) {
        RestShape last(layer);
        const bool areHome = last.countStrangers() == 0 || last.followMove();
        while (last.posed->count > 0 && (!areHome || last.posed->count == Posed::mostEarlier))
            last.dropEarlier(areHome ? 1 : last.posed->count - 1); // the first is that of the file
        if (areHome && last.shape() != shapeOf(mesh)) {
            const std::uint32_t number = last.posed->made;
            auto *position = host::madeVertexAttribute<Point3m>(mesh, earlierName(positionName, number).c_str()),
                 *normal = host::madeVertexAttribute<Point3m>(mesh, earlierName(normalName, number).c_str());
            forVertices(mesh, [&](std::size_t i) {
                position[i] = last.position[i];
                normal[i] = last.normal[i];
            });
            last.posed->earlier[last.posed->count++] = last.posed->made++;
        }
        kept = *last.posed;
    }
    Point3m *position = host::madeVertexAttribute<Point3m>(mesh, positionName),
            *normal = host::madeVertexAttribute<Point3m>(mesh, normalName);
    auto *vertices = host::madeVertexAttribute<PosedVertex>(mesh, vertexName);
    forVertices(mesh, [&](std::size_t i) {
        const Point3m &p = mesh.vert[i].cP();
        position[i] = p;
        normal[i] = mesh.vert[i].cN();
        vertices[i] = {{p[0], p[1], p[2]}, placeOf(p)};
    });
    kept.faces = facesOf(mesh);
    kept.vertexSlots = mesh.vert.size();
    kept.ownNormals = ::hasOwnNormals(layer);
    host::madeMeshAttribute<Posed>(mesh, posedName) = kept;
}

void RestShape::drop(MeshModel &layer) {
    using Allocator = vcg::tri::Allocator<CMeshO>;
    for (const char *name : {positionName, normalName, vertexName})
        Allocator::DeletePerVertexAttribute(layer.cm, name);
    Allocator::DeletePerMeshAttribute(layer.cm, posedName);
}

RestShape::RestShape(MeshModel &layer)
    : layer(layer), mesh(layer.cm), position(values<Point3m>(mesh, positionName)),
      normal(values<Point3m>(mesh, normalName)), vertices(values<PosedVertex>(mesh, vertexName)),
      posed(host::meshAttribute<Posed>(mesh, posedName)) {}

std::uint64_t RestShape::placeOf(const Point3m &position) {
    return std::max(XXH3_64bits(&position[0], 3 * sizeof(Scalarm)), XXH64_hash_t(1));
}

std::uint64_t RestShape::shape() const {
    return shapeSum(mesh, [this](std::size_t i) { return position[i]; });
}

std::vector<std::uint64_t> RestShape::shapes() const {
    std::vector<std::uint64_t> all;
    for (std::uint32_t k = 0; k < posed->count; ++k) {
        const Point3m *earlier = earlierPositions(k);
        all.push_back(earlier ? shapeSum(mesh, [earlier](std::size_t i) { return earlier[i]; }) : 0);
    }
    all.push_back(shape());
    return all;
}

void RestShape::dropEarlier(std::uint32_t place) {
    for (const char *what : {positionName, normalName})
        vcg::tri::Allocator<CMeshO>::DeletePerVertexAttribute(mesh, earlierName(what, posed->earlier[place]));
    std::copy(posed->earlier.begin() + place + 1, posed->earlier.begin() + posed->count,
              posed->earlier.begin() + place);
    --posed->count;
}

void RestShape::backTo(std::size_t place) {
    if (place >= posed->count)
        return;
    const Point3m *earlier = earlierPositions(std::uint32_t(place)),
                  *earlierNormal = earlierNormals(std::uint32_t(place));
    forVertices(mesh, [&](std::size_t i) {
        position[i] = earlier[i];
        normal[i] = earlierNormal[i];
    });
    while (posed->count > place)
        dropEarlier(posed->count - 1);
}

Point3m *RestShape::earlierPositions(std::uint32_t place) const {
    return values<Point3m>(mesh, earlierName(positionName, posed->earlier[place]));
}

Point3m *RestShape::earlierNormals(std::uint32_t place) const {
    return values<Point3m>(mesh, earlierName(normalName, posed->earlier[place]));
}

bool RestShape::isAtHome(std::size_t slot) {
    PosedVertex &known = vertices[slot];
    const Point3m &p = mesh.vert[slot].cP();
    const std::uint64_t here = placeOf(p);
    if (here == known.before)
        return true;
    if (!known.isKnown() || (!known.isAt(p) && p != position[slot]))
        return false;
    known.before = here;
    return true;
}

std::uint64_t RestShape::countStrangers() {
    return sumOf(mesh.vert.size(), [this](std::size_t first, std::size_t last) {
        std::uint64_t count = 0;
        for (std::size_t i = first; i < last; ++i)
            count += !mesh.vert[i].IsD() && !isAtHome(i);
        return count;
    });
}

bool RestShape::isSameMesh() const {
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        if (!mesh.vert[i].IsD() && !vertices[i].isKnown())
            return false;
    return posed->vertexSlots == mesh.vert.size() && posed->faces == facesOf(mesh);
}

/// Where something else has moved all vertices by one affine map, moves the rest shapes by that. \return whether it has
bool RestShape::followMove() {
    std::vector<Eigen::Vector3d> from, to;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
        if (mesh.vert[i].IsD())
            continue;
        if (!vertices[i].isKnown())
            return false;
        from.push_back(vertices[i].place());
        to.push_back(toVector(mesh.vert[i].cP()));
    }
    const std::optional<Eigen::Affine3d> found = affineMapOf(from, to, layerRounding);
    if (!found)
        return false;
    const Eigen::Affine3d &move = *found;
    const bool ofFaces = !posed->ownNormals && mesh.fn > 0;
    const Eigen::Matrix3d turn = move.linear().inverse().transpose();
    const auto follow = [&](Point3m *positions, Point3m *normals) {
        forVertices(mesh, [&](std::size_t i) {
            positions[i] = toPoint(move * toVector(positions[i]));
            const Eigen::Vector3d n = toVector(normals[i]), turned = turn * n;
            if (turned.norm() > 0)
                normals[i] = toPoint(turned * (n.norm() / turned.norm()));
        });
        if (ofFaces)
            takeNormals(mesh, positions, normals);
    };
    follow(position, normal);
    for (std::uint32_t k = 0; k < posed->count; ++k)
        follow(earlierPositions(k), earlierNormals(k));
    if (ofFaces)
        computeFaceNormals(mesh, {});
    forVertices(mesh, [&](std::size_t i) {
        place(i, mesh.vert[i].cP());
        vertices[i].before = placeOf(mesh.vert[i].cP());
    });
    return true;
}

void RestShape::checkVertices(const std::string &remedy, const Remark &remark) {
    const std::uint64_t strangers = countStrangers();
    if (strangers == 0)
        return;
    if (!followMove())
        throw vcg::fcd::Error("The layer '" + layer.label().toStdString() +
                              "' was changed since its last pose: " + std::to_string(strangers) + " of its " +
                              std::to_string(mesh.vn) + " vertices were moved or made by something else. " + remedy);
    if (remark)
        remark("Something else has moved all of '" + layer.label().toStdString() +
               "' alike since its last pose (turned, scaled, or put elsewhere): its rest shape is moved so, too.");
}

std::uint64_t RestShape::followFaces() {
    const std::uint64_t present = facesOf(mesh);
    posed->vertexSlots = mesh.vert.size();
    if (present == posed->faces)
        return present;
    posed->faces = present;
    posed->ownNormals = ::hasOwnNormals(layer);
    if (posed->ownNormals || mesh.fn == 0)
        return present;
    turnToFaces(mesh, position, normal);
    for (std::uint32_t k = 0; k < posed->count; ++k)
        turnToFaces(mesh, earlierPositions(k), earlierNormals(k));
    return present;
}

void RestShape::restore() {
    forVertices(mesh, [this](std::size_t i) {
        place(i, position[i]);
        mesh.vert[i].N() = normal[i];
    });
    computeFaceNormals(mesh, {});
    vcg::tri::UpdateBounding<CMeshO>::Box(mesh);
}

std::uint64_t shapeTerm(std::size_t slot, const Point3m &position) {
    return XXH3_64bits_withSeed(&position[0], 3 * sizeof(Scalarm), slot);
}

std::uint64_t shapeOf(const CMeshO &mesh) {
    return shapeSum(mesh, [&mesh](std::size_t i) { return mesh.vert[i].cP(); });
}
