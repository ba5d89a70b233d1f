// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h> // before Qt

#include "edit_fcd/fit/model/lines.h"

#include <layer_fcd/layer_matrix.h>

#include <QFile>

std::shared_ptr<const FitLines> loadLines(const MeshModel &layer, const Point3m *rest, const std::string &file) {
    auto lines = std::make_shared<FitLines>();
    lines->file = file;
    lines->curves = vcg::fcd::ReadCurveFile(QFile::encodeName(QString::fromStdString(file)).toStdString());
    const Eigen::Affine3d world = invertibleMatrixOf(layer);
    std::vector<std::size_t> slot;
    std::vector<Eigen::Vector3d> position;
    for (std::size_t i = 0; i < layer.cm.vert.size(); ++i)
        if (!layer.cm.vert[i].IsD()) {
            slot.push_back(i);
            position.push_back(world * toVector(rest[i]));
        }
    const vcg::fcd::PointTree<double> tree(position);
    for (const vcg::fcd::CurvePair &curve : lines->curves) {
        std::vector<std::size_t> &nearest = lines->nearest.emplace_back();
        for (const Eigen::Vector3d &corner : curve.source)
            nearest.push_back(slot[std::size_t(tree.Nearest(corner))]);
    }
    return lines;
}
