// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "layer_normals.h"
#include "parameters.h"
#include "pose_in_place.h"

#include <mutex>

using vcg::fcd::Error;
using vcg::fcd::ParallelFor;

namespace {

/// Begins to read what a vertex, which will soon be written, has at rest, and the vertex itself.
void prefetch(const Point3m &position, const Point3m &normal, const CVertexO &vertex) {
    ::prefetch(&position);
    ::prefetch(&normal);
    ::prefetch(&vertex);
    ::prefetch(reinterpret_cast<const char *>(&vertex + 1) - 1);
}

/// Hands the positions and normals of what moves to takers: one a range of vertices, which \p make makes.
template <class Make>
void carry(const CMeshO &mesh, const Point3m *position, const Point3m *normal, const Prepared &prepared,
           const vcg::fcd::Deformer::Pose &pose, const Make &make) {
    vcg::fcd::Carrier(*prepared.deformer, pose)
        .ApplyWithNormals([&](std::size_t slot) { return toVector(position[slot]); },
                          [&](std::size_t slot) { return toVector(normal[slot]); }, make, vcg::fcd::Progress(),
                          [&](std::size_t slot) { prefetch(position[slot], normal[slot], mesh.vert[slot]); });
}

void write(CVertexO &vertex, const Eigen::Vector3d &position, const Eigen::Vector3d &normal) {
    vertex.P() = toPoint(position);
    vertex.N() = toPoint(normal);
}

} // namespace

void ShapeSum::add(std::size_t slot, const Point3m &position) {
    shape += shapeTerm(slot, position);
    box.Add(position);
}

void ShapeSum::add(const ShapeSum &other) {
    shape += other.shape;
    box.Add(other.box);
}

void writeMoving(CMeshO &mesh, const Point3m *position, const Point3m *normal, const Prepared &prepared,
                 const vcg::fcd::Deformer::Pose &pose) {
    carry(mesh, position, normal, prepared, pose, [&] {
        return
            [&](std::size_t slot, const Eigen::Vector3d &p, const Eigen::Vector3d &n) { write(mesh.vert[slot], p, n); };
    });
}

ShapeSum writePose(CMeshO &mesh, const RestShape &rest, const Prepared &prepared,
                   const vcg::fcd::Deformer::Pose &pose) {
    std::mutex lock;
    ShapeSum all;
    struct Taker {
        Taker(CMeshO &mesh, std::mutex &lock, ShapeSum &all) : mesh(mesh), lock(lock), all(all) {}
        Taker(const Taker &) = delete;
        Taker &operator=(const Taker &) = delete;
        ~Taker() {
            const std::lock_guard<std::mutex> guard(lock);
            all.add(sum);
        }
        void operator()(std::size_t slot, const Eigen::Vector3d &position, const Eigen::Vector3d &normal) {
            CVertexO &vertex = mesh.vert[slot];
            write(vertex, position, normal);
            sum.add(slot, vertex.cP());
        }
        CMeshO &mesh;
        std::mutex &lock;
        ShapeSum &all, sum;
    };
    carry(mesh, rest.positions(), rest.normals(), prepared, pose, [&] { return Taker(mesh, lock, all); });
    ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        ShapeSum still;
        for (std::size_t i = first; i < last; ++i)
            if (!prepared.moving[i] && !mesh.vert[i].IsD()) {
                if (mesh.vert[i].cP() != rest.positions()[i]) { // moved by a pose with other tags
                    mesh.vert[i].P() = rest.positions()[i];
                    mesh.vert[i].N() = rest.normals()[i];
                }
                still.add(i, mesh.vert[i].cP());
            }
        const std::lock_guard<std::mutex> guard(lock);
        all.add(still);
    });
    return all;
}

void resetPose(MeshModel &layer, bool presentShape) {
    if (!RestShape::exists(layer))
        throw Error("The layer '" + layer.label().toStdString() +
                    "' has not been posed in place, so there is no other shape to go back to.");
    if (presentShape)
        RestShape::keep(layer);
    else
        RestShape(layer).restore();
}
