// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_field.h>

#include <utility>

namespace vcg::fcd {

DeformationField::DeformationField(FieldSamples given, const Progress &progress)
    : samples(std::move(given)),
      places(samples.position, samples.triangle, std::vector<char>(std::size_t(samples.Size()), 1), progress) {}

Eigen::Vector3d DeformationField::operator()(const Eigen::Vector3d &p, Eigen::Matrix3f *linear,
                                             NearestPlace::Hint *hint) const {
    NearestPlace::Hint none = {};
    const bool isPlace = p.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= 1e100;
    const SurfacePlace place = isPlace ? places(p, hint ? *hint : none) : SurfacePlace();
    Eigen::Vector3d q = Eigen::Vector3d::Zero(), displacement = Eigen::Vector3d::Zero();
    for (int k = 0; k < place.count; ++k)
        q += place.weight[k] * samples.position.col(place.slot[k]);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int k = 0; k < place.count; ++k) {
        const Index i = place.slot[k];
        const Eigen::Matrix3d own = samples.gradient[i].cast<double>();
        const Eigen::Vector3d toPlace = q - samples.position.col(i);
        displacement += place.weight[k] * (samples.displacement.col(i) + 0.5 * (own * toPlace));
        gradient += place.weight[k] * own;
    }
    if (place.count > 0)
        displacement += gradient * (p - q);
    if (linear)
        *linear = (Eigen::Matrix3d::Identity() + gradient).cast<float>();
    return displacement;
}

} // namespace vcg::fcd
