// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DEFORMATION_USES_H
#define FCD_DEFORMATION_USES_H

#include <vcg_ext/field/field_sampling.h> // these before Qt
#include <vcg_ext/map/carrier.h>

#include "meshlab_host.h"
#include "parameters.h"

#include <Eigen/Geometry>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// The result of copyDeformation.
struct DeformedCopies {
    int vertices = 0;                  ///< of all new layers
    std::vector<std::string> warnings; ///< about layers that lie elsewhere than the source, or have another size
};

/// Adds a layer for each of \p targets that is deformed as the source was.
/// \throw vcg::fcd::Error the layers are not those of one deformation, or the file cannot be read
/// \throw vcg::fcd::Cancelled
DeformedCopies copyDeformation(MeshDocument &document, const CopyParam &param, const std::vector<MeshModel *> &targets,
                               const Remark &remark, const vcg::fcd::Progress &progress);

/// The result of saveDeformation.
struct SavedDeformation {
    vcg::fcd::SampledField field;
    vcg::fcd::Index folded = 0; ///< vertices of the source without an inverse; 0 if none is saved
    std::size_t bytes = 0;      ///< size of the file
    double seconds = 0;         ///< time to save it
};

/// Writes the deformation of a layer, or its inverse, to a file, in world coordinates.
/// \throw vcg::fcd::Error the layers are not those of one deformation, the accuracy is below 0, or the file cannot be
/// written; vcg::fcd::Cancelled; the file is then as it was
SavedDeformation saveDeformation(const SaveDeformationParam &param, const Remark &remark,
                                 const vcg::fcd::Progress &progress);

// --- layers that are carried along with a layer that is deformed ---

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
    /// \param n of the vertex in \p vertices \param sides as in sidesTold \param hint of a vertex nearby
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
