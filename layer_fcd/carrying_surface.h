// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_CARRYING_SURFACE_H
#define FCD_CARRYING_SURFACE_H

#include <vcg_ext/map/carrier.h> // before Qt

#include "meshlab_host.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// \file
/// Carries layers along with a layer that is deformed.

/// A vertex that is carried, in the coordinates of the carrying layer.
struct Carried {
    std::size_t slot;
    Eigen::Vector3d position, normal;
};

/// Gives the displacement of a vertex, and the linear map there.
using Displacement = std::function<Eigen::Vector3d(const Carried &, Eigen::Matrix3f &)>;

/// The place of a carried vertex on the surface; the same for all poses.
struct CarriedPlace {
    std::ptrdiff_t same = -1; ///< slot of the surface's vertex at the same position; < 0: none
    vcg::fcd::SurfacePlace place;

    Eigen::Vector3d displacement(const vcg::fcd::Carrier &carrier, const Eigen::Vector3d &position,
                                 Eigen::Matrix3f &map) const {
        return same >= 0 ? Eigen::Vector3d(carrier(std::size_t(same), position, map) - position)
                         : carrier.Displacement(place, position, map);
    }
};

/// The surface of a layer at rest, which carries other layers.
class CarryingSurface {
  public:
    /// \param layer must outlive this \param position 3 x slots, at rest
    CarryingSurface(const MeshModel &layer, Eigen::Matrix3Xd position);
    ~CarryingSurface();

    /// NearestPlace::SidesTold for the normals of \p target. \param position 3 x slots of \p target
    int sidesTold(const MeshModel &target, const Eigen::Matrix3Xd &position) const;

    /// Finds the place of a vertex: the surface's vertex at the same position (that of the same slot, as in a copy, or
    /// else the one with the nearest normal), or the nearest place. \param sides as of sidesTold
    CarriedPlace operator()(const Carried &vertex, int sides) const;

    const Eigen::Matrix3Xd position;
    const Eigen::Affine3d matrix;

  private:
    class VerticesAtPlaces;
    std::unique_ptr<const vcg::fcd::NearestPlace> places;
    std::unique_ptr<const VerticesAtPlaces> vertices;
};

/// Carries the vertices of \p target. \param matrix from the coordinates of \p displacement to the world
/// \param position, linear out: one per vertex slot
void carry(const MeshModel &target, const Eigen::Affine3d &matrix, const Displacement &displacement,
           const vcg::fcd::Progress &progress, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> &linear);

/// The box of the finite positions, world units. \param mesh if given, its deleted vertices do not count
Eigen::AlignedBox3d boxOf(const Eigen::Matrix3Xd &position, const Eigen::Affine3d &matrix, const CMeshO *mesh);

/// A warning about a layer that is far from the source, far larger or, if \p isWhole, far smaller; empty: none.
/// \param here, source boxes, world units
std::string describeSpace(const MeshModel &target, const Eigen::AlignedBox3d &here, const Eigen::AlignedBox3d &source,
                          bool isWhole);

#endif
