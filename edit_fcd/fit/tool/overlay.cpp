// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/tool/overlay.h"

#include "edit_fcd/view/layer_drawing.h"

#include <layer_fcd/edit_host.h>

namespace {

const GLubyte sourceColor[] = {45, 110, 235}, targetColor[] = {245, 140, 25}, ringColor[] = {255, 255, 255};

void drawEnd(const Eigen::Vector3d &p, const GLubyte *color, bool isSelected) {
    for (const bool isRing : {true, false}) {
        glPointSize((isSelected ? 14.f : 10.f) - (isRing ? 0.f : 4.f));
        glColor3ubv(isRing ? ringColor : color);
        glBegin(GL_POINTS);
        glVertex3d(p[0], p[1], p[2]);
        glEnd();
    }
}

/// Draws over all else, with round points.
class PairDrawing : public FlatDrawing {
  public:
    PairDrawing() {
        glEnable(GL_POINT_SMOOTH);
        glEnable(GL_BLEND);
        glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    }
};

void drawLine(const std::vector<Eigen::Vector3d> &places, const GLubyte *color) {
    for (const bool isRim : {true, false}) {
        glLineWidth(isRim ? 5.f : 3.f);
        glColor3ubv(isRim ? ringColor : color);
        glBegin(GL_LINE_STRIP);
        for (const Eigen::Vector3d &p : places)
            glVertex3d(p[0], p[1], p[2]);
        glEnd();
    }
}

} // namespace

std::optional<FitEnd> endAt(const FitSession &session, const FitMarks &marks, const Camera &view,
                            const Eigen::Vector2d &window) {
    double least = 10; // pixels
    std::optional<FitEnd> found;
    const std::vector<FitPair> &pairs = session.state().pairs;
    for (const bool isTarget : {true, false})
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const FitPair &pair = pairs[i];
            std::optional<Eigen::Vector3d> p;
            if (isTarget && marks.showsTarget)
                p = pair.place;
            else if (!isTarget && marks.showsSource && pair.slot)
                p = session.positionOf(*pair.slot);
            if (!p)
                continue;
            const double distance = (view.toWindow(*p).head<2>() - window).norm();
            if (distance < least) {
                least = distance;
                found = FitEnd{i, isTarget};
            }
        }
    return found;
}

void drawCurves(const FitSession &session, const FitMarks &marks) {
    const std::shared_ptr<const FitLines> &lines = session.state().lines;
    if (!lines)
        return;
    const PairDrawing drawing;
    const RestGuard &rest = session.restShape();
    for (std::size_t c = 0; c < lines->curves.size(); ++c) {
        std::vector<Eigen::Vector3d> source;
        source.reserve(lines->curves[c].source.size());
        for (std::size_t k = 0; k < lines->curves[c].source.size(); ++k) { // moves with its nearest vertex
            const std::size_t slot = lines->nearest[c][k];
            source.emplace_back(lines->curves[c].source[k] + session.positionOf(slot) - rest.world() * rest.at(slot));
        }
        if (marks.showsTarget)
            drawLine(lines->curves[c].target, targetColor);
        if (marks.showsSource)
            drawLine(source, sourceColor);
    }
}

void drawPairs(const FitSession &session, const FitMarks &marks) {
    const PairDrawing drawing;
    const std::vector<FitPair> &pairs = session.state().pairs;
    if (marks.showsSource && marks.showsTarget) {
        glLineWidth(2);
        glColor3ub(240, 240, 240);
        glBegin(GL_LINES);
        for (const FitPair &each : pairs)
            if (each.slot && each.place)
                for (const Eigen::Vector3d &p : {session.positionOf(*each.slot), *each.place})
                    glVertex3d(p[0], p[1], p[2]);
        glEnd();
    }
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const FitPair &each = pairs[i];
        if (marks.showsSource && each.slot)
            drawEnd(session.positionOf(*each.slot), sourceColor, int(i) == marks.selected);
        if (marks.showsTarget && each.place)
            drawEnd(*each.place, targetColor, int(i) == marks.selected);
    }
}
