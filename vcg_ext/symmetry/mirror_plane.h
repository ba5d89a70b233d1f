// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MIRROR_PLANE_H
#define VCG_FCD_MIRROR_PLANE_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Geometry>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// A mirror plane; units of the points.
struct MirrorPlane {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< on it
    Eigen::Vector3d normal = Eigen::Vector3d::UnitX(); ///< of length 1

    double Above(const Eigen::Vector3d &p) const { return normal.dot(p - point); }
    Eigen::Vector3d operator()(const Eigen::Vector3d &p) const { return p - 2 * Above(p) * normal; }
    Eigen::Vector3d Turn(const Eigen::Vector3d &v) const { return v - 2 * normal.dot(v) * normal; }
    Eigen::Matrix3d Linear() const { return Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose(); }
    Eigen::Vector3d Onto(const Eigen::Vector3d &p) const { return p - Above(p) * normal; }
};

/// Pairs of points that mirror each other; a point on the plane is its own partner.
using MirrorPairs = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;

/// The plane that mirrors points nearest to their partners (least squares). \param weight of each pair; empty: 1
/// \param isUnique out: false if several planes do, as for two points that are their own partners
MirrorPlane PlaneOf(const MirrorPairs &pairs, const std::vector<double> &weight, bool &isUnique);

/// Planes in which a surface is most like its own mirror image: at least one, the best first, then those nearly as
/// good.
struct TriedPlanes {
    std::vector<MirrorPlane> planes;
    bool standOut =
        true; ///< false: in any plane through the middle, the surface is about as much like its mirror image
};

/// Tries many directions. From the best ones, matches the mirror image with the surface (iterative closest points,
/// robust weights) until it rests. The misfit is that of a warp (MisfitOf). \param points, normal
/// samples all over the surface; a normal is 0 if unknown \param surface itself \throw Cancelled
TriedPlanes FindPlanes(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                       const FitTarget &surface, const Progress &progress = {});

/// About \p wanted items of a list, evenly chosen.
template <class T>
std::vector<T> Some(const std::vector<T> &all, std::size_t wanted) {
    std::vector<T> some;
    const std::size_t step = std::max<std::size_t>(1, all.size() / wanted);
    for (std::size_t i = 0; i < all.size(); i += step)
        some.push_back(all[i]);
    return some;
}

} // namespace vcg::fcd

#endif
