// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/deformation_field.h>

#include <sstream>
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

std::string SpaceRemark(const std::string &what, const Eigen::AlignedBox3d &here, const Eigen::AlignedBox3d &source,
                        double smallest) {
    if (here.isEmpty() || source.isEmpty())
        return {};
    const double size = here.diagonal().norm(), sourceSize = source.diagonal().norm(),
                 gap = here.exteriorDistance(source);
    const bool isFar = gap > sourceSize;
    if (!isFar && size <= 10 * sourceSize && size >= smallest * sourceSize)
        return {};
    std::ostringstream text;
    text << what << " " << size << " across and the source " << sourceSize;
    if (isFar)
        text << ", and they are " << gap << " apart";
    text << ": a deformation means nothing so far from its source. Bring both to the same place and units first.";
    return text.str();
}

} // namespace vcg::fcd
