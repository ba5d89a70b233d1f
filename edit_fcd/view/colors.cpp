// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/triangle_stretch.h> // before Qt

#include "edit_fcd/view/colors.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/parameters.h>

#include <algorithm>
#include <cmath>

vcg::Color4b colorOfStretch(double exponent) {
    const double pressed[] = {30, 80, 220}, none[] = {225, 225, 225}, stretched[] = {215, 35, 35};
    const double *full = exponent < 0 ? pressed : stretched, part = std::min(1.0, std::abs(exponent));
    const auto mixed = [&](int i) { return (unsigned char)std::lround(none[i] + part * (full[i] - none[i])); };
    return vcg::Color4b(mixed(0), mixed(1), mixed(2), 255);
}

std::vector<vcg::Color4b> colorsOfStretch(const CMeshO &mesh, const std::vector<Point3m> &rest,
                                          const Eigen::Matrix3d &world, unsigned char opacity) {
    const std::size_t grain = 1 << 10;
    struct Weighed {
        float exponent[grain], area[grain];
    };
    const vcg::fcd::RangeResults<Weighed> faces(mesh.face.size(), grain);
    const auto slotOf = [&](const CFaceO &face, int k) { return std::size_t(face.cV(k) - mesh.vert.data()); };
    std::vector<vcg::Color4b> color(mesh.vert.size());
    std::vector<float> sum(mesh.vert.size(), 0), weight(mesh.vert.size(), 0);
    const auto compute = [&](std::size_t first, std::size_t last) {
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
            faces.Of(f).exponent[f % grain] = stretch.Exponent();
            faces.Of(f).area[f % grain] = float(stretch.area);
        }
    };
    const auto add = [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f)
            for (int k = 0; k < 3 && !mesh.face[f].IsD(); ++k) {
                const std::size_t i = slotOf(mesh.face[f], k);
                const float area = faces.Of(f).area[f % grain];
                sum[i] += faces.Of(f).exponent[f % grain] * area;
                weight[i] += area;
            }
    };
    vcg::fcd::ParallelForAdding(0, mesh.face.size(), grain, compute, add);
    forVertices(mesh, [&](std::size_t i) {
        color[i] = colorOfStretch(weight[i] > 0 ? double(sum[i] / weight[i]) : 0);
        color[i][3] = opacity;
    });
    return color;
}

vcg::Color4b colorOfDistance(double part) {
    const double stops[][3] = {{40, 80, 220}, {40, 190, 160}, {110, 200, 60}, {250, 220, 50}, {215, 35, 35}};
    const double at = 4 * std::clamp(part, 0.0, 1.0);
    const int first = std::min(3, int(at));
    const auto mixed = [&](int i) {
        return (unsigned char)std::lround(stops[first][i] + (at - first) * (stops[first + 1][i] - stops[first][i]));
    };
    return vcg::Color4b(mixed(0), mixed(1), mixed(2), 255);
}

vcg::Color4b colorOfNoCounterpart() { return vcg::Color4b(150, 150, 150, 255); }
