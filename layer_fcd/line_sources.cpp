// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // these before Qt
#include <vcg_ext/line/line_points.h>

#include "layer_labels.h"
#include "layer_matrix.h"
#include "line_sources.h"
#include "picked_points.h"

using vcg::fcd::Index;

Eigen::Matrix3Xd readLine(const MeshModel &layer) {
    std::vector<std::array<Index, 2>> edges;
    const CMeshO &mesh = layer.cm;
    for (const auto &edge : mesh.edge)
        if (!edge.IsD())
            edges.push_back({Index(edge.cV(0) - mesh.vert.data()), Index(edge.cV(1) - mesh.vert.data())});
    const std::vector<Index> path = vcg::fcd::PathOfEdges(std::move(edges), "The layer " + inQuotes(layer));
    const Eigen::Affine3d matrix = matrixOf(layer);
    Eigen::Matrix3Xd points(3, Eigen::Index(path.size()));
    for (std::size_t i = 0; i < path.size(); ++i)
        points.col(Eigen::Index(i)) = matrix * toVector(mesh.vert[std::size_t(path[i])].cP());
    return points;
}

Eigen::Matrix3Xd readLine(const QString &file) {
    const std::size_t most = 100000000; // bytes, of a million points
    const std::string text = vcg::fcd::ReadFile(pathOf(file), most);
    if (!file.endsWith(".pp", Qt::CaseInsensitive))
        return vcg::fcd::ReadLineText(text, file.toStdString());
    const std::vector<Eigen::Vector3d> picked = readActivePoints(QByteArray::fromStdString(text), inQuotes(file));
    Eigen::Matrix3Xd points(3, Eigen::Index(picked.size()));
    for (std::size_t i = 0; i < picked.size(); ++i)
        points.col(Eigen::Index(i)) = picked[i];
    return points;
}
