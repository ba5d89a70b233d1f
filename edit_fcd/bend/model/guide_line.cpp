// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/guide_line.h"

#include "edit_fcd/shape/script_call.h"

#include <vcg_ext/base/words.h>

#include <layer_fcd/point_sources.h>
#include <layer_fcd/save_files.h>

using vcg::fcd::Error;
using vcg::fcd::detail::ToText;

Eigen::Matrix3Xd lineOf(const BendSession &session) {
    const std::vector<BendLinePoint> &line = session.state().line;
    Eigen::Matrix3Xd points(3, Eigen::Index(line.size()));
    for (std::size_t i = 0; i < line.size(); ++i) {
        Eigen::Vector3d place = line[i].place;
        for (int k = 0; k < 3; ++k)
            if (line[i].weight[k] != 0)
                place += line[i].weight[k] * session.positionOf(line[i].corner[std::size_t(k)]);
        points.col(Eigen::Index(i)) = rounded<Scalarm>(place); // in a layer's precision
    }
    return points;
}

Eigen::Matrix3Xd expectedLine(const BendSession &session) {
    if (session.state().line.size() < 2)
        throw Error("There is no line yet: click points along the layer, in their order, or choose a layer with "
                    "edges.");
    return lineOf(session);
}

std::vector<BendLinePoint> loadLine(const QString &file) {
    const Eigen::Matrix3Xd points = readLine(file);
    std::vector<BendLinePoint> read(std::size_t(points.cols()));
    for (std::size_t i = 0; i < read.size(); ++i)
        read[i].place = points.col(Eigen::Index(i));
    return read;
}

void saveLine(const BendSession &session, const QString &file) {
    std::string text = "x, y, z\n";
    const Eigen::Matrix3Xd points = lineOf(session);
    for (const auto &point : points.colwise())
        text += ToText(point[0]) + ", " + ToText(point[1]) + ", " + ToText(point[2]) + "\n";
    saveFiles({{file, text}});
}

std::string straightenCall(const StraightenMeshParam &param, const MeshModel *line) {
    const StraightenMeshParam usual;
    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    ScriptCall call("generate_fcd_straightened_mesh");
    call.with("line_layer", (line ? line : param.lineLayer)->id())
        .with("middle", param.middle, usual.middle)
        .with("to", int(param.shape), int(usual.shape));
    if (param.shape == StraightenMeshParam::Arc)
        call.with("angle", param.angle);
    call.with("direction", param.direction, none).with("towards", param.towards, none);
    if (param.shape == StraightenMeshParam::Line)
        call.with("target_layer", param.targetLayer->id()).with("reverse", param.reverse, usual.reverse);
    return call.with("length", param.length, usual.length)
        .with("untwist", param.untwist, usual.untwist)
        .with("graph_layers", param.graphLayers, usual.graphLayers)
        .end();
}
