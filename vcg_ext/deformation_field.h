// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_FIELD_H
#define VCG_FCD_DEFORMATION_FIELD_H

#include "nearest_place.h"

#include <utility>

namespace vcg {
namespace fcd {

/// Samples of a deformation: how each vertex of a surface moves, and how the surface turns and stretches around it.
struct FieldSamples {
    Eigen::Matrix3Xd position;                  ///< 3 x n, at rest
    Eigen::Matrix3Xd displacement;              ///< 3 x n, from there
    std::vector<Eigen::Matrix3f> gradient;      ///< n, of the displacement: 0 where nothing turns or stretches
    std::vector<std::array<Index, 3>> triangle; ///< corners in [0, n), equal ones for an edge or a point;
                                                ///< empty: a cloud
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
    /// \pre at least one sample, no number beyond 1e100
    explicit DeformationField(FieldSamples given)
        : samples(std::move(given)),
          places(samples.position, samples.triangle, std::vector<char>(std::size_t(samples.Size()), 1)) {}

    /// The displacement of \p p; 0 for a point that is not finite, or beyond 1e100. \param linear if given: how space
    /// turns and stretches there
    Eigen::Vector3d operator()(const Eigen::Vector3d &p, Eigen::Matrix3f *linear = nullptr) const {
        const bool isPlace = p.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e100;
        const SurfacePlace place = isPlace ? places(p) : SurfacePlace();
        Eigen::Vector3d q = Eigen::Vector3d::Zero(), way = Eigen::Vector3d::Zero();
        for (int k = 0; k < place.count; ++k)
            q += place.weight[k] * samples.position.col(place.slot[k]);
        Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
        for (int k = 0; k < place.count; ++k) {
            const Index i = place.slot[k];
            const Eigen::Matrix3d own = samples.gradient[std::size_t(i)].cast<double>();
            const Eigen::Vector3d toPlace = q - samples.position.col(i);
            way += place.weight[k] * (samples.displacement.col(i) + 0.5 * (own * toPlace));
            gradient += place.weight[k] * own;
        }
        if (place.count > 0)
            way += gradient * (p - q);
        if (linear)
            *linear = (Eigen::Matrix3d::Identity() + gradient).cast<float>();
        return way;
    }

    const FieldSamples samples;

  private:
    const NearestPlace places;
};

} // namespace fcd
} // namespace vcg

#endif
