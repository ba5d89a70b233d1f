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
/// Layers that go along with another one, which is deformed.

/// A vertex that goes along, in the coordinates of the surface.
struct Carried {
    std::size_t slot;
    Eigen::Vector3d position, normal;
};

/// The displacement of a vertex, and how space turns and stretches there.
using Displacement = std::function<Eigen::Vector3d(const Carried &, Eigen::Matrix3f &)>;

/// Where a vertex that goes along is on the surface; the same for all poses.
struct CarriedPlace {
    std::ptrdiff_t same = -1; ///< slot of the vertex of the surface that it is at; less than 0: there is none
    vcg::fcd::SurfacePlace place;

    Eigen::Vector3d displacement(const vcg::fcd::Carrier &carrier, const Eigen::Vector3d &position,
                                 Eigen::Matrix3f &map) const {
        return same >= 0 ? Eigen::Vector3d(carrier(std::size_t(same), position, map) - position)
                         : carrier.Displacement(place, position, map);
    }
};

/// The surface of a layer at rest, which other layers go along with. Refers to the layer.
class CarryingSurface {
  public:
    /// \param position 3 x slots, at rest
    CarryingSurface(const MeshModel &layer, Eigen::Matrix3Xd position);
    ~CarryingSurface();

    /// Which sides the normals of \p target tell, as NearestPlace::SidesTold. \param position 3 x its slots
    int sidesTold(const MeshModel &target, const Eigen::Matrix3Xd &position) const;

    /// The vertex that one is at: that of the same slot, where it is, as in a copy; or else, of several, the one whose
    /// normal is nearest to its own. Otherwise the nearest place. \param sides as sidesTold gives them
    CarriedPlace operator()(const Carried &vertex, int sides) const;

    const Eigen::Matrix3Xd position;
    const Eigen::Affine3d matrix;

  private:
    class VerticesAtPlaces;
    std::unique_ptr<const vcg::fcd::NearestPlace> places;
    std::unique_ptr<const VerticesAtPlaces> vertices;
};

/// Positions and maps of the vertices of \p target. \param matrix from the coordinates of \p displacement to the world
void carry(const MeshModel &target, const Eigen::Affine3d &matrix, const Displacement &displacement,
           const vcg::fcd::Progress &progress, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> &linear);

/// The box of finite positions, in the world. \param mesh whose slots they are, or null
Eigen::AlignedBox3d boxOf(const Eigen::Matrix3Xd &position, const Eigen::Affine3d &matrix, const CMeshO *mesh);

/// What is to be said of a layer that is far from the source, or larger, or, where \p isWhole, smaller by far; both in
/// the world. Empty: nothing
std::string describeSpace(const MeshModel &target, const Eigen::AlignedBox3d &here, const Eigen::AlignedBox3d &source,
                          bool isWhole);

#endif
