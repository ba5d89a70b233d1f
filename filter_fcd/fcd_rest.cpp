// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/graph.h> // before Qt

#include "fcd_normals.h"
#include "fcd_rest.h"

#include <vcg/complex/allocate.h>
#include <vcg/complex/algorithms/update/bounding.h>

#include <algorithm>
#include <numeric>

#define XXH_INLINE_ALL
#include <xxhash.h>

using vcg::fcd::ParallelFor;

namespace {

const char *const positionName = "fcd_rest", *const normalName = "fcd_rest_normal", *const posesName = "fcd_poses";
// A preview begins each time with the shape that the layer had before, which is then the latest; a few are enough.
const std::size_t mostPoses = 16;

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
    host::madeMeshAttribute<Poses>(mesh, posesName) = {shapeOf(mesh), mesh.vn, {}};
}

RestShape::RestShape(MeshModel &layer)
    : layer(layer), position(values(layer.cm, positionName)), normal(values(layer.cm, normalName)),
      poses(posesOf(layer.cm)) {}

bool RestShape::knows(std::uint64_t shape) {
    std::vector<std::uint64_t> &latest = poses->latest;
    const auto found = std::find(latest.begin(), latest.end(), shape);
    if (found != latest.end())
        std::rotate(latest.begin(), found, found + 1);
    return found != latest.end() || shape == poses->rest;
}

void RestShape::add(std::uint64_t shape) {
    if (knows(shape))
        return;
    poses->latest.insert(poses->latest.begin(), shape);
    poses->latest.resize(std::min(poses->latest.size(), mostPoses));
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
