// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_FIELD_H
#define VCG_FCD_DEFORMATION_FIELD_H

#include <vcg_ext/surface/nearest_place.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <string>
#include <vector>

namespace vcg::fcd {

/// A sampled deformation of a surface. All in the same units.
struct FieldSamples {
    Eigen::Matrix3Xd position;                  ///< 3 x n, at rest
    Eigen::Matrix3Xd displacement;              ///< 3 x n
    std::vector<Eigen::Matrix3f> gradient;      ///< n, of the displacement
    std::vector<std::array<Index, 3>> triangle; ///< corners in [0, n), repeated for an edge or a point; empty: a cloud
    /// Largest error at a vertex of the surface that was sampled; NaN if unknown.
    double largestDifference = std::numeric_limits<double>::quiet_NaN();
    Index Size() const { return Index(position.cols()); }
};

/// A deformation of all space, from samples on a surface: a point moves with the nearest place of the surface.
///
/// Let q be the nearest place, x_k, u_k and G_k the position, displacement and gradient of the samples around it, and
/// w_k their weights. The displacement of p is sum_k w_k (u_k + G_k ((q - x_k) / 2 + p - q)). (The factor 1/2 makes it
/// of third order in the spacing of the samples. With 0, it would be linear interpolation, with 1, a blend of affine
/// maps; both are of second order, with opposite errors.) It is exactly 0 if no sample around q moves. The bits for a
/// point depend on no other point and no thread.
class DeformationField {
  public:
    /// \pre at least one sample, no number beyond 1e100 \throw Cancelled
    explicit DeformationField(FieldSamples given, const Progress &progress = {});

    /// The displacement of \p p; 0 for a point that is not finite, or beyond 1e100. \param linear if not null, out: the
    /// linear map there \param hint if not null, in: of a point nearby, out: of this one; it only saves time
    Eigen::Vector3d operator()(const Eigen::Vector3d &p, Eigen::Matrix3f *linear = nullptr,
                               NearestPlace::Hint *hint = nullptr) const;

    const FieldSamples samples;

  private:
    const NearestPlace places;
};

/// A warning about points that lie far from a surface whose deformation they take, or are of other units; empty: none.
/// \param what names them: "The points are" \param here, source boxes of both, world units \param smallest size of the
/// points over that of the surface that is not too small; 0: they may be a small part of it
std::string SpaceRemark(const std::string &what, const Eigen::AlignedBox3d &here, const Eigen::AlignedBox3d &source,
                        double smallest);

} // namespace vcg::fcd

#endif
