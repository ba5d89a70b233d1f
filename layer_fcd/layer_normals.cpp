// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/frame.h> // before Qt
#include <vcg_ext/graph.h>

#include "layer_normals.h"

#include <vcg/complex/algorithms/update/normal.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <thread>

using vcg::fcd::Index;
using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;

namespace {

/// What vcg::tri::UpdateNormal::PerFaceNormalized does for the faces whose first vertex is one of [first, last), and
/// PerVertexAngleWeighted for these vertices: sums of the normals of their faces, in the order of these. Vertices
/// without a face keep theirs.
void computeNormals(CMeshO &mesh, std::size_t first, std::size_t last) {
    std::vector<char> isClear(last - first, 0);
    for (CFaceO &face : mesh.face) {
        if (face.IsD())
            continue;
        std::size_t slot[3];
        bool isHere[3];
        for (int k = 0; k < 3; ++k) {
            slot[k] = std::size_t(face.cV(k) - mesh.vert.data());
            isHere[k] = slot[k] >= first && slot[k] < last;
        }
        if (!(isHere[0] || isHere[1] || isHere[2]))
            continue;
        const auto way = [&](int k) {
            Point3m edge = face.cP((k + 1) % 3) - face.cP(k);
            return edge.Normalize();
        };
        const Point3m normal = vcg::TriangleNormal(face).Normalize(), e0 = way(0), e1 = way(1), e2 = way(2);
        if (isHere[0])
            face.N() = normal;
        const auto add = [&](int k, const Point3m &a, const Point3m &b) {
            if (!isHere[k])
                return;
            Point3m &sum = mesh.vert[slot[k]].N();
            if (!isClear[slot[k] - first])
                sum.SetZero();
            isClear[slot[k] - first] = 1;
            if (face.IsR())
                sum += normal * vcg::AngleN(a, b);
        };
        add(0, e0, -e2);
        add(1, -e0, e1);
        add(2, -e1, e2);
    }
}

} // namespace

void computeFaceNormals(CMeshO &mesh, const std::vector<char> &moving) {
    ParallelFor(0, mesh.face.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            CFaceO &face = mesh.face[f];
            for (int k = 0; k < 3; ++k)
                prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
            bool moves = moving.empty();
            for (int k = 0; k < 3 && !moves; ++k)
                moves = moving[std::size_t(face.cV(k) - mesh.vert.data())] != 0;
            if (moves && !face.IsD())
                face.N() = vcg::TriangleNormal(face).Normalize();
        }
    });
}

void computeBoxAndNormals(CMeshO &mesh) {
    std::mutex lock;
    mesh.bbox.SetNull();
    ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        vcg::Box3<Scalarm> box;
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD())
                box.Add(mesh.vert[i].cP());
        const std::lock_guard<std::mutex> guard(lock);
        mesh.bbox.Add(box);
    });
    if (mesh.fn == 0)
        return;
    // A range of vertices each thread, which looks at all faces: in most meshes the vertices of a face are close.
    const std::size_t threads = std::max(1u, std::thread::hardware_concurrency());
    ParallelFor(0, mesh.vert.size(), mesh.vert.size() / threads + 1,
                [&](std::size_t first, std::size_t last) { computeNormals(mesh, first, last); });
}

bool hasOwnNormals(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    if (mesh.fn == 0)
        return std::any_of(mesh.vert.begin(), mesh.vert.end(),
                           [](const CVertexO &v) { return !v.IsD() && v.cN().SquaredNorm() > 0; });
    // At a sample of vertices: the sums of the normals of the faces, weighed by area and by angle, as programs do.
    std::size_t step = 1; // a power of two
    while (step < mesh.vert.size() / 4096)
        step *= 2;
    std::vector<Eigen::Vector3d> byArea(mesh.vert.size() / step + 1, Eigen::Vector3d::Zero()), byAngle = byArea;
    const std::vector<std::size_t> corners = vcg::fcd::CollectInOrder<std::size_t>(
        Progress(), "", Index(mesh.face.size()), [&](Index f, std::vector<std::size_t> &found) {
            const CFaceO &face = mesh.face[std::size_t(f)];
            for (std::size_t k = 0; !face.IsD() && k < 3; ++k)
                if ((vcg::tri::Index(mesh, face.cV(int(k))) & (step - 1)) == 0)
                    found.push_back(3 * std::size_t(f) + k);
        });
    for (std::size_t corner : corners) {
        const CFaceO &face = mesh.face[corner / 3];
        const int k = int(corner % 3);
        const std::size_t i = vcg::tri::Index(mesh, face.cV(k));
        const Eigen::Vector3d p = vcg::tri::PositionOf(*face.cV(k)),
                              a = vcg::tri::PositionOf(*face.cV((k + 1) % 3)) - p,
                              b = vcg::tri::PositionOf(*face.cV((k + 2) % 3)) - p, n = a.cross(b);
        byArea[i / step] += n;
        byAngle[i / step] += std::atan2(n.norm(), a.dot(b)) * n.stableNormalized();
    }
    const double near = std::cos(5 * double(EIGEN_PI) / 180); // rounding and other weights stay below
    std::size_t all = 0, other = 0;
    for (std::size_t i = 0; i < mesh.vert.size(); i += step) {
        const auto &n = mesh.vert[i].cN();
        const Eigen::Vector3d own = Eigen::Vector3d(n[0], n[1], n[2]).stableNormalized();
        if (mesh.vert[i].IsD() || byArea[i / step].isZero(0) || own.isZero(0))
            continue;
        ++all;
        other +=
            own.dot(byArea[i / step].stableNormalized()) < near && own.dot(byAngle[i / step].stableNormalized()) < near;
    }
    return 2 * other > all;
}
