// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/weight_brush.h"

#include <layer_fcd/layer_matrix.h>

#include <algorithm>

WeightBrush::WeightBrush(FitSession &session, MeshModel &on, float weight, GLArea &view, const Camera &seen)
    : session(session), layerId(on.id()), weight(weight), depth(depthOf(view, seen)) {
    session.beginStroke(on);
}

void WeightBrush::moveTo(const Eigen::Vector2d &to, double radius, const MeshModel &on, const Camera &seen) {
    const Eigen::Vector2d start = from.value_or(to);
    from = to;
    const SeenPart::IsIn isIn = [&](const Eigen::Vector2d &p) { return distanceToSegment(p, start, to) <= radius; };
    const SeenPart part(seen, isIn, depth, session.restShape().diagonal());
    const Eigen::Affine3d world = matrixOf(on);
    const auto isSeen = [&](std::size_t i) {
        const CVertexO &vertex = on.cm.vert[i];
        return !vertex.IsD() && part.has(world * toVector(vertex.cP()));
    };
    session.paint(slotsThat(on.cm.vert.size(), isSeen), weight);
}

std::vector<vcg::Color4b> colorsOfCarried(const FitWeights &weights) {
    std::vector<vcg::Color4b> colors;
    if (std::all_of(weights.begin(), weights.end(), [](float weight) { return weight >= 1; }))
        return colors;
    colors.reserve(weights.size());
    for (const float weight : weights)
        colors.emplace_back(150, 60, 200, (unsigned char)(weight >= 0 ? 170 * (1 - std::min(weight, 1.f)) : 170));
    return colors;
}
