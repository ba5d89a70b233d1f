// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/map/deformation_check.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>

namespace vcg::fcd::detail {

bool MovesAsOne(const std::vector<Index> &tag, const std::map<Index, Eigen::Matrix4d> &motion) {
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

Index CountOverruled(const MovingSurface &surface, const std::vector<int> &tag) {
    Index count = 0;
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (tag[i] >= 2) {
            const MovingSurface::Place place = surface.At(i);
            count += (place.region ? place.region->surface.tag[std::size_t(place.node)] : surface.slotTag[i]) != tag[i];
        }
    return count;
}

void CheckEdgesBetweenHeld(const SurfaceView &mesh, const Frame &frame,
                           const std::vector<std::array<std::uint32_t, 2>> &apart, const PositionsRef &position,
                           DeformationCheck &check) {
    for (const auto &edge : apart) {
        const Eigen::Vector3d rest = frame.metric * (mesh.At(edge[0]) - mesh.At(edge[1])),
                              posed = frame.metric *
                                      (position.col(Eigen::Index(edge[0])) - position.col(Eigen::Index(edge[1])));
        if (!(rest.norm() > 0))
            continue;
        const double ratio = posed.norm() / rest.norm();
        check.strained += ratio <= 0.5 || ratio >= 2;
        check.longest = std::max(check.longest, ratio);
    }
}

Index CountFlipped(const SurfaceView &mesh, const MovingSurface &moving, std::size_t r,
                   const std::vector<Eigen::Matrix3d> &linear, const PositionsRef &position, const Progress &progress) {
    const SurfaceGraph &surface = moving.regions[r]->surface;
    const std::vector<Index> &patchOf = moving.regions[r]->patches.patchOf;
    using Eigen::Vector3d;
    std::vector<Eigen::Matrix3d> turn;
    turn.reserve(linear.size());
    for (const Eigen::Matrix3d &map : linear)
        turn.push_back(RotationOf(map));
    std::atomic<Index> folded{0};
    const std::size_t faces = surface.faces.size();
    const double inverse = 1 / UnitOf(surface.frame.scale);
    ParallelFor(progress, "Checking the result", faces, 1 << 12, [&](std::size_t first, std::size_t last) {
        Index count = 0;
        for (std::size_t i = first; i < last; ++i) {
            for (int k = 0; k < 3; ++k) {
                const std::size_t next =
                    mesh.corner[3 * std::size_t(surface.faces[std::min(i + 8, last - 1)]) + std::size_t(k)];
                Prefetch(&moving.nodeOf[next]);
                Prefetch(position.col(Eigen::Index(next)).data());
                Prefetch(mesh.position + 3 * next);
            }
            const std::uint32_t f = surface.faces[i];
            std::size_t slot[3];
            Index patch[3];
            for (int k = 0; k < 3; ++k) {
                slot[k] = mesh.corner[3 * std::size_t(f) + std::size_t(k)];
                const MovingSurface::Place place = moving.At(slot[k]);
                patch[k] = place.region && place.number == r ? patchOf[place.node] : -1;
            }
            const auto toWorld = [&](const Vector3d &v) -> Vector3d { return inverse * surface.frame.ToWorld(v); };
            const auto rest = [&](int k) { return Vector3d(mesh.At(slot[k])); };
            const auto posed = [&](int k) { return Vector3d(position.col(Eigen::Index(slot[k]))); };
            const Vector3d a = toWorld(rest(1) - rest(0)), b = toWorld(rest(2) - rest(0)), normal = a.cross(b);
            const double size = std::max(a.squaredNorm(), b.squaredNorm());
            if (!(normal.squaredNorm() > 1e-6 * size * size))
                continue;
            Vector3d turned = Vector3d::Zero();
            const bool isInside = patch[0] >= 0 && patch[0] == patch[1] && patch[0] == patch[2];
            for (int k = 0; k < (isInside ? 1 : 3); ++k) // one patch: one term has the same direction
                if (patch[k] >= 0)
                    turned += turn[patch[k]] * normal;
            count += toWorld(posed(1) - posed(0)).cross(toWorld(posed(2) - posed(0))).dot(turned) < 0;
        }
        folded += count;
    });
    return folded;
}

} // namespace vcg::fcd::detail
