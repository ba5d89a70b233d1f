// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/triangle_stretch.h> // before Qt

#include "edit_fcd/view/stretch_colors.h"

#include <layer_fcd/parameters.h>

#include <algorithm>
#include <atomic>
#include <cmath>

vcg::Color4b colorOfStretch(double exponent) {
    const double pressed[] = {30, 80, 220}, none[] = {225, 225, 225}, stretched[] = {215, 35, 35};
    const double *full = exponent < 0 ? pressed : stretched, part = std::min(1.0, std::abs(exponent));
    const auto mixed = [&](int i) { return (unsigned char)std::lround(none[i] + part * (full[i] - none[i])); };
    return vcg::Color4b(mixed(0), mixed(1), mixed(2), 255);
}

StretchColors::StretchColors(const MeshModel &layer) : layer(layer) { connect(); }

/// Finds the faces of each vertex, by all threads.
void StretchColors::connect() {
    const CMeshO &mesh = layer.cm;
    const std::size_t grain = 1 << 13;
    std::vector<std::atomic<std::uint32_t>> next(mesh.vert.size()); // number of faces, then the next free entry
    const auto forCorners = [&](const auto &body) {
        vcg::fcd::ParallelFor(0, mesh.face.size(), grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t f = first; f < last; ++f)
                for (int k = 0; k < 3 && !mesh.face[f].IsD(); ++k)
                    body(next[std::size_t(mesh.face[f].cV(k) - mesh.vert.data())], std::uint32_t(f));
        });
    };
    for (auto &each : next)
        each.store(0, std::memory_order_relaxed);
    forCorners([](auto &number, std::uint32_t) { number.fetch_add(1, std::memory_order_relaxed); });
    begin.resize(next.size() + 1);
    std::uint32_t sum = 0;
    for (std::size_t i = 0; i < next.size(); ++i) {
        begin[i] = sum;
        sum += next[i].exchange(sum, std::memory_order_relaxed);
    }
    begin.back() = sum;
    faceOf.resize(sum);
    forCorners([&](auto &place, std::uint32_t f) { faceOf[place.fetch_add(1, std::memory_order_relaxed)] = f; });
    vcg::fcd::ParallelFor(0, next.size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            std::sort(faceOf.begin() + begin[i], faceOf.begin() + begin[i + 1]);
    });
}

std::vector<vcg::Color4b> StretchColors::of(const std::vector<Point3m> &rest, const Eigen::Matrix3d &world,
                                            unsigned char opacity) {
    const CMeshO &mesh = layer.cm;
    const std::size_t grain = 1 << 13;
    const auto slotOf = [&](const CFaceO &face, int k) { return std::size_t(face.cV(k) - mesh.vert.data()); };
    std::vector<vcg::Color4b> color(mesh.vert.size());
    exponent.assign(mesh.face.size(), 0);
    area.assign(mesh.face.size(), 0);
    vcg::fcd::ParallelFor(0, mesh.face.size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            const CFaceO &face = mesh.face[f];
            if (face.IsD())
                continue;
            const auto edgeAtRest = [&](int k) -> Eigen::Vector3d {
                return world * (toVector(rest[slotOf(face, k)]) - toVector(rest[slotOf(face, 0)]));
            };
            const auto edge = [&](int k) -> Eigen::Vector3d {
                return world * (toVector(face.cP(k)) - toVector(face.cP(0)));
            };
            const auto stretch = vcg::fcd::StretchOf(edgeAtRest(1), edgeAtRest(2), edge(1), edge(2));
            exponent[f] = stretch.Exponent();
            area[f] = float(stretch.area);
        }
    });
    vcg::fcd::ParallelFor(0, mesh.vert.size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (mesh.vert[i].IsD())
                continue;
            float sum = 0, weight = 0;
            for (std::size_t k = begin[i]; k < begin[i + 1]; ++k) {
                sum += exponent[faceOf[k]] * area[faceOf[k]];
                weight += area[faceOf[k]];
            }
            color[i] = colorOfStretch(weight > 0 ? double(sum / weight) : 0);
            color[i][3] = opacity;
        }
    });
    return color;
}
