// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // before Qt

#include "layer_contents.h"
#include "layer_normals.h"
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

const char *const positionName = "fcd_rest", *const normalName = "fcd_rest_normal", *const posesName = "fcd_poses_1";
static_assert(std::is_trivially_copyable<Poses>::value, "plain data, whoever has made it");

Point3m *values(const CMeshO &mesh, const char *name) { return host::vertexAttribute<Point3m>(mesh, name); }

Poses *posesOf(const CMeshO &mesh) { return host::meshAttribute<Poses>(mesh, posesName); }

} // namespace

bool isOfRest(const std::string &attribute) { return attribute == positionName || attribute == normalName; }

bool RestShape::exists(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    return values(mesh, positionName) && values(mesh, normalName) && posesOf(mesh);
}

void RestShape::keep(MeshModel &layer) {
    CMeshO &mesh = layer.cm;
    Point3m *position = host::madeVertexAttribute<Point3m>(mesh, positionName),
            *normal = host::madeVertexAttribute<Point3m>(mesh, normalName);
    ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            position[i] = mesh.vert[i].cP();
            normal[i] = mesh.vert[i].cN();
        }
    });
    host::madeMeshAttribute<Poses>(mesh, posesName) = {shapeOf(mesh), mesh.vn, 0, {}};
}

RestShape::RestShape(MeshModel &layer)
    : layer(layer), position(values(layer.cm, positionName)), normal(values(layer.cm, normalName)),
      poses(posesOf(layer.cm)) {}

bool RestShape::knows(std::uint64_t shape) {
    std::uint64_t *const begin = poses->latest, *const end = begin + poses->count,
                         *found = std::find(begin, end, shape);
    if (found != end)
        std::rotate(begin, found, found + 1);
    return found != end || shape == poses->rest;
}

void RestShape::add(std::uint64_t shape) {
    if (knows(shape))
        return;
    poses->count = std::min(poses->count + 1, Poses::most);
    std::copy_backward(poses->latest, poses->latest + poses->count - 1, poses->latest + poses->count);
    poses->latest[0] = shape;
}

void RestShape::restore() const {
    CMeshO &mesh = layer.cm;
    if (mesh.vn > poses->vertices)
        throw vcg::fcd::Error("The layer '" + layer.label().toStdString() +
                              "' got new vertices since its first pose, and the rest shape has no place for them. Keep "
                              "the present shape, or delete them.");
    ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD()) {
                mesh.vert[i].P() = position[i];
                mesh.vert[i].N() = normal[i];
            }
    });
    computeFaceNormals(mesh, {});
    vcg::tri::UpdateBounding<CMeshO>::Box(mesh);
}

Eigen::Matrix3Xd restPositionsOf(MeshModel &layer) {
    Eigen::Matrix3Xd position = positionsOf(layer);
    if (RestShape::exists(layer)) {
        const Point3m *rest = RestShape(layer).positions();
        for (Eigen::Index i = 0; i < position.cols(); ++i)
            position.col(i) << rest[i][0], rest[i][1], rest[i][2];
    }
    return position;
}

std::uint64_t shapeTerm(std::size_t slot, const Point3m &position) {
    return XXH3_64bits_withSeed(&position[0], 3 * sizeof(Scalarm), slot);
}

std::uint64_t shapeOf(const CMeshO &mesh) {
    const std::size_t grain = 1 << 16;
    std::vector<std::uint64_t> sums((mesh.vert.size() + grain - 1) / grain, 0);
    ParallelFor(0, mesh.vert.size(), grain, [&](std::size_t first, std::size_t last) {
        std::uint64_t sum = 0;
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD())
                sum += shapeTerm(i, mesh.vert[i].cP());
        sums[first / grain] = sum;
    });
    return std::accumulate(sums.begin(), sums.end(), std::uint64_t(0));
}
