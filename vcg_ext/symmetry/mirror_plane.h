// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MIRROR_PLANE_H
#define VCG_FCD_MIRROR_PLANE_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/fit/fit_target.h>

#include <Eigen/Geometry>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// A plane that one side is the mirror image of the other in.
struct MirrorPlane {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< on it
    Eigen::Vector3d normal = Eigen::Vector3d::UnitX(); ///< of length 1

    double Above(const Eigen::Vector3d &p) const { return normal.dot(p - point); }
    Eigen::Vector3d operator()(const Eigen::Vector3d &p) const { return p - 2 * Above(p) * normal; }
    Eigen::Vector3d Turn(const Eigen::Vector3d &v) const { return v - 2 * normal.dot(v) * normal; }
    Eigen::Matrix3d Linear() const { return Eigen::Matrix3d::Identity() - 2 * normal * normal.transpose(); }
    Eigen::Vector3d Onto(const Eigen::Vector3d &p) const { return p - Above(p) * normal; }
};

/// Two places that belong to each other's mirror image; a place on the plane belongs to itself.
using MirrorPairs = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;

/// The plane in which the mirror image of each place is nearest to its partner, least squares.
/// \param weight of each pair; empty: 1 \param isTold out: false where they leave open which, as two places do that
/// are their own partners
MirrorPlane PlaneOf(const MirrorPairs &pairs, const std::vector<double> &weight, bool &isTold);

/// The planes in which a surface is most like its own mirror image, the best first, one at least: of many directions,
/// those that are best are brought to rest by matching the mirror image with the surface (as in iterative closest
/// points), the nearest four fifths of it. Only those are told that are nearly as good as the best one.
/// \param points, normal of the surface, all over it; 0 where a normal is not known \param surface itself
/// \throw Cancelled
std::vector<MirrorPlane> FindPlanes(const std::vector<Eigen::Vector3d> &points,
                                    const std::vector<Eigen::Vector3d> &normal, const FitTarget &surface,
                                    const Progress &progress = {});

/// Every so many of a list, about \p wanted.
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
