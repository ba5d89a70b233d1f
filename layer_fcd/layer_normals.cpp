// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // these before Qt
#include <vcg_ext/surface/read_surface.h>

#include "angle_normals.h"
#include "layer_normals.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <mutex>

using vcg::fcd::Index;
using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;

void computeFaceNormals(CMeshO &mesh, const std::vector<char> &moving) {
    ParallelFor(0, mesh.face.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            CFaceO &face = mesh.face[f];
            for (int k = 0; k < 3; ++k)
                vcg::fcd::Prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
            bool moves = moving.empty();
            for (int k = 0; k < 3 && !moves; ++k)
                moves = moving[std::size_t(face.cV(k) - mesh.vert.data())] != 0;
            if (moves && !face.IsD())
                face.N() = vcg::TriangleNormal(face).Normalize();
        }
    });
}

std::vector<char> verticesBeside(const CMeshO &mesh, const std::vector<char> &moving) {
    std::vector<char> beside = moving;
    for (const CFaceO &face : mesh.face) {
        if (face.IsD())
            continue;
        std::size_t corner[3];
        for (int k = 0; k < 3; ++k)
            corner[k] = vcg::tri::Index(mesh, face.cV(k));
        if (moving[corner[0]] || moving[corner[1]] || moving[corner[2]])
            for (std::size_t slot : corner)
                beside[slot] = 1;
    }
    return beside;
}

void computeNormals(CMeshO &mesh, unsigned threads) {
    if (mesh.fn > 0)
        computeAngleNormals(mesh, threads);
}

void computeBoxAndNormals(CMeshO &mesh, unsigned threads) {
    std::mutex lock;
    mesh.bbox.SetNull();
    ParallelFor(threads, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        vcg::Box3<Scalarm> box;
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD())
                box.Add(mesh.vert[i].cP());
        const std::lock_guard<std::mutex> guard(lock);
        mesh.bbox.Add(box);
    });
    computeNormals(mesh, threads);
}

double shareOfOtherNormals(const MeshModel &layer, double degrees) {
    const CMeshO &mesh = layer.cm;
    std::size_t step = 1; // a power of two
    while (step < mesh.vert.size() / 4096)
        step *= 2;
    std::vector<Eigen::Vector3d> byArea(mesh.vert.size() / step + 1, Eigen::Vector3d::Zero()), byAngle = byArea;
    const std::vector<std::size_t> corners = vcg::fcd::CollectInOrder<std::size_t>(
        Progress(), "", Index(mesh.face.size()), [&](Index f, std::vector<std::size_t> &found) {
            vcg::fcd::Prefetch(&mesh.face[std::min(std::size_t(f) + 16, mesh.face.size() - 1)]);
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
    const double near = std::cos(degrees * double(EIGEN_PI) / 180);
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
    return all > 0 ? double(other) / double(all) : 0;
}

bool hasOwnNormals(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    if (mesh.fn == 0)
        return std::any_of(mesh.vert.begin(), mesh.vert.end(),
                           [](const CVertexO &v) { return !v.IsD() && v.cN().SquaredNorm() > 0; });
    return shareOfOtherNormals(layer, 5) > 0.5; // rounding and other weights stay below
}
