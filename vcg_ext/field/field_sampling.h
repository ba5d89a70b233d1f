// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIELD_SAMPLING_H
#define VCG_FCD_FIELD_SAMPLING_H

#include <vcg_ext/field/deformation_field.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <string>
#include <vector>

namespace vcg::fcd {

/// How a deformation is sampled.
struct FieldParam {
    Index moving =
        4000; ///< first samples of each region that moves, >= 1; moving parts in no region: by their share of the area
    Index resting = 1000; ///< first samples spread over all the surface; those where it rests are taken
    /// Largest error of a vertex, units of the positions, >= 0. 0: for each region, a fiftieth of its largest motion,
    /// which is less than the discretisation error, and at most a ten-thousandth of the diagonal of what moves.
    double accuracy = 0;
    Index most = 1 << 20; ///< most samples of a region for the accuracy, > 0: a file of 115 MB. Samples against motion
                          ///< at rest are not bounded
};

/// A sampled deformation, and its errors; units of the positions.
struct SampledField {
    FieldSamples samples;
    double accuracy = 0; ///< that was aimed at, the largest of the regions
    double rms = 0;      ///< error of the vertices that move
    double largest = 0;  ///< error of all vertices; also samples.largestDifference
    Index off = 0;       ///< vertices beyond the accuracy: more samples did not help, or would be too many
    Index stirred = 0;   ///< vertices that rest, but move by these samples
    Index faceless = 0;  ///< vertices without a face beyond the accuracy: samples lie on faces
    int rounds = 0;

    /// For a user: how many vertices are off or stirred, why, and what to do. Empty if none are.
    std::string Warning() const;
};

/// Samples the deformation of a mesh at few vertices. Patches of the surface grow around the samples, so that close
/// parts stay apart if they are not connected. Samples are added until each vertex is within the accuracy and each one
/// at rest keeps its bits, or until there are very many. Vertices at the same position are one, even if they move
/// differently.
/// \param mesh its faces are read (none: a cloud); its positions only tell which vertices coincide \param rest 3 x
/// vertex slots \param deformed 3 x vertex slots \param linear one per slot: the linear map of the surface there
/// \param metric linear part of the map from mesh units to the units of \p rest \param regionOf one per slot: the
/// region in which it is free, or a negative number, the same for all that move as one (MovingSurface::FreeIn); empty:
/// all is one region. With it, the bits for a point do not depend on other regions, unless these are nearest to it, or
/// so near that they had to be told apart \throw BadInput no vertices, a coordinate that is not finite, or an accuracy
/// below 0 or not finite \throw Cancelled
SampledField SampleField(const SurfaceView &mesh, const Eigen::Matrix3Xd &rest, const Eigen::Matrix3Xd &deformed,
                         const std::vector<Eigen::Matrix3f> &linear, const FieldParam &param = {},
                         const Progress &progress = {}, const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(),
                         const std::vector<Index> &regionOf = {});

/// Inverts the linear maps of a deformation, for SampleField from the deformed surface back to rest. \return how many
/// are folded; they have no inverse and become the identity
Index Invert(std::vector<Eigen::Matrix3f> &linear);

/// For a user: what folded vertices mean for an inverse. Empty if there are none.
std::string FoldsWarning(Index folded);

} // namespace vcg::fcd

#endif
