// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIELD_SAMPLING_H
#define VCG_FCD_FIELD_SAMPLING_H

#include <vcg_ext/field/deformation_field.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <vector>

namespace vcg::fcd {

/// How a deformation is sampled.
struct FieldParam {
    Index moving = 4000;  ///< samples to begin with where a region moves, or what is in none, >= 1
    Index resting = 1000; ///< and of all the surface, those of them where it rests
    /// Most that a vertex may be off, units of the positions, >= 0. 0: a fiftieth of the largest motion, which is less
    /// than the discretisation leaves, and at most a ten-thousandth of the diagonal of the box of what moves, of each
    /// region.
    double accuracy = 0;
    Index most = 1 << 20; ///< samples of a region that are added to for that, > 0: a file of 115 MB at most; for what
                          ///< rests there is no such bound
};

/// A sampled deformation, and what it differs by from the one that was sampled.
struct SampledField {
    FieldSamples samples;
    double accuracy = 0; ///< that was aimed at, units of the positions: the largest of the regions
    double rms = 0;      ///< of the distances at the vertices that move, units of the positions
    double largest = 0;  ///< of the distances at all vertices, also those that rest; samples know it, too
    Index off = 0;       ///< vertices where it is more than the accuracy: more samples did not help, or were too many
    Index stirred = 0;   ///< vertices that rest, and would not with these samples
    int rounds = 0;
};

/// Samples the deformation of a mesh at few vertices. Patches of the surface are grown around the samples, so close
/// parts that are not connected stay apart. Samples are added until no vertex is off by more than the accuracy and all
/// that rests does so to the bit, or until there are very many. Vertices at one place that move differently cannot be
/// told apart. \param mesh its faces are read (none: a cloud); its own positions only tell which vertices lie at one
/// place \param rest 3 x vertex slots \param deformed 3 x vertex slots \param linear one per slot: how the surface
/// turns and stretches there \param metric the linear part of the map from the mesh's coordinates to those
/// \param regionOf one per slot: the region that it is free in; below 0 in none, alike where it moves as one
///        (MovingSurface::FreeIn); empty: all is one. A point then gets the same bits whatever else moves, unless what
///        else moves, or rests beside that, is the nearest to it or so near that it had to be told apart
/// \throw BadInput no vertices, a coordinate that is not finite, or an accuracy below 0 or not finite \throw Cancelled
SampledField SampleField(const SurfaceView &mesh, const Eigen::Matrix3Xd &rest, const Eigen::Matrix3Xd &deformed,
                         const std::vector<Eigen::Matrix3f> &linear, const FieldParam &param = {},
                         const Progress &progress = {}, const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity(),
                         const std::vector<Index> &regionOf = {});

/// Inverts the maps of a deformation, so that SampleField takes it the other way: from where the surface went to where
/// it was. \return how many are folded: there is no way back there, and they become the identity
Index Invert(std::vector<Eigen::Matrix3f> &linear);

} // namespace vcg::fcd

#endif
