// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FRAME_H
#define VCG_FCD_FRAME_H

#include <vcg_ext/base/graph.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// The unit frame in which everything is computed: origin at the centre of the bounding box of what is read, the box's
/// diagonal 1. A few points far outside of all others do not widen the box.
struct Frame {
    /// From mesh units to world units: the linear part of a layer's matrix. Lengths are measured in the world, so that
    /// a mesh bends as it would with the matrix applied to it.
    Eigen::Matrix3d metric = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d inverseMetric = Eigen::Matrix3d::Identity();
    bool isSame = true;                               ///< the metric is the identity
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< in world units, without the matrix's translation
    double scale = 1;                                 ///< world units per frame unit

    /// \throw BadInput where \p linear has no inverse
    void SetMetric(const Eigen::Matrix3d &linear);
    Eigen::Vector3d ToWorld(const Eigen::Vector3d &p) const { return isSame ? p : metric * p; }
    Eigen::Vector3d FromWorld(const Eigen::Vector3d &world) const { return (world - origin) / scale; }
    Eigen::Vector3d ToFrame(const Eigen::Vector3d &p) const { return FromWorld(ToWorld(p)); }
    Eigen::Vector3d FromFrame(const Eigen::Vector3d &p) const {
        const Eigen::Vector3d world = p * scale + origin;
        return isSame ? world : inverseMetric * world;
    }

    /// An affine motion in mesh units (4 x 4), expressed in the frame.
    Eigen::Affine3d ToFrame(const Eigen::Matrix4d &motion) const {
        Eigen::Affine3d m(motion);
        m.linear() = metric * m.linear() * inverseMetric;
        m.translation() = (m.linear() * origin + metric * m.translation() - origin) / scale;
        return m;
    }
    /// The way back.
    Eigen::Matrix4d FromFrame(const Eigen::Affine3d &motion) const {
        Eigen::Affine3d m(motion);
        m.translation() = inverseMetric * (motion.translation() * scale + origin - motion.linear() * origin);
        m.linear() = inverseMetric * motion.linear() * metric;
        return m.matrix();
    }
};

namespace detail {

/// A power of two near \p size, by which lengths are divided whose products would be no numbers: no bit of them
/// changes. \return 1 where products are numbers
inline double UnitOf(double size) {
    if (!(size > 0) || (size > 1e-30 && size < 1e30)) // up to six are multiplied, a hundred thousandth of it and more
        return 1;
    return std::ldexp(1.0, std::min(std::max(std::ilogb(size), -1000), 1000));
}

/// Tells points in that unit of their size. \return it
inline double TakeUnit(std::vector<Eigen::Vector3d> &points) {
    double farthest = 0;
    for (const Eigen::Vector3d &p : points)
        farthest = std::max(farthest, p.cwiseAbs().maxCoeff());
    const double unit = UnitOf(farthest);
    for (Eigen::Vector3d &p : points)
        p /= unit;
    return unit;
}

/// From the frame to the world with the whole of a layer's matrix, and back: they differ by a scale and a shift.
struct ToWorld {
    double scale;
    Eigen::Vector3d origin;

    ToWorld(const Frame &frame, const Eigen::Affine3d &world)
        : scale(frame.scale), origin(frame.origin + world.translation()) {}
    Eigen::Vector3d operator()(const Eigen::Vector3d &p) const { return p * scale + origin; }
    Eigen::Vector3d Back(const Eigen::Vector3d &p) const { return (p - origin) / scale; }
};

/// A box without a few points far outside of it: the box of a sample's middle 80 %, eight times as large, where that is
/// smaller. (Eight: what is a surface and not a stray point stays inside; the frame's floats lose no more than three
/// bits by what is kept.) \param at position of each of \p count points
template <class At>
Eigen::AlignedBox3d WithoutStrays(const Eigen::AlignedBox3d &box, std::size_t count, const At &at) {
    const std::size_t wanted = std::min<std::size_t>(count, 256);
    std::vector<double> sample[3];
    // One of each stretch, at the golden ratio's multiples: a fixed stride may run along a row or a column of a raster.
    const double golden = 0.6180339887498949;
    for (std::size_t i = 0; i < wanted; ++i) {
        const std::size_t first = count * i / wanted, next = count * (i + 1) / wanted;
        const double share = double(i) * golden - std::floor(double(i) * golden);
        const Eigen::Vector3d p = at(first + std::size_t(share * double(next - first)));
        for (int d = 0; d < 3; ++d)
            sample[d].push_back(p[d]);
    }
    Eigen::AlignedBox3d middle;
    for (int low : {1, 9}) {
        Eigen::Vector3d p;
        for (int d = 0; d < 3; ++d) {
            std::sort(sample[d].begin(), sample[d].end());
            p[d] = sample[d][std::min(wanted - 1, wanted * low / 10)];
        }
        middle.extend(p);
    }
    const double reach = 4 * (middle.max() - middle.min()).stableNorm();
    if (!(reach > 0))
        return box;
    const Eigen::Vector3d center = middle.min() * 0.5 + middle.max() * 0.5, half = Eigen::Vector3d::Constant(reach);
    return box.intersection(Eigen::AlignedBox3d(center - half, center + half));
}

BadInput NotFinite(std::size_t vertex);

} // namespace detail
} // namespace vcg::fcd

#endif
