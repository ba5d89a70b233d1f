// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_sight.h"

#include <layer_fcd/layer_contents.h>

#include <algorithm>
#include <limits>

namespace {

const double never = std::numeric_limits<double>::infinity();
const std::size_t facesAtOnce = 1 << 14;

/// How far along a way from a place a triangle is met (Moeller and Trumbore 1997), never (infinity) where it is not.
double meets(const Eigen::Vector3d &from, const Eigen::Vector3d &way, const Eigen::Vector3d &a,
             const Eigen::Vector3d &b, const Eigen::Vector3d &c) {
    const Eigen::Vector3d ab = b - a, ac = c - a, p = way.cross(ac), t = from - a, q = t.cross(ab);
    const double determinant = ab.dot(p);
    if (determinant == 0)
        return never;
    const double u = t.dot(p) / determinant, v = way.dot(q) / determinant, along = ac.dot(q) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 && along >= 0 && along <= 1 ? along : never;
}

double firstOn(const CMeshO &mesh, const Eigen::Vector3d &from, const Eigen::Vector3d &way) {
    std::vector<double> first((mesh.face.size() + facesAtOnce - 1) / facesAtOnce + 1, never);
    vcg::fcd::ParallelFor(0, mesh.face.size(), facesAtOnce, [&](std::size_t begin, std::size_t end) {
        double &least = first[begin / facesAtOnce];
        for (std::size_t f = begin; f < end; ++f) {
            const CFaceO &face = mesh.face[f];
            if (!face.IsD())
                least =
                    std::min(least, meets(from, way, toVector(face.cP(0)), toVector(face.cP(1)), toVector(face.cP(2))));
        }
    });
    return *std::min_element(first.begin(), first.end());
}

} // namespace

std::optional<Eigen::Vector3d> firstOnOthers(const MeshDocument &document, const MeshModel &but,
                                             const Eigen::Vector3d &from, const Eigen::Vector3d &to) {
    double least = never;
    for (const MeshModel *layer : host::layers(document)) {
        if (layer == &but || !layer->isVisible())
            continue;
        Eigen::Matrix4d matrix;
        layer->cm.Tr.ToEigenMatrix(matrix);
        const Eigen::Affine3d toLayer = Eigen::Affine3d(matrix).inverse(); // keeps shares of a way
        least = std::min(least, firstOn(layer->cm, toLayer * from, toLayer.linear() * (to - from)));
    }
    return least <= 1 ? std::optional<Eigen::Vector3d>(from + least * (to - from)) : std::nullopt;
}
