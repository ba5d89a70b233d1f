// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/graph.h> // these before Qt
#include <vcg_ext/surface/read_surface.h>

#include "angle_normals.h"
#include "layer_normals.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

using vcg::fcd::ParallelFor;

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

namespace {

/// The terms of a range of faces in the sums of their corners' normals.
struct NormalTerms {
    Eigen::Vector3d normal[facesOfRange];
    double weight[facesOfRange][3]; ///< 0: that vertex is not asked for
};

} // namespace

bool hasOtherNormals(const MeshModel &layer, double degrees, double share) {
    const CMeshO &mesh = layer.cm;
    const double near = std::cos(degrees * double(EIGEN_PI) / 180);
    std::vector<char> isAsked(mesh.vert.size(), 1); // then, whether a normal is far from those by area
    std::size_t all = 0;
    for (const bool byAngle : {false, true}) {
        std::vector<Eigen::Vector3d> sum(mesh.vert.size(), Eigen::Vector3d::Zero());
        const vcg::fcd::RangeResults<NormalTerms> terms(mesh.face.size(), facesOfRange);
        const auto compute = [&](std::size_t first, std::size_t last) {
            NormalTerms &range = terms.Of(first);
            for (std::size_t f = first; f < last; ++f) {
                const CFaceO &face = mesh.face[f];
                for (int k = 0; k < 3; ++k)
                    vcg::fcd::Prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
                double(&weight)[3] = range.weight[f - first];
                bool isAny = false;
                for (int k = 0; k < 3; ++k) {
                    weight[k] = face.IsD() ? 0 : isAsked[vcg::tri::Index(mesh, face.cV(k))];
                    isAny = isAny || weight[k] > 0;
                }
                if (!isAny)
                    continue;
                const Eigen::Vector3d p = vcg::tri::PositionOf(*face.cV(0)), a = vcg::tri::PositionOf(*face.cV(1)) - p,
                                      b = vcg::tri::PositionOf(*face.cV(2)) - p, n = a.cross(b);
                range.normal[f - first] = n;
                if (!byAngle)
                    continue;
                const double length = n.stableNorm(), scale = length > 0 ? 1 / length : 0;
                const float atP = vcg::fcd::AngleOfCotangent(float(a.dot(b) * scale)),
                            atA = vcg::fcd::AngleOfCotangent(float(a.dot(a - b) * scale));
                range.normal[f - first] *= scale;
                weight[0] *= atP;
                weight[1] *= atA;
                weight[2] *= float(EIGEN_PI) - atP - atA;
            }
        };
        const auto add = [&](std::size_t first, std::size_t last) {
            const NormalTerms &range = terms.Of(first);
            for (std::size_t f = first; f < last; ++f)
                for (int k = 0; k < 3; ++k)
                    if (const double weight = range.weight[f - first][k]; weight > 0)
                        sum[vcg::tri::Index(mesh, mesh.face[f].cV(k))] += weight * range.normal[f - first];
        };
        vcg::fcd::ParallelForAdding(0, mesh.face.size(), facesOfRange, compute, add);
        std::atomic<std::size_t> asked = 0, other = 0;
        ParallelFor(0, mesh.vert.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
            std::size_t askedHere = 0, otherHere = 0;
            for (std::size_t i = first; i < last; ++i) {
                const auto &n = mesh.vert[i].cN();
                const Eigen::Vector3d own(n[0], n[1], n[2]);
                isAsked[i] = isAsked[i] && !mesh.vert[i].IsD() && !own.isZero(0) && !sum[i].isZero(0);
                askedHere += std::size_t(isAsked[i]);
                isAsked[i] = isAsked[i] && own.stableNormalized().dot(sum[i].stableNormalized()) < near;
                otherHere += std::size_t(isAsked[i]);
            }
            asked += askedHere;
            other += otherHere;
        });
        all = byAngle ? all : std::size_t(asked);
        if (double(other) <= share * double(all))
            return false;
    }
    return true;
}

bool hasOwnNormals(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    if (mesh.fn == 0)
        return std::any_of(mesh.vert.begin(), mesh.vert.end(),
                           [](const CVertexO &v) { return !v.IsD() && v.cN().SquaredNorm() > 0; });
    return hasOtherNormals(layer, 5, 0.5); // rounding and other weights stay below
}
