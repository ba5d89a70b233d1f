// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_ANGLE_NORMALS_H
#define FCD_ANGLE_NORMALS_H

#include <vcg_ext/base/angle.h>
#include <vcg_ext/base/parallel.h>

#include <vcg/complex/complex.h>
#include <vcg/space/triangle3.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

/// Begins to read memory that is needed soon.
inline void prefetch(const void *memory) {
#ifdef __GNUC__
    __builtin_prefetch(memory);
#else
    (void)memory;
#endif
}

/// What computeAngleNormals does, with angles to 1e-7, for the normals of faces that have a vertex with a flag in
/// \p flags (one per slot), and of these vertices; all others keep theirs. The same bits with any number of threads.
/// Needs no other memory than \p isClear, one 0 per slot.
template <class MeshType>
void computeFlaggedNormals(MeshType &mesh, const std::vector<char> &flags, std::vector<char> &isClear) {
    using Scalar = typename MeshType::ScalarType;
    using Face = typename MeshType::FaceType;
    using Point = typename MeshType::CoordType;
    constexpr std::size_t grain = 1024;
    std::atomic<std::size_t> added{0}; // faces
    vcg::fcd::ParallelFor(0, mesh.face.size(), grain, [&](std::size_t first, std::size_t last) {
        float angle[3][grain];
        std::uint32_t slot[3][grain]; // of those that have flags
        int count = 0;
        std::uint16_t face[grain];
        for (std::size_t f = first; f < last; ++f) {
            Face &each = mesh.face[f];
            for (int k = 0; k < 3; ++k)
                prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
            if (each.IsD())
                continue;
            std::uint32_t corner[3];
            char any = 0;
            for (int k = 0; k < 3; ++k) {
                corner[k] = std::uint32_t(each.cV(k) - mesh.vert.data());
                any |= flags[corner[k]];
            }
            if (!any)
                continue;
            const Point e0 = each.cP(1) - each.cP(0), e1 = each.cP(2) - each.cP(1), e2 = each.cP(0) - each.cP(2);
            const Point normal = e0 ^ -e2;
            const Scalar length = normal.Norm();
            const Scalar scale = length > 0 ? 1 / length : 0;
            each.N() = normal * scale;
            angle[0][count] = float(-(e0 * e2) * scale);
            angle[1][count] = float(-(e1 * e0) * scale);
            for (int k = 0; k < 3; ++k)
                slot[k][count] = corner[k];
            face[count++] = std::uint16_t(f - first);
        }
        for (int i = 0; i < count; ++i) {
            angle[0][i] = vcg::fcd::AngleOfCotangent(angle[0][i]);
            angle[1][i] = vcg::fcd::AngleOfCotangent(angle[1][i]);
            angle[2][i] = 3.14159265f - angle[0][i] - angle[1][i];
        }
        while (added.load(std::memory_order_acquire) != first) // whoever has the range before is at it
            std::this_thread::yield();
        for (int i = 0; i < count; ++i) {
            const Face &each = mesh.face[first + face[i]];
            const Point normal = each.cN();
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t vertex = slot[k][i];
                if (!flags[vertex])
                    continue;
                Point &sum = mesh.vert[vertex].N();
                if (!isClear[vertex])
                    sum.SetZero();
                isClear[vertex] = 1;
                sum += normal * Scalar(angle[k][i]);
            }
        }
        added.store(last, std::memory_order_release);
    });
}

/// What vcg::tri::UpdateNormal::PerFaceNormalized and PerVertexAngleWeighted do, to the bit: the normal of a vertex is
/// the sum of those of its faces, in the order of these, times their angles there. Vertices without a face keep theirs.
///
/// Each face is visited once, for any number of threads (0 = one a core): they compute normals and angles of different
/// ranges of faces, and add them up one range after the other, which takes a small part of the time.
template <class MeshType>
void computeAngleNormals(MeshType &mesh, unsigned threads) {
    using Face = typename MeshType::FaceType;
    using Point = typename MeshType::CoordType;
    constexpr std::size_t grain = 1024;
    std::vector<char> isClear(mesh.vert.size(), 0);
    std::atomic<std::size_t> added{0}; // faces
    vcg::fcd::ParallelFor(threads, mesh.face.size(), grain, [&](std::size_t first, std::size_t last) {
        typename MeshType::ScalarType angle[grain][3]; // not on the heap: who throws leaves the others waiting
        for (std::size_t f = first; f < last; ++f) {
            Face &face = mesh.face[f];
            for (int k = 0; k < 3; ++k)
                prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
            if (face.IsD())
                continue;
            const auto way = [&](int k) {
                Point edge = face.cP((k + 1) % 3) - face.cP(k);
                return edge.Normalize();
            };
            const Point e0 = way(0), e1 = way(1), e2 = way(2);
            face.N() = vcg::TriangleNormal(face).Normalize();
            angle[f - first][0] = vcg::AngleN(e0, -e2);
            angle[f - first][1] = vcg::AngleN(-e0, e1);
            angle[f - first][2] = vcg::AngleN(-e1, e2);
        }
        while (added.load(std::memory_order_acquire) != first) // whoever has the range before is at it
            std::this_thread::yield();
        for (std::size_t f = first; f < last; ++f) {
            const Face &face = mesh.face[f];
            if (face.IsD())
                continue;
            for (int k = 0; k < 3; ++k) {
                const std::size_t slot = std::size_t(face.cV(k) - mesh.vert.data());
                Point &sum = mesh.vert[slot].N();
                if (!isClear[slot])
                    sum.SetZero();
                isClear[slot] = 1;
                if (face.IsR())
                    sum += face.cN() * angle[f - first][k];
            }
        }
        added.store(last, std::memory_order_release);
    });
}

#endif
