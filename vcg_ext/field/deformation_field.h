// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_FIELD_H
#define VCG_FCD_DEFORMATION_FIELD_H

#include <vcg_ext/surface/nearest_place.h>

#include <Eigen/Core>
#include <array>
#include <limits>
#include <vector>

namespace vcg::fcd {

/// Samples of a deformation: how each vertex of a surface moves, and how the surface turns and stretches around it.
struct FieldSamples {
    Eigen::Matrix3Xd position;                  ///< 3 x n, at rest
    Eigen::Matrix3Xd displacement;              ///< 3 x n, from there
    std::vector<Eigen::Matrix3f> gradient;      ///< n, of the displacement: 0 where nothing turns or stretches
    std::vector<std::array<Index, 3>> triangle; ///< corners in [0, n), equal ones for an edge or a point;
                                                ///< empty: a cloud
    /// Most that a vertex of what was sampled is off; NaN where that is not known.
    double largestDifference = std::numeric_limits<double>::quiet_NaN();
    Index Size() const { return Index(position.cols()); }
};

/// A deformation of all space, from samples of it on a surface: a point goes with the nearest place of the surface.
///
/// With x_k, u_k and G_k the position, displacement and gradient of the samples around the nearest place q, and w_k
/// their weights in q, the displacement of p is sum_k w_k (u_k + G_k ((q - x_k) / 2 + p - q)). (The half makes it of
/// third order in the distance of the samples, where linear interpolation, without the term, and the blend of affine
/// maps, with all of it, are of second order, with opposite signs.) It is 0, to the bit, where nothing moves around q.
/// A point is carried for itself: any number of threads may ask, in any order, for the same bits.
class DeformationField {
  public:
    /// \pre at least one sample, no number beyond 1e100 \throw Cancelled
    explicit DeformationField(FieldSamples given, const Progress &progress = {});

    /// The displacement of \p p; 0 for a point that is not finite, or beyond 1e100. \param linear if given: how space
    /// turns and stretches there \param hint if given: of a point near it, and then of this one; it changes no bit
    Eigen::Vector3d operator()(const Eigen::Vector3d &p, Eigen::Matrix3f *linear = nullptr,
                               NearestPlace::Hint *hint = nullptr) const;

    const FieldSamples samples;

  private:
    const NearestPlace places;
};

} // namespace vcg::fcd

#endif
