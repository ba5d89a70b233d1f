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

/// Some vertices that are carried, in the coordinates of the carrying layer. All vectors have one value for each.
struct CarriedVertices {
    std::vector<std::size_t> slot;
    std::vector<Eigen::Vector3d> position, normal;
};

/// Gives the displacements of some vertices, and the linear maps there.
using Displacements = std::function<void(const CarriedVertices &, std::vector<Eigen::Vector3d> &displacement,
                                         std::vector<Eigen::Matrix3f> &linear)>;

/// The surface of a layer at rest, which carries other layers.
class CarryingSurface {
  public:
    /// \param layer must outlive this \param position 3 x slots, at rest
    CarryingSurface(const MeshModel &layer, Eigen::Matrix3Xd position);
    ~CarryingSurface();

    /// NearestPlace::SidesTold for the normals of \p target. \param position 3 x slots of \p target
    int sidesTold(const MeshModel &target, const Eigen::Matrix3Xd &position) const;

    /// Finds the place of a vertex: the surface's vertex at the same position (that of the same slot, as in a copy, or
    /// else the one with the nearest normal), or the nearest place. It is the same for all poses.
    /// \param n of the vertex in \p vertices \param sides as of sidesTold \param hint of a vertex nearby
    vcg::fcd::SurfacePlace operator()(const CarriedVertices &vertices, std::size_t n, int sides,
                                      vcg::fcd::NearestPlace::Hint &hint) const;

    const Eigen::Matrix3Xd position;
    const Eigen::Affine3d matrix;

  private:
    class VerticesAtPlaces;
    std::unique_ptr<const vcg::fcd::NearestPlace> places;
    std::unique_ptr<const VerticesAtPlaces> ownVertices;
};

/// Carries the vertices of \p target. \param matrix from the coordinates of \p displacements to the world
/// \param position, linear out: one per vertex slot
void carry(const MeshModel &target, const Eigen::Affine3d &matrix, const Displacements &displacements,
           const vcg::fcd::Progress &progress, Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> &linear);

/// The box of the finite positions, world units. \param mesh if given, its deleted vertices do not count
Eigen::AlignedBox3d boxOf(const Eigen::Matrix3Xd &position, const Eigen::Affine3d &matrix, const CMeshO *mesh);

/// A warning about a layer that is far from the source, far larger or, if \p isWhole, far smaller; empty: none.
/// \param here, source boxes, world units
std::string describeSpace(const MeshModel &target, const Eigen::AlignedBox3d &here, const Eigen::AlignedBox3d &source,
                          bool isWhole);

#endif
