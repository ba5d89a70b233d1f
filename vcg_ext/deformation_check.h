// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_CHECK_H
#define VCG_FCD_DEFORMATION_CHECK_H

#include "graph_deformer.h"
#include "handles.h"

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
/// \param tag one per vertex slot \param position 3 x slots, deformed, mesh units
template <class MeshType>
void CheckEdgesBetweenHeld(const MeshType &m, const Frame &frame, const std::vector<int> &tag,
                           const Eigen::Matrix3Xd &position, const Progress &progress, DeformationCheck &check) {
    using Pair = std::pair<std::size_t, std::size_t>;
    const std::size_t grain = 1 << 14;
    std::vector<std::vector<Pair>> found((m.face.size() + grain - 1) / grain);
    ParallelFor(progress, "Checking the result", m.face.size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f)
            for (int k = 0; k < 3 && !m.face[f].IsD(); ++k) {
                const std::size_t a = std::size_t(m.face[f].cV(k) - &m.vert[0]),
                                  b = std::size_t(m.face[f].cV((k + 1) % 3) - &m.vert[0]);
                const int s = std::max(0, tag[a]), t = std::max(0, tag[b]);
                if (s != 1 && t != 1 && s != t)
                    found[first / grain].emplace_back(std::min(a, b), std::max(a, b));
            }
    });
    std::vector<Pair> edges;
    for (const std::vector<Pair> &list : found)
        edges.insert(edges.end(), list.begin(), list.end());
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (const Pair &edge : edges) {
        const Eigen::Vector3d rest = frame.metric * (vcg::tri::PositionOf(m.vert[edge.first]) -
                                                     vcg::tri::PositionOf(m.vert[edge.second])),
                              posed = frame.metric * (position.col(Eigen::Index(edge.first)) -
                                                      position.col(Eigen::Index(edge.second)));
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
    ParallelFor(progress, "Checking the result", m.face.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
        for (std::size_t f = first; f < last; ++f) {
            if (m.face[f].IsD())
                continue;
            Vector3d rest[3], posed[3];
            Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
            for (int k = 0; k < 3; ++k) {
                const auto slot = m.face[f].cV(k) - &m.vert[0];
                rest[k] = surface.frame.ToFrame(vcg::tri::PositionOf(m.vert[slot]));
                posed[k] = surface.frame.ToFrame(Vector3d(position.col(slot)));
                const Index node = surface.nodeOf[slot];
                if (node >= 0 && patchOf[node] >= 0)
                    turns += turn[patchOf[node]];
            }
            const Vector3d a = rest[1] - rest[0], b = rest[2] - rest[0], normal = a.cross(b);
            if (normal.norm() > 1e-3 * std::max(a.squaredNorm(), b.squaredNorm()) &&
                (posed[1] - posed[0]).cross(posed[2] - posed[0]).dot(turns * normal) < 0)
                ++folded;
        }
    });
    return folded;
}

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
