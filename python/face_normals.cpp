// SPDX-License-Identifier: GPL-3.0-or-later
#include "prepared.h"

#include <vcg_ext/base/angle.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <thread>

using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;

namespace {

constexpr std::size_t grain = 512;

/// Normals of some faces, and their angles at the corners; the normal of a face without an area is 0.
struct Faces {
    Eigen::Vector3d normal[grain];
    float angle[3][grain];

    void compute(const double *position, const std::uint32_t *corner, std::size_t count) {
        for (std::size_t f = 0; f < count; ++f, corner += 3) {
            const Eigen::Vector3d p = rowOf(position, corner[0]), a = rowOf(position, corner[1]) - p,
                                  b = rowOf(position, corner[2]) - p, cross = a.cross(b);
            const double length = cross.norm(), scale = length > 0 ? 1 / length : 0;
            normal[f] = cross * scale;
            angle[0][f] = float(a.dot(b) * scale);
            angle[1][f] = float(a.dot(a - b) * scale);
        }
        for (std::size_t f = 0; f < count; ++f) {
            angle[0][f] = vcg::fcd::AngleOfCotangent(angle[0][f]);
            angle[1][f] = vcg::fcd::AngleOfCotangent(angle[1][f]);
            angle[2][f] = 3.14159265f - angle[0][f] - angle[1][f];
        }
    }
};

} // namespace

nb::object Prepared::normalsOf(const Rows &positions, const std::optional<Written> &out) const {
    const std::size_t n = view.vertexSlots;
    double *normal;
    nb::object normals = out ? nb::cast(*out) : newArray({n, 3}, normal);
    if (out)
        normal = out->data();
    const double *position = positions.data();
    Listener::Run(nb::none(), threads, [&](const Progress &progress) {
        ParallelFor(progress.threads, n, 1 << 16, [&](std::size_t first, std::size_t last) {
            std::fill(normal + 3 * first, normal + 3 * last, 0.0);
        });
        // Ranges of faces are computed by all threads, and added up one after the other: the same bits for any number.
        std::atomic<std::size_t> added{0}; // faces
        ParallelFor(progress.threads, view.faces, grain, [&](std::size_t first, std::size_t last) {
            Faces faces; // not on the heap: who throws leaves the others waiting
            faces.compute(position, view.corner + 3 * first, last - first);
            while (added.load(std::memory_order_acquire) != first)
                std::this_thread::yield();
            for (std::size_t f = first; f < last; ++f)
                for (std::size_t k = 0; k < 3; ++k)
                    rowOf(normal, view.corner[3 * f + k]) +=
                        faces.normal[f - first] * double(faces.angle[k][f - first]);
            added.store(last, std::memory_order_release);
        });
        ParallelFor(progress.threads, n, 1 << 14, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const double length = rowOf(normal, i).norm(); // the sum of a few angles at most
                if (length > 0)
                    rowOf(normal, i) /= length;
            }
        });
    });
    return normals;
}
