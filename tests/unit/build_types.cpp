// SPDX-License-Identifier: GPL-3.0-or-later
//
// Deforms some meshes and writes where the vertices go to a file, or compares with what another build of this program
// wrote:
//   build_types write FILE
//   build_types compare FILE
#include "centroidal_deformation.h"
#include "test_mesh.h"

#include <fstream>
#include <iostream>

using namespace fcd_test;

/// Coordinates, one after the other.
static std::vector<double> Deform(const Shape &shape, vcg::fcd::MappingWeights weights) {
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

int main(int argc, char **argv) {
    const std::string mode = argc == 3 ? argv[1] : "";
    if (mode != "write" && mode != "compare") {
        std::cerr << "usage: build_types write|compare FILE\n";
        return 2;
    }
    std::vector<double> now;
    const Shape tube = Jittered(Tube(60, 24), 0.02);
    const Shape loose = Join(Unwelded(tube), Moved(Sphere(6, 8), Eigen::Affine3d(Eigen::Translation3d(4, 0, 3))));
    for (const Shape &shape : {tube, Points(tube), loose})
        for (auto weights : {vcg::fcd::MappingWeights::Surface, vcg::fcd::MappingWeights::Euclidean}) {
            const std::vector<double> x = Deform(shape, weights);
            now.insert(now.end(), x.begin(), x.end());
        }
    if (mode == "write") {
        std::ofstream file(argv[2], std::ios::binary);
        file.write(reinterpret_cast<const char *>(now.data()), std::streamsize(now.size() * sizeof now[0]));
        return file.good() ? 0 : 1;
    }
    std::vector<double> before(now.size() + 1);
    std::ifstream file(argv[2], std::ios::binary);
    file.read(reinterpret_cast<char *>(before.data()), std::streamsize(before.size() * sizeof before[0]));
    if (file.gcount() != std::streamsize(now.size() * sizeof now[0])) {
        std::cerr << argv[2] << " holds " << file.gcount() << " bytes, not " << now.size() * sizeof now[0] << "\n";
        return 1;
    }
    double difference = 0;
    for (std::size_t i = 0; i < now.size(); ++i)
        difference = std::max(difference, std::isfinite(now[i]) ? std::abs(now[i] - before[i]) : 1);
    std::cout << now.size() << " coordinates, which differ by at most " << difference << "\n";
    return difference <= 1e-9 ? 0 : 1;
}
