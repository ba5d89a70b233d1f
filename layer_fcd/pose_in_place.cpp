// SPDX-License-Identifier: GPL-3.0-or-later
#include "inherited.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_deformer.h"

#include <mutex>
#include <new>

using vcg::fcd::Error;
using vcg::fcd::ParallelFor;

namespace {

/// Prefetches a vertex that will soon be written, and its rest position and normal.
void prefetch(const Point3m &position, const Point3m &normal, const CVertexO &vertex) {
    vcg::fcd::Prefetch(&position);
    vcg::fcd::Prefetch(&normal);
    vcg::fcd::Prefetch(&vertex);
    vcg::fcd::Prefetch(reinterpret_cast<const char *>(&vertex + 1) - 1);
}

/// Hands the positions and normals of moving vertices to takers, which \p make makes, one for each range of vertices.
template <class Make>
void carry(const CMeshO &mesh, const Point3m *position, const Point3m *normal, const vcg::fcd::Carrier &carrier,
           const Make &make) {
    carrier.ApplyWithNormals([&](std::size_t slot) { return toVector(position[slot]); },
                             [&](std::size_t slot) { return toVector(normal[slot]); }, make, vcg::fcd::Progress(),
                             [&](std::size_t slot) { prefetch(position[slot], normal[slot], mesh.vert[slot]); });
}

/// Checks before writing that threads will have the memory they need: a layer must not be left half posed.
/// \throw std::bad_alloc
void checkRoom() {
    const std::size_t enough = std::size_t(1) << 22; // candidates of a patch are some hundreds, of 100 bytes each
    ::operator delete(::operator new(enough));
}

void write(CVertexO &vertex, const Eigen::Vector3d &position, const Eigen::Vector3d &normal) {
    vertex.P() = toPoint(position);
    vertex.N() = toPoint(normal);
}

} // namespace

void writeMoving(CMeshO &mesh, const Point3m *position, const Point3m *normal, const Prepared &prepared,
                 const vcg::fcd::Deformer::Pose &pose) {
    const vcg::fcd::Carrier carrier(*prepared.deformer, pose);
    checkRoom();
    carry(mesh, position, normal, carrier, [&] {
        return
            [&](std::size_t slot, const Eigen::Vector3d &p, const Eigen::Vector3d &n) { write(mesh.vert[slot], p, n); };
    });
}

bool writePose(CMeshO &mesh, RestShape &rest, const Prepared &prepared, const vcg::fcd::Deformer::Pose &pose,
               bool turnNormals) {
    struct Sum {
        vcg::Box3<Scalarm> box;
        bool moved = false;
    } all;
    std::mutex lock;
    const auto add = [&](const Sum &sum) {
        const std::lock_guard<std::mutex> guard(lock);
        all.box.Add(sum.box);
        all.moved |= sum.moved;
    };
    struct Taker {
        Taker(CMeshO &mesh, RestShape &rest, const std::function<void(const Sum &)> &add)
            : mesh(mesh), rest(rest), add(add) {}
        Taker(const Taker &) = delete;
        Taker &operator=(const Taker &) = delete;
        ~Taker() { add(sum); }
        void operator()(std::size_t slot, const Eigen::Vector3d &position, const Eigen::Vector3d &normal) {
            (*this)(slot, position);
            mesh.vert[slot].N() = toPoint(normal);
        }
        void operator()(std::size_t slot, const Eigen::Vector3d &position) {
            const Point3m p = toPoint(position);
            rest.place(slot, p);
            sum.box.Add(p);
            sum.moved |= p != rest.positions()[slot];
        }
        void operator()(std::size_t slot, const Eigen::Vector3d &position, const Eigen::Matrix3f &) {
            (*this)(slot, position);
        }
        CMeshO &mesh;
        RestShape &rest;
        const std::function<void(const Sum &)> &add;
        Sum sum;
    };
    const std::function<void(const Sum &)> adding = add;
    const auto taker = [&] { return Taker(mesh, rest, adding); };
    const vcg::fcd::Carrier carrier(*prepared.deformer, pose);
    checkRoom();
    if (turnNormals)
        carry(mesh, rest.positions(), rest.normals(), carrier, taker);
    else
        carrier.Apply([&](std::size_t slot) { return toVector(rest.positions()[slot]); }, taker, false,
                      vcg::fcd::Progress(), [&](std::size_t slot) { rest.prefetch(slot); });
    ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        Sum still;
        for (std::size_t i = first; i < last; ++i)
            if (!prepared.moving[i] && !mesh.vert[i].IsD()) {
                rest.place(i, rest.positions()[i]); // a pose with other tags may have moved it
                mesh.vert[i].N() = rest.normals()[i];
                still.box.Add(mesh.vert[i].cP());
            }
        add(still);
    });
    mesh.bbox = all.box;
    if (!all.moved)
        forVertices(mesh, [&](std::size_t i) { mesh.vert[i].N() = rest.normals()[i]; });
    return all.moved;
}

void resetPose(const MeshDocument &document, MeshModel &layer, const ResetPoseParam &param, const Remark &remark) {
    handDownRest(document, layer);
    if (!RestShape::inherit(document, layer))
        throw Error(
            "The layer " + inQuotes(layer) +
            " has not been posed in place, so there is no other shape to go back to. If a filter has replaced its "
            "whole mesh since, its rest shapes are gone with the old mesh.");
    if (param.keepShape) {
        RestShape::keep(document, layer);
        return;
    }
    RestShape rest(layer);
    const std::string keepIt = "'Keep the present shape' (keep_shape): poses then begin from that.";
    if (!rest.isSameMesh())
        rest.checkVertices("The rest shape has no place for these, and going back would tear the surface. Tick " +
                               keepIt + " Or open the layer's file again.",
                           remark);
    else if (param.to != ResetPoseParam::InAnyCase)
        rest.checkVertices("Going back would undo that, too. If you want that, choose 'The shape before the last pose, "
                           "whatever has moved it' (to=2); if not, tick " +
                               keepIt,
                           remark);
    rest.followFaces();
    const std::vector<std::uint64_t> shapes = rest.shapes();
    std::size_t to = shapes.size() - 1;
    if (param.to == ResetPoseParam::Loaded)
        to = 0;
    else if (to > 0 && shapes[to] == shapeOf(layer.cm))
        --to;
    rest.backTo(to);
    rest.restore();
}
