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

/// The coordinates that everything is computed in. Frame units: the bounding box of what is read has its centre at the
/// origin and a diagonal of 1; a few stray points far outside do not widen it. World units: after the layer's matrix.
/// Mesh units: as the vertices are stored.
struct Frame {
    /// From mesh units to world units: the linear part of the layer's matrix. Lengths are measured in world units, so
    /// that a mesh bends as it would with its matrix applied.
    Eigen::Matrix3d metric = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d inverseMetric = Eigen::Matrix3d::Identity();
    bool isSame = true;                               ///< the metric is the identity
    Eigen::Vector3d origin = Eigen::Vector3d::Zero(); ///< world units, without the translation of the layer's matrix
    double scale = 1;                                 ///< world units per frame unit

    /// \throw BadInput \p linear is not finite, or has no inverse
    void SetMetric(const Eigen::Matrix3d &linear);
    // Positions: mesh to world, world to frame, mesh to frame, frame to mesh.
    Eigen::Vector3d ToWorld(const Eigen::Vector3d &p) const { return isSame ? p : metric * p; }
    Eigen::Vector3d FromWorld(const Eigen::Vector3d &world) const { return (world - origin) / scale; }
    Eigen::Vector3d ToFrame(const Eigen::Vector3d &p) const { return FromWorld(ToWorld(p)); }
    Eigen::Vector3d FromFrame(const Eigen::Vector3d &p) const {
        const Eigen::Vector3d world = p * scale + origin;
        return isSame ? world : inverseMetric * world;
    }

    /// An affine motion (4 x 4), from mesh units to frame units.
    Eigen::Affine3d ToFrame(const Eigen::Matrix4d &motion) const {
        Eigen::Affine3d m(motion);
        m.linear() = metric * m.linear() * inverseMetric;
        m.translation() = (m.linear() * origin + metric * m.translation() - origin) / scale;
        return m;
    }
    /// An affine motion, from frame units to mesh units.
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

/// Positions from frame units to world units, with the translation of the layer's matrix, and back.
struct ToWorld {
    double scale;
    Eigen::Vector3d origin;

    ToWorld(const Frame &frame, const Eigen::Affine3d &world)
        : scale(frame.scale), origin(frame.origin + world.translation()) {}
    Eigen::Vector3d operator()(const Eigen::Vector3d &p) const { return p * scale + origin; }
    Eigen::Vector3d Back(const Eigen::Vector3d &p) const { return (p - origin) / scale; }
};

/// The part of the box of some points that holds all but strays: its intersection with eight times the box of a
/// sample's middle 80 %. (Eight: surfaces stay inside, and what is kept costs the frame's floats three bits at most.)
/// \param at at(i): position of one of \p count points
template <class At>
Eigen::AlignedBox3d WithoutStrays(const Eigen::AlignedBox3d &box, std::size_t count, const At &at) {
    const std::size_t wanted = std::min<std::size_t>(count, 256);
    std::vector<double> sample[3];
    // One point of each stretch, at multiples of the golden ratio: a fixed stride could run along a column of a raster.
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
