// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "layer_contents.h"
#include "layer_normals.h"

#include <algorithm>
#include <cmath>

Eigen::Matrix3Xd positionsOf(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    Eigen::Matrix3Xd position(3, Eigen::Index(mesh.vert.size()));
    vcg::fcd::ParallelFor(0, mesh.vert.size(), 1 << 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            position.col(Eigen::Index(i)) = vcg::tri::PositionOf(mesh.vert[i]);
    });
    return position;
}

std::size_t mostBytes(const MeshModel &layer, std::size_t each) { return 1000000 + each * std::size_t(layer.cm.vn); }

std::vector<char> onSelectedFaces(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    std::vector<char> on(mesh.vert.size(), 0);
    for (const CFaceO &face : mesh.face)
        if (!face.IsD() && face.IsS())
            for (int k = 0; k < 3; ++k)
                on[vcg::tri::Index(mesh, face.cV(k))] = 1;
    return on;
}

bool hasQuality(const MeshModel &layer) {
    return layer.hasDataMask(MeshModel::MM_VERTQUALITY) &&
           std::any_of(layer.cm.vert.begin(), layer.cm.vert.end(),
                       [](const CVertexO &vertex) { return !vertex.IsD() && vertex.cQ() != 0; });
}

bool mayHaveTags(const MeshModel &layer) {
    return hasQuality(layer) && std::all_of(layer.cm.vert.begin(), layer.cm.vert.end(), [](const CVertexO &vertex) {
               return vertex.IsD() || vertex.cQ() == std::round(vertex.cQ());
           });
}

bool hasDirections(const MeshModel &layer) {
    return layer.hasDataMask(MeshModel::MM_VERTCURVDIR) || hasOwnNormals(layer);
}
