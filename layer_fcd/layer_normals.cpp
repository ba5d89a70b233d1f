// SPDX-License-Identifier: GPL-3.0-or-later
#include "angle_normals.h"
#include "layer_normals.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <utility>

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

void computeNormals(CMeshO &mesh) {
    if (mesh.fn > 0)
        computeAngleNormals(mesh, 0);
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
    computeNormals(mesh);
}

namespace {

struct NormalCount {
    std::size_t all = 0, other = 0; ///< vertices at faces with a normal; those far from the faces' normals
};

/// Counts the vertices that isAsked(slot) asks for. \param near cosine of the angle beyond which a normal is far
template <class Asked>
NormalCount countOtherNormals(const CMeshO &mesh, double near, const Asked &isAsked) {
    using Corner = std::pair<std::size_t, std::size_t>; // of a vertex: its number, and three times the face's plus k
    std::vector<Corner> corners = vcg::fcd::CollectInOrder<Corner>(
        Progress(), "", mesh.face.size(), [&](std::size_t f, std::vector<Corner> &found) {
            vcg::fcd::Prefetch(&mesh.face[std::min(f + 16, mesh.face.size() - 1)]);
            const CFaceO &face = mesh.face[f];
            for (std::size_t k = 0; !face.IsD() && k < 3; ++k)
                if (const std::size_t i = vcg::tri::Index(mesh, face.cV(int(k))); isAsked(i))
                    found.emplace_back(i, 3 * f + k);
        });
    std::sort(corners.begin(), corners.end());
    NormalCount count;
    for (std::size_t c = 0; c < corners.size();) {
        const std::size_t i = corners[c].first;
        Eigen::Vector3d byArea(0, 0, 0), byAngle(0, 0, 0);
        for (; c < corners.size() && corners[c].first == i; ++c) {
            const CFaceO &face = mesh.face[corners[c].second / 3];
            const int k = int(corners[c].second % 3);
            const Eigen::Vector3d p = vcg::tri::PositionOf(*face.cV(k)),
                                  a = vcg::tri::PositionOf(*face.cV((k + 1) % 3)) - p,
                                  b = vcg::tri::PositionOf(*face.cV((k + 2) % 3)) - p, n = a.cross(b);
            byArea += n;
            byAngle += std::atan2(n.norm(), a.dot(b)) * n.stableNormalized();
        }
        const auto &n = mesh.vert[i].cN();
        const Eigen::Vector3d own = Eigen::Vector3d(n[0], n[1], n[2]).stableNormalized();
        if (byArea.isZero(0) || own.isZero(0))
            continue;
        ++count.all;
        count.other += own.dot(byArea.stableNormalized()) < near && own.dot(byAngle.stableNormalized()) < near;
    }
    return count;
}

} // namespace

bool hasOtherNormals(const MeshModel &layer, double degrees, double share) {
    const CMeshO &mesh = layer.cm;
    const double near = std::cos(degrees * double(EIGEN_PI) / 180);
    const std::size_t several = mesh.vert.size() >> 12; // some 4000 vertices are mostly enough
    if (several > 1) {
        const NormalCount some = countOtherNormals(mesh, near, [several](std::size_t i) {
            return (std::uint64_t(i) * 0x9E3779B97F4A7C15u >> 32) % several == 0;
        });
        const double expected = share * double(some.all);
        if (std::abs(double(some.other) - expected) > 6 * std::sqrt(expected * (1 - share))) // standard deviations
            return double(some.other) > expected;
    }
    const NormalCount every = countOtherNormals(mesh, near, [](std::size_t) { return true; });
    return double(every.other) > share * double(every.all);
}

bool hasOwnNormals(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    if (mesh.fn == 0)
        return std::any_of(mesh.vert.begin(), mesh.vert.end(),
                           [](const CVertexO &v) { return !v.IsD() && v.cN().SquaredNorm() > 0; });
    return hasOtherNormals(layer, 5, 0.5); // rounding and other weights stay below
}
