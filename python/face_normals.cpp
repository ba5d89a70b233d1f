// SPDX-License-Identifier: GPL-3.0-or-later
#include "prepared.h"

#include <atomic>
#include <cmath>
#include <thread>

using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;

namespace {

/// The normal of a face times its angles at the corners; 0 for one without an area.
void weighNormal(const double *position, const std::uint32_t *corner, Eigen::Vector3d *weighed) {
    const Eigen::Vector3d p = rowOf(position, corner[0]), q = rowOf(position, corner[1]),
                          r = rowOf(position, corner[2]);
    const Eigen::Vector3d a = q - p, b = r - p, c = r - q, cross = a.cross(b);
    const double length = cross.norm();
    if (!(length > 0)) {
        weighed[0].setZero();
        weighed[1].setZero();
        weighed[2].setZero();
        return;
    }
    const double first = std::atan2(length, a.dot(b)), second = std::atan2(length, -a.dot(c));
    const Eigen::Vector3d normal = cross / length;
    weighed[0] = first * normal;
    weighed[1] = second * normal;
    weighed[2] = (double(EIGEN_PI) - first - second) * normal;
}

} // namespace

nb::object Prepared::normalsOf(const Rows &positions, const std::optional<Written> &out) const {
    constexpr std::size_t grain = 512;
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
            Eigen::Vector3d weighed[3 * grain]; // not on the heap: who throws leaves the others waiting
            for (std::size_t f = first; f < last; ++f)
                weighNormal(position, view.corner + 3 * f, weighed + 3 * (f - first));
            while (added.load(std::memory_order_acquire) != first)
                std::this_thread::yield();
            for (std::size_t corner = 3 * first; corner < 3 * last; ++corner)
                rowOf(normal, view.corner[corner]) += weighed[corner - 3 * first];
            added.store(last, std::memory_order_release);
        });
        ParallelFor(progress.threads, n, 1 << 14, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                rowOf(normal, i).stableNormalize();
        });
    });
    return normals;
}
