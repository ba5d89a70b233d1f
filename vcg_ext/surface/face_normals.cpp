// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/angle.h>
#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/parallel.h>
#include <vcg_ext/surface/face_normals.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace vcg::fcd {

namespace {

constexpr std::size_t grainOfFaces = 1024; // with fewer faces a turn, waiting for turns would cost more

/// Normals of some faces, and their angles at the corners; the normal of a face without an area is 0.
struct FacesOfRange {
    Eigen::Vector3d normal[grainOfFaces];
    float angle[3][grainOfFaces];

    void Compute(const SurfaceView &surface, const double *position, std::size_t first, std::size_t count) {
        using Position = Eigen::Map<const Eigen::Vector3d>;
        for (std::size_t f = 0; f < count; ++f) {
            if (!surface.IsFace(first + f)) {
                normal[f].setZero();
                angle[0][f] = angle[1][f] = 0;
                continue;
            }
            const std::uint32_t *corner = surface.corner + 3 * (first + f);
            const Eigen::Vector3d p = Position(position + 3 * std::size_t(corner[0]));
            Eigen::Vector3d a = Position(position + 3 * std::size_t(corner[1])) - p,
                            b = Position(position + 3 * std::size_t(corner[2])) - p, cross = a.cross(b);
            double length = cross.norm();
            if (!(length > 1e-100 && length < 1e100)) { // then its square may be no number
                const double unit = detail::UnitOf(std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff()));
                a /= unit;
                b /= unit;
                cross = a.cross(b);
                length = cross.norm();
            }
            const double scale = length > 0 ? 1 / length : 0;
            normal[f] = cross * scale;
            angle[0][f] = float(a.dot(b) * scale);
            angle[1][f] = float(a.dot(a - b) * scale);
        }
        for (std::size_t f = 0; f < count; ++f) {
            angle[0][f] = AngleOfCotangent(angle[0][f]);
            angle[1][f] = AngleOfCotangent(angle[1][f]);
            angle[2][f] = 3.14159265f - angle[0][f] - angle[1][f];
        }
    }
};

} // namespace

void FaceNormals(const SurfaceView &surface, const double *position, double *normal, unsigned threads) {
    const std::size_t n = surface.vertexSlots;
    ParallelFor(threads, n, 1 << 16,
                [&](std::size_t first, std::size_t last) { std::fill(normal + 3 * first, normal + 3 * last, 0.0); });
    // In the order of the faces: the same bits for any number of threads.
    const RangeResults<FacesOfRange> faces(surface.faces, grainOfFaces);
    ParallelForAdding(
        threads, surface.faces, grainOfFaces,
        [&](std::size_t first, std::size_t last) { faces.Of(first).Compute(surface, position, first, last - first); },
        [&](std::size_t first, std::size_t last) {
            for (std::size_t f = first; f < last; ++f)
                for (std::size_t k = 0; surface.IsFace(f) && k < 3; ++k)
                    Eigen::Map<Eigen::Vector3d>(normal + 3 * std::size_t(surface.corner[3 * f + k])) +=
                        faces.Of(f).normal[f % grainOfFaces] * double(faces.Of(f).angle[k][f % grainOfFaces]);
        });
    ParallelForEach(threads, n, 1 << 14, [&](std::size_t i) {
        Eigen::Map<Eigen::Vector3d> sum(normal + 3 * i);
        const double length = sum.norm(); // no overflow: it is at most a sum of angles
        if (length > 0)
            sum /= length;
    });
}

} // namespace vcg::fcd
