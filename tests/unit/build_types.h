// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TEST_BUILD_TYPES_H
#define FCD_TEST_BUILD_TYPES_H

#include <vcg_ext/centroidal_deformation.h>
#include "test_mesh.h"

namespace fcd_test::build_types {

/// Coordinates, one after the other.
inline std::vector<double> Deformed(const Shape &shape, vcg::fcd::MappingWeights weights) {
    const MeshD mesh(shape);
    vcg::fcd::Handles handles;
    for (const Eigen::Vector3d &p : shape.position)
        handles.tag.push_back(p[2] < 1 ? 0 : p[2] > 5 ? 2 : 1);
    Eigen::Affine3d motion(Eigen::AngleAxisd(1, Eigen::Vector3d(1, 0.3, 0.2).normalized()));
    motion.translation() << 1.5, 0.5, -0.5;
    handles.motion[2] = vcg::fcd::Motion(motion.matrix());
    vcg::fcd::DeformationParam param;
    param.graph.initialPatches = 40;
    param.weights = weights;
    const Eigen::Matrix3Xd x = vcg::tri::DeformCentroidal(mesh, handles, param).position;
    return std::vector<double>(x.data(), x.data() + x.size());
}

/// Where the vertices of some meshes go.
inline std::vector<double> Deformed() {
    std::vector<double> all;
    const Shape tube = Jittered(Tube(60, 24), 0.02);
    const Shape loose = Join(Unwelded(tube), Moved(Sphere(6, 8), Eigen::Affine3d(Eigen::Translation3d(4, 0, 3))));
    for (const Shape &shape : {tube, Points(tube), loose})
        for (auto weights : {vcg::fcd::MappingWeights::Surface, vcg::fcd::MappingWeights::Euclidean}) {
            const std::vector<double> x = Deformed(shape, weights);
            all.insert(all.end(), x.begin(), x.end());
        }
    return all;
}

} // namespace fcd_test::build_types

#endif
