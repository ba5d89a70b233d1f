// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/tool/marking.h"

#include <QPolygonF>

std::vector<Eigen::Vector2d> BendMarking::outline() const {
    if (kind == Polygon)
        return corners;
    if (kind == Rectangle && corners.size() == 2)
        return {corners[0], {corners[1][0], corners[0][1]}, corners[1], {corners[0][0], corners[1][1]}};
    return {};
}

std::vector<std::size_t> BendMarking::inside(const BendSession &session, const Camera &view) const {
    QPolygonF polygon;
    for (const Eigen::Vector2d &corner : outline())
        polygon << QPointF(corner[0], corner[1]);
    return verticesIn(
        [&](const Eigen::Vector2d &p) { return polygon.containsPoint(QPointF(p[0], p[1]), Qt::OddEvenFill); }, session,
        view);
}

std::vector<std::size_t> BendMarking::strokeTo(const Eigen::Vector2d &to, double radius, const BendSession &session,
                                               const Camera &view) {
    const Eigen::Vector2d from = corners.empty() ? to : corners.back();
    corners = {to};
    return verticesIn([&](const Eigen::Vector2d &p) { return distanceToSegment(p, from, to) <= radius; }, session,
                      view);
}

std::vector<std::size_t> BendMarking::verticesIn(const SeenPart::IsIn &isIn, const BendSession &session,
                                                 const Camera &view) const {
    const Eigen::Affine3d mirror = mirrorOf(session.model());
    const SeenPart part(view, isIn, depth, session.diagonal());
    return slotsThat(session.tags().size(), [&](std::size_t slot) {
        if (session.restShape().isDeleted(slot))
            return false;
        const Eigen::Vector3d p = session.positionOf(slot);
        return part.has(p) || (session.model().options.mirror >= 0 && part.has(mirror * p));
    });
}
