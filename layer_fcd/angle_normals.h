// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_ANGLE_NORMALS_H
#define FCD_ANGLE_NORMALS_H

#include <vcg_ext/base/angle.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/parallel.h>

#include <vcg/complex/complex.h>
#include <vcg/space/triangle3.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Ranges of faces whose normals and angles are computed by any thread.
constexpr std::size_t facesOfRange = 1024;

/// What computeAngleNormals needs of memory, so that it can be had before anything is changed.
struct FacesOfNormals {
    /// Of the faces of a range, those that have a vertex with a flag.
    struct Range {
        float angle[3][facesOfRange];
        std::uint32_t slot[3][facesOfRange];
        std::uint16_t face[facesOfRange]; ///< counted from the first of the range
        int count;
    };
    std::vector<char> isClear; ///< flags of the vertices' slots: the sum of the normals is begun
    vcg::fcd::RangeResults<Range> range;

    FacesOfNormals(std::size_t vertices, std::size_t faces) : isClear(vertices, 0), range(faces, facesOfRange) {}
};

/// The normals of faces, of length 1, and of vertices: the sum of those of their faces, in the order of these, times
/// their angles there, to 1e-7, as vcg::tri::UpdateNormal's PerFaceNormalized and PerVertexAngleWeighted make them.
/// Vertices without a face keep theirs.
///
/// Each face is visited once, for any number of threads (0 = one a core): they compute normals and angles of different
/// ranges of faces, and add them up one range after the other, which takes a small part of the time.
/// \param flags per vertex slot; only of the faces that have a vertex with one, and of these vertices; empty: of all
/// \param memory for the mesh's vertices and faces, not yet used
template <class MeshType>
void computeAngleNormals(MeshType &mesh, const std::vector<char> &flags, FacesOfNormals &memory, unsigned threads = 0) {
    using Scalar = typename MeshType::ScalarType;
    using Face = typename MeshType::FaceType;
    using Point = typename MeshType::CoordType;
    const auto hasFlag = [&](std::uint32_t vertex) { return flags.empty() || flags[vertex] != 0; };
    const auto compute = [&](std::size_t first, std::size_t last) {
        FacesOfNormals::Range &range = memory.range.Of(first);
        int count = 0;
        for (std::size_t f = first; f < last; ++f) {
            Face &each = mesh.face[f];
            for (int k = 0; k < 3; ++k)
                vcg::fcd::Prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
            if (each.IsD())
                continue;
            std::uint32_t corner[3];
            for (int k = 0; k < 3; ++k)
                corner[k] = std::uint32_t(each.cV(k) - mesh.vert.data());
            if (!hasFlag(corner[0]) && !hasFlag(corner[1]) && !hasFlag(corner[2]))
                continue;
            const Point e0 = each.cP(1) - each.cP(0), e1 = each.cP(2) - each.cP(1), e2 = each.cP(0) - each.cP(2);
            const Point normal = e0 ^ -e2;
            const Scalar length = normal.Norm();
            const Scalar scale = length > 0 ? 1 / length : 0;
            each.N() = normal * scale;
            range.angle[0][count] = float(-(e0 * e2) * scale);
            range.angle[1][count] = float(-(e1 * e0) * scale);
            for (int k = 0; k < 3; ++k)
                range.slot[k][count] = corner[k];
            range.face[count++] = std::uint16_t(f - first);
        }
        for (int i = 0; i < count; ++i) {
            range.angle[0][i] = vcg::fcd::AngleOfCotangent(range.angle[0][i]);
            range.angle[1][i] = vcg::fcd::AngleOfCotangent(range.angle[1][i]);
            range.angle[2][i] = 3.14159265f - range.angle[0][i] - range.angle[1][i];
        }
        range.count = count;
    };
    const auto add = [&](std::size_t first, std::size_t last) {
        for (std::size_t begin = first; begin < last; begin += facesOfRange) {
            const FacesOfNormals::Range &range = memory.range.Of(begin);
            for (int i = 0; i < range.count; ++i) {
                const Point normal = mesh.face[begin + range.face[i]].cN();
                for (int k = 0; k < 3; ++k) {
                    const std::uint32_t vertex = range.slot[k][i];
                    if (!hasFlag(vertex))
                        continue;
                    Point &sum = mesh.vert[vertex].N();
                    if (!memory.isClear[vertex])
                        sum.SetZero();
                    memory.isClear[vertex] = 1;
                    sum += normal * Scalar(range.angle[k][i]);
                }
            }
        }
    };
    vcg::fcd::ParallelForAdding(threads, mesh.face.size(), facesOfRange, compute, add);
}

#endif
