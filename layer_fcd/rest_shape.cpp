// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // these before Qt
#include <vcg_ext/surface/read_surface.h>

#include "layer_contents.h"
#include "layer_normals.h"
#include "parameters.h"
#include "rest_shape.h"

#include <vcg/complex/allocate.h>
#include <vcg/complex/algorithms/update/bounding.h>

#include <algorithm>
#include <numeric>
#include <type_traits>
#include <vector>

#define XXH_INLINE_ALL
#include <xxhash.h>

using vcg::fcd::ParallelFor;

namespace {

const char *const positionName = "fcd_rest", *const normalName = "fcd_rest_normal", *const vertexName = "fcd_posed_1",
                  *const posedName = "fcd_posed_layer_1";
static_assert(std::is_trivial<PosedVertex>::value && std::is_trivially_copyable<Posed>::value,
              "plain data, whoever has made it; zero for new vertices");

template <class T>
T *values(const CMeshO &mesh, const char *name) {
    return host::vertexAttribute<T>(mesh, name);
}

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

} // namespace

bool isOfRest(const std::string &attribute) {
    return attribute == positionName || attribute == normalName || attribute == vertexName;
}

bool RestShape::exists(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    return values<Point3m>(mesh, positionName) && values<Point3m>(mesh, normalName) &&
           values<PosedVertex>(mesh, vertexName) && host::meshAttribute<Posed>(mesh, posedName);
}

void RestShape::keep(MeshModel &layer) {
    CMeshO &mesh = layer.cm;
    Point3m *position = host::madeVertexAttribute<Point3m>(mesh, positionName),
            *normal = host::madeVertexAttribute<Point3m>(mesh, normalName);
    auto *vertices = host::madeVertexAttribute<PosedVertex>(mesh, vertexName);
    forVertices(mesh, [&](std::size_t i) {
        position[i] = mesh.vert[i].cP();
        normal[i] = mesh.vert[i].cN();
        const std::uint64_t place = placeOf(position[i]);
        vertices[i] = {place, place};
    });
    host::madeMeshAttribute<Posed>(mesh, posedName) = {facesOf(mesh), ::hasOwnNormals(layer)};
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

bool RestShape::isAtHome(std::size_t slot) {
    PosedVertex &known = vertices[slot];
    const Point3m &p = mesh.vert[slot].cP();
    const std::uint64_t here = placeOf(p);
    if (here == known.before)
        return true;
    if (here != known.now && (known.now == 0 || p != position[slot]))
        return false;
    known.before = here;
    return true;
}

void RestShape::checkVertices(const std::string &remedy) {
    const std::uint64_t strangers = sumOf(mesh.vert.size(), [this](std::size_t first, std::size_t last) {
        std::uint64_t count = 0;
        for (std::size_t i = first; i < last; ++i)
            count += !mesh.vert[i].IsD() && !isAtHome(i);
        return count;
    });
    if (strangers > 0)
        throw vcg::fcd::Error("The layer '" + layer.label().toStdString() +
                              "' was changed since its last pose: " + std::to_string(strangers) + " of its " +
                              std::to_string(mesh.vn) + " vertices were moved or made by something else. " + remedy);
}

std::uint64_t RestShape::followFaces() {
    const std::uint64_t present = facesOf(mesh);
    if (present == posed->faces)
        return present;
    posed->faces = present;
    posed->ownNormals = ::hasOwnNormals(layer);
    if (posed->ownNormals || mesh.fn == 0)
        return present;
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
