// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/session.h"

#include <vcg_ext/base/words.h>

#include <layer_fcd/line_sources.h>
#include <layer_fcd/save_files.h>

#include <sstream>

// The line that a layer is straightened along.

using vcg::fcd::Error;
using vcg::fcd::detail::ToText;

Eigen::Matrix3Xd BendSession::line() const {
    Eigen::Matrix3Xd points(3, Eigen::Index(now.line.size()));
    for (std::size_t i = 0; i < now.line.size(); ++i) {
        const BendLinePoint &each = now.line[i];
        Eigen::Vector3d place = each.place;
        for (int k = 0; k < 3; ++k)
            if (each.weight[k] != 0)
                place += each.weight[k] * positionOf(each.corner[std::size_t(k)]);
        points.col(Eigen::Index(i)) = rounded<Scalarm>(place); // as a layer has it
    }
    return points;
}

void BendSession::expectLine() const {
    if (now.line.size() < 2)
        throw Error("There is no line yet: click points along the layer, in their order, or choose a layer with "
                    "edges.");
}

void BendSession::loadLine(const QString &file) {
    const Eigen::Matrix3Xd points = readLine(file);
    std::vector<BendLinePoint> read(std::size_t(points.cols()));
    for (std::size_t i = 0; i < read.size(); ++i)
        read[i].place = points.col(Eigen::Index(i));
    setLine(std::move(read));
}

void BendSession::saveLine(const QString &file) const {
    const Eigen::Matrix3Xd points = line();
    std::string text = "x, y, z\n";
    for (const auto &point : points.colwise())
        text += ToText(point[0]) + ", " + ToText(point[1]) + ", " + ToText(point[2]) + "\n";
    saveFiles({{file, text}});
}

std::string BendSession::straightenCall(const StraightenMeshParam &param, const MeshModel *line) {
    const StraightenMeshParam usual;
    std::ostringstream call;
    call << "ms.apply_filter('generate_fcd_straightened_mesh', line_layer=" << (line ? line : param.lineLayer)->id();
    const auto flag = [&](const char *name, bool value, bool usually) {
        if (value != usually)
            call << ", " << name << "=" << (value ? "True" : "False");
    };
    flag("middle", param.middle, usual.middle);
    if (param.shape != usual.shape)
        call << ", to=" << int(param.shape);
    if (param.shape == StraightenMeshParam::Arc)
        call << ", angle=" << ToText(param.angle);
    const auto vector = [&](const char *name, const Eigen::Vector3d &value) {
        if (!value.isZero(0))
            call << ", " << name << "=numpy.array([" << ToText(value[0]) << ", " << ToText(value[1]) << ", "
                 << ToText(value[2]) << "])";
    };
    vector("direction", param.direction);
    vector("towards", param.towards);
    if (param.shape == StraightenMeshParam::Line) {
        call << ", target_layer=" << param.targetLayer->id();
        flag("reverse", param.reverse, usual.reverse);
    }
    if (param.length != usual.length)
        call << ", length=" << ToText(param.length);
    flag("untwist", param.untwist, usual.untwist);
    flag("graph_layers", param.graphLayers, usual.graphLayers);
    call << ")";
    return call.str();
}
