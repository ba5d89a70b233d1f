// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CROSSING_FACES_H
#define VCG_FCD_CROSSING_FACES_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/contact/triangle_crossing.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// Two faces that pass through each other in the pose, and were apart at rest.
struct Crossing {
    std::uint32_t face[2];
    double through; ///< depth, world units
    bool operator<(const Crossing &o) const {
        return std::make_pair(face[0], face[1]) < std::make_pair(o.face[0], o.face[1]);
    }
};

/// Two faces that have one corner in common, at rest, and pass through each other elsewhere in the pose: neighbours at
/// the end of a line along which the surface passes through itself. (Where triangles are flat, such a line ends at a
/// vertex only.)
struct Pinch {
    std::uint32_t face[2];
    std::uint32_t slot[2]; ///< of the corner; differ where vertices are doubled
};

/// A surface at rest and in a pose ("now"), both in world units.
class TwoShapes {
  public:
    TwoShapes(const SurfaceView &mesh, const PositionsRef &position, const Eigen::Matrix3d &metric)
        : mesh(mesh), position(position), metric(metric), isSame(metric.isIdentity(0)) {}

    bool IsUsable(std::size_t slot) const {
        return !mesh.IsDeleted(slot) && position.col(Eigen::Index(slot)).allFinite() && mesh.At(slot).allFinite();
    }
    bool Stays(std::size_t slot) const { return position.col(Eigen::Index(slot)) == mesh.At(slot); }
    std::uint32_t Corner(std::size_t f, std::size_t k) const { return mesh.corner[3 * f + k]; }
    Eigen::Vector3d Now(std::size_t slot) const { return ToWorld(position.col(Eigen::Index(slot))); }
    Eigen::Vector3d Rest(std::size_t slot) const { return ToWorld(mesh.At(slot)); }
    Corners3 CornersNow(std::size_t f) const { return {Now(Corner(f, 0)), Now(Corner(f, 1)), Now(Corner(f, 2))}; }
    Corners3 CornersAtRest(std::size_t f) const { return {Rest(Corner(f, 0)), Rest(Corner(f, 1)), Rest(Corner(f, 2))}; }
    Eigen::AlignedBox3d BoxNow(std::size_t f) const {
        Eigen::AlignedBox3d box;
        for (std::size_t k = 0; k < 3; ++k)
            box.extend(Now(Corner(f, k)));
        return box;
    }
    bool HasAreaNow(std::size_t f) const {
        const Corners3 c = CornersNow(f);
        return !(c[1] - c[0]).cross(c[2] - c[0]).isZero(0);
    }
    /// The corners that two faces have in common.
    struct Shared {
        int count = 0;
        std::size_t of[2]; ///< number of the last one in each face, 0 to 2
    };
    /// \param isSame isSame(slot, slot): whether two corners are one
    template <class IsSame>
    Shared SharedCorners(std::size_t f, std::size_t g, const IsSame &isSame) const {
        Shared shared{0, {0, 0}};
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t l = 0; l < 3; ++l)
                if (isSame(Corner(f, k), Corner(g, l)))
                    shared = {shared.count + 1, {k, l}};
        return shared;
    }

    const SurfaceView &mesh;

  private:
    Eigen::Vector3d ToWorld(const Eigen::Vector3d &p) const { return isSame ? p : metric * p; }

    const PositionsRef &position;
    const Eigen::Matrix3d &metric;
    const bool isSame;
};

/// The pairs of faces that pass through each other now, ascending. Pairs that touched at rest are left out.
/// \param apart the distance up to which faces touch, over the diagonal of the posed box of the faces that move
/// \param pinches out \throw Cancelled
std::vector<Crossing> FindCrossings(const TwoShapes &shape, double apart, std::vector<Pinch> &pinches,
                                    const Progress &progress);

} // namespace vcg::fcd::detail

#endif
