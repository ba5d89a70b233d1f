// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TRIANGLE_CROSSING_H
#define VCG_FCD_TRIANGLE_CROSSING_H

#include <vcg_ext/surface/triangle_weights.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace vcg::fcd::detail {

/// The corners of a triangle.
using Corners3 = std::array<Eigen::Vector3d, 3>;

/// The distances of three corners from the plane of a triangle, on its two sides.
struct BesidePlane {
    Eigen::Vector3d normal;     ///< any length
    double at[3];               ///< signed distance of each corner, times the length of the normal
    double front = 0, back = 0; ///< the largest on each side, times the same

    BesidePlane(const Corners3 &plane, const Corners3 &corner)
        : normal((plane[1] - plane[0]).cross(plane[2] - plane[0])) {
        for (std::size_t k = 0; k < 3; ++k) {
            at[k] = normal.dot(corner[k] - plane[0]);
            front = std::max(front, at[k]);
            back = std::max(back, -at[k]);
        }
    }
    /// How far they reach through the plane: a move by so much, along the normal, takes them out of it.
    double Through() const { return std::min(front, back) / normal.norm(); }
};

/// A triangle's plane cuts another plane in a line. The interval of this line that is in the triangle, as dot products
/// with \p direction from \p origin; (inf, -inf) if there is none. \param direction of the line \param beside the
/// triangle's corners beside the other plane
inline Eigen::Vector2d CutOf(const Corners3 &corner, const BesidePlane &beside, const Eigen::Vector3d &direction,
                             const Eigen::Vector3d &origin) {
    Eigen::Vector2d cut(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const double a = beside.at[k], b = beside.at[next];
        if ((a < 0) == (b < 0))
            continue;
        const Eigen::Vector3d from = corner[k] - origin;
        const double t = direction.dot(from) + direction.dot(corner[next] - corner[k]) * (a / (a - b));
        cut = {std::min(cut[0], t), std::max(cut[1], t)};
    }
    return cut;
}

/// How far two triangles reach through each other; 0 if they only touch, lie in one plane, or one has no area (T.
/// Moeller, A Fast Triangle-Triangle Intersection Test, 1997). \param least the rounding of the coordinates: up to this
/// depth, triangles only touch
inline double Through(const Corners3 &a, const Corners3 &b, double least) {
    const BesidePlane toA(a, b);
    if (!(toA.front > 0 && toA.back > 0))
        return 0;
    const BesidePlane toB(b, a);
    if (!(toB.front > 0 && toB.back > 0))
        return 0;
    const double through = std::min(toA.Through(), toB.Through());
    if (!(through > least)) // NaN: a triangle without an area
        return 0;
    const Eigen::Vector3d direction = toA.normal.cross(toB.normal);
    const Eigen::Vector2d ofA = CutOf(a, toB, direction, a[0]), ofB = CutOf(b, toA, direction, a[0]);
    return std::max(ofA[0], ofB[0]) < std::min(ofA[1], ofB[1]) ? through : 0;
}

/// The square of the distance between two edges p q and r s (C. Ericson, Real-Time Collision Detection, 5.1.9).
inline double SquareBetweenEdges(const Eigen::Vector3d &p, const Eigen::Vector3d &q, const Eigen::Vector3d &r,
                                 const Eigen::Vector3d &s) {
    const auto within = [](double t) { return std::min(1.0, std::max(0.0, t)); }; // 0 for NaN
    const Eigen::Vector3d d = q - p, e = s - r, w = p - r;
    const double dd = d.squaredNorm(), ee = e.squaredNorm(), de = d.dot(e), dw = d.dot(w), ew = e.dot(w);
    double t = within((de * ew - dw * ee) / (dd * ee - de * de));
    const double u = within((de * t + ew) / ee);
    t = within((de * u - dw) / dd);
    return (w + t * d - u * e).squaredNorm();
}

/// Whether two triangles pass through each other, or are within \p distance of each other. Either may be an edge or a
/// point.
inline bool AreNear(const Corners3 &a, const Corners3 &b, double distance) {
    const double square = distance * distance;
    for (const auto &[one, t] : {std::pair<const Corners3 &, const Corners3 &>{a, b}, {b, a}}) {
        const auto isNear = [&t = t, square](const Eigen::Vector3d &p) {
            const Eigen::Vector3d weight = WeightsOfNearest(t[0], t[1], t[2], p);
            return (t[0] * weight[0] + t[1] * weight[1] + t[2] * weight[2] - p).squaredNorm() <= square;
        };
        const BesidePlane beside(t, one);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;
            if (isNear(one[k]))
                return true;
            if ((beside.at[k] < 0) != (beside.at[next] < 0) && // where the edge meets the plane
                isNear(one[k] + (one[next] - one[k]) * (beside.at[k] / (beside.at[k] - beside.at[next]))))
                return true;
        }
    }
    for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l < 3; ++l)
            if (SquareBetweenEdges(a[k], a[(k + 1) % 3], b[l], b[(l + 1) % 3]) <= square)
                return true;
    return Through(a, b, 0) > 0; // where rounding is more than the distance
}

} // namespace vcg::fcd::detail

#endif
