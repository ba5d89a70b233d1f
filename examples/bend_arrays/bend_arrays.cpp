// SPDX-License-Identifier: GPL-3.0-or-later
// Bends a strip of 201 x 41 points, 10 long: the first tenth stays, the last one is lifted, and the rest follows.
#include <vcg_ext/deformer.h>

#include <cstdio>

int main() try {
    const int columns = 201, rows = 41;
    Eigen::Matrix3Xd position(3, columns * rows); // x, y, z of each vertex
    std::vector<std::uint32_t> corner;            // three vertices a face
    vcg::fcd::Handles handles;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
            const auto vertex = std::uint32_t(i * rows + j);
            position.col(vertex) << i / 20.0, j / 20.0, 0;
            handles.tag.push_back(i < 20 ? 0 : i > 180 ? 2 : 1); // 0 stays, 1 is free, 2 is a handle
            if (i > 0 && j > 0)
                for (std::uint32_t each :
                     {vertex, vertex - rows, vertex - 1, vertex - 1, vertex - rows, vertex - rows - 1})
                    corner.push_back(each);
        }
    handles.motion[2] = vcg::fcd::Motion(Eigen::Affine3d(Eigen::Translation3d(-1, 0, 3)).matrix());

    vcg::fcd::SurfaceView surface;
    surface.position = position.data();
    surface.vertexSlots = std::size_t(position.cols());
    surface.corner = corner.data();
    surface.faces = corner.size() / 3;
    const vcg::fcd::DeformationResult bent =
        vcg::fcd::DeformSurface(surface, {}, handles, vcg::fcd::DeformationParam());
    std::printf("%d nodes, %d iterations, moved by up to %.3f\n", int(bent.rest.position.cols()), bent.iterations,
                (bent.position - position).colwise().norm().maxCoeff());
} catch (const vcg::fcd::Error &error) { // says what to do
    return std::fprintf(stderr, "%s\n", error.what()), 1;
}
