// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_ANGLE_NORMALS_H
#define FCD_ANGLE_NORMALS_H

#include <vcg_ext/base/angle.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/parallel.h>

#include <vcg/complex/complex.h>
#include <vcg/space/triangle3.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Faces of a range, whose normals and angles one thread computes.
constexpr std::size_t facesOfRange = 1024;

/// The memory of computeFlaggedNormals, allocated before anything is changed.
struct FlaggedFaces {
    /// The faces of a range that have a vertex with a flag.
    struct Range {
        float angle[3][facesOfRange];
        std::uint32_t slot[3][facesOfRange];
        std::uint16_t face[facesOfRange]; ///< counted from the first of the range
        int count;
    };
    std::vector<char> isClear; ///< flags of the vertices' slots: the sum of the normals has begun
    vcg::fcd::RangeResults<Range> range;

    FlaggedFaces(std::size_t vertices, std::size_t faces) : isClear(vertices, 0), range(faces, facesOfRange) {}
};

/// Like computeAngleNormals, with angles to 1e-7, but only for vertices with a flag in \p flags (one per slot), and
/// faces with such a vertex. The same bits for any number of threads.
/// \param memory for the mesh's vertices and faces, not used before
template <class MeshType>
void computeFlaggedNormals(MeshType &mesh, const std::vector<char> &flags, FlaggedFaces &memory) {
    using Scalar = typename MeshType::ScalarType;
    using Face = typename MeshType::FaceType;
    using Point = typename MeshType::CoordType;
    const auto compute = [&](std::size_t first, std::size_t last) {
        FlaggedFaces::Range &range = memory.range.Of(first);
        int count = 0;
        for (std::size_t f = first; f < last; ++f) {
            Face &each = mesh.face[f];
            for (int k = 0; k < 3; ++k)
                vcg::fcd::Prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
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
            const FlaggedFaces::Range &range = memory.range.Of(begin);
            for (int i = 0; i < range.count; ++i) {
                const Point normal = mesh.face[begin + range.face[i]].cN();
                for (int k = 0; k < 3; ++k) {
                    const std::uint32_t vertex = range.slot[k][i];
                    if (!flags[vertex])
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
    vcg::fcd::ParallelForAdding(0, mesh.face.size(), facesOfRange, compute, add);
}

/// Normals of faces and vertices, with the bits of vcg::tri::UpdateNormal::PerFaceNormalized and
/// PerVertexAngleWeighted, for any number of threads (0 = one a core): the normal of a vertex is the sum of its faces'
/// normals times their angles, in the order of the faces. Vertices without a face keep theirs.
template <class MeshType>
void computeAngleNormals(MeshType &mesh, unsigned threads) {
    using Face = typename MeshType::FaceType;
    using Point = typename MeshType::CoordType;
    using Angles = typename MeshType::ScalarType[facesOfRange][3];
    std::vector<char> isClear(mesh.vert.size(), 0);
    const vcg::fcd::RangeResults<Angles> angles(mesh.face.size(), facesOfRange);
    const auto angleOf = [&](std::size_t f) { return angles.Of(f)[f % facesOfRange]; };
    const auto compute = [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            Face &face = mesh.face[f];
            for (int k = 0; k < 3; ++k)
                vcg::fcd::Prefetch(mesh.face[std::min(f + 16, last - 1)].cV(k));
            if (face.IsD())
                continue;
            const auto direction = [&](int k) {
                Point edge = face.cP((k + 1) % 3) - face.cP(k);
                return edge.Normalize();
            };
            const Point e0 = direction(0), e1 = direction(1), e2 = direction(2);
            face.N() = vcg::TriangleNormal(face).Normalize();
            angleOf(f)[0] = vcg::AngleN(e0, -e2);
            angleOf(f)[1] = vcg::AngleN(-e0, e1);
            angleOf(f)[2] = vcg::AngleN(-e1, e2);
        }
    };
    const auto add = [&](std::size_t first, std::size_t last) {
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
                    sum += face.cN() * angleOf(f)[k];
            }
        }
    };
    vcg::fcd::ParallelForAdding(threads, mesh.face.size(), facesOfRange, compute, add);
}

#endif
