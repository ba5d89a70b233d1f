// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_CHECK_H
#define VCG_FCD_DEFORMATION_CHECK_H

#include "handles.h"
#include "rotation_fit.h"
#include "surface_graph.h"

#include <Eigen/Geometry>
#include <atomic>
#include <map>

namespace vcg {
namespace fcd {

/// What in a deformation is probably not meant.
struct DeformationCheck {
    bool rigid = false; ///< all that is held makes one and the same motion, hence the surface does
    Index overruled =
        0; ///< handle vertices at the place of one that is fixed, or of a smaller tag, and held as that one
    Index strained = 0; ///< edges that join regions held apart and get twice or half as long, or worse
    double longest = 1; ///< the largest ratio of the length of such an edge to that at rest
    Index folded = 0;   ///< triangles that turned over
};

namespace detail {

/// Whether all held nodes make the same motion, and one that moves them. \param tag n, 1 where free \param motion of
/// each other tag; of 0 whether there is such a node or not
inline bool MovesAsOne(const std::vector<Index> &tag, const std::map<Index, Eigen::Matrix4d> &motion) {
    const bool fixed = std::find(tag.begin(), tag.end(), 0) != tag.end();
    const Eigen::Matrix4d *first = nullptr;
    for (const auto &[t, matrix] : motion) {
        if (t == 0 && !fixed)
            continue;
        if (first && !matrix.isApprox(*first, 1e-9))
            return false;
        first = &matrix;
    }
    return first && !first->isIdentity(1e-9);
}

/// \param tag one per vertex slot
inline Index CountOverruled(const SurfaceGraph &surface, const std::vector<int> &tag) {
    Index count = 0;
    for (std::size_t i = 0; i < tag.size(); ++i)
        count += tag[i] >= 2 && surface.nodeOf[i] >= 0 && surface.tag[surface.nodeOf[i]] != tag[i];
    return count;
}

/// What lies between the ends of such an edge is the edge alone, hence nothing can make up for their motions.
/// \param apart ends of the edges, slots \param position 3 x slots, deformed, mesh units
template <class MeshType>
void CheckEdgesBetweenHeld(const MeshType &m, const Frame &frame,
                           const std::vector<std::array<std::uint32_t, 2>> &apart, const Eigen::Matrix3Xd &position,
                           DeformationCheck &check) {
    for (const auto &edge : apart) {
        const Eigen::Vector3d rest = frame.metric *
                                     (vcg::tri::PositionOf(m.vert[edge[0]]) - vcg::tri::PositionOf(m.vert[edge[1]])),
                              posed = frame.metric *
                                      (position.col(Eigen::Index(edge[0])) - position.col(Eigen::Index(edge[1])));
        if (!(rest.norm() > 0))
            continue;
        const double ratio = posed.norm() / rest.norm();
        check.strained += ratio <= 0.5 || ratio >= 2;
        check.longest = std::max(check.longest, ratio);
    }
}

/// A triangle has turned over when its normal points away from where the patches of its corners turn it. Needles, whose
/// normals are noise, do not count.
template <class MeshType>
Index CountFolded(const MeshType &m, const SurfaceGraph &surface, const std::vector<Index> &patchOf,
                  const std::vector<Eigen::Matrix3d> &linear, const Eigen::Matrix3Xd &position,
                  const Progress &progress) {
    using Eigen::Vector3d;
    std::vector<Eigen::Matrix3d> turn;
    turn.reserve(linear.size());
    for (const Eigen::Matrix3d &map : linear)
        turn.push_back(RotationOf(map));
    std::atomic<Index> folded{0};
    const std::size_t faces = surface.faces.size();
    ParallelFor(progress, "Checking the result", faces, 1 << 12, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const std::uint32_t f = surface.faces[i];
            std::size_t slot[3];
            Index patch[3];
            for (int k = 0; k < 3; ++k) {
                slot[k] = std::size_t(m.face[f].cV(k) - &m.vert[0]);
                const Index node = surface.nodeOf[slot[k]];
                patch[k] = node >= 0 ? patchOf[node] : -1;
            }
            const auto toWorld = [&](const Vector3d &v) { return surface.frame.ToWorld(v); };
            const auto rest = [&](int k) { return vcg::tri::PositionOf(m.vert[slot[k]]); };
            const auto posed = [&](int k) { return Vector3d(position.col(Eigen::Index(slot[k]))); };
            const Vector3d a = toWorld(rest(1) - rest(0)), b = toWorld(rest(2) - rest(0)), normal = a.cross(b);
            if (!(normal.norm() > 1e-3 * std::max(a.squaredNorm(), b.squaredNorm())))
                continue;
            Vector3d turned = Vector3d::Zero();
            for (Index each : patch)
                if (each >= 0)
                    turned += turn[each] * normal;
            if (toWorld(posed(1) - posed(0)).cross(toWorld(posed(2) - posed(0))).dot(turned) < 0)
                ++folded;
        }
    });
    return folded;
}

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
