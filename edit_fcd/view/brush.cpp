// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/brush.h"

#include "edit_fcd/view/layer_drawing.h"

#include <cmath>

std::vector<float> depthOf(GLArea &view, const Camera &seen) {
    std::vector<float> depth(std::size_t(seen.width) * std::size_t(seen.height), 1);
    view.makeCurrent();
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, seen.width, seen.height, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data());
    return depth;
}

bool SeenPart::has(const Eigen::Vector3d &p) const {
    const Eigen::Vector3d window = seen.toWindow(p);
    return window[2] <= 1 && isIn(window.head<2>()) && (depth.empty() || isSeen(p, window));
}

bool SeenPart::isSeen(const Eigen::Vector3d &p, const Eigen::Vector3d &window) const {
    const Eigen::Vector3d eye = seen.towardsEye(p);
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            const int x = int(window[0]) + dx, y = int(window[1]) + dy;
            if (x < 0 || y < 0 || x >= seen.width || y >= seen.height)
                continue;
            const double there = depth[std::size_t(y) * std::size_t(seen.width) + std::size_t(x)];
            if (there < 1 && (seen.toWorld({x + 0.5, y + 0.5, there}) - p).dot(eye) < hair)
                return true;
        }
    return false;
}

void drawOutline(const Camera &seen, const std::vector<Eigen::Vector2d> &polygon) {
    const FlatDrawing flat;
    glMatrixMode(GL_PROJECTION);
    glPushMatrix();
    glLoadIdentity();
    glOrtho(0, seen.width, 0, seen.height, -1, 1);
    glMatrixMode(GL_MODELVIEW);
    glPushMatrix();
    glLoadIdentity();
    for (const bool isInner : {false, true}) { // dark around light: seen on any ground
        glLineWidth(isInner ? 2 : 4);
        const GLubyte shade = isInner ? 240 : 20;
        glColor3ub(shade, shade, shade);
        glBegin(GL_LINE_LOOP);
        for (const Eigen::Vector2d &corner : polygon)
            glVertex2d(corner[0], corner[1]);
        glEnd();
    }
    glPopMatrix();
    glMatrixMode(GL_PROJECTION);
    glPopMatrix();
    glMatrixMode(GL_MODELVIEW);
}

int brushAfter(int pixels, double steps) {
    return int(std::lround(pixels * std::pow(1.15, steps) + (steps > 0 ? 0.5 : -0.5)));
}

void drawBrush(const Camera &seen, const Eigen::Vector2d &place, double radius) {
    std::vector<Eigen::Vector2d> circle(40, place);
    for (std::size_t i = 0; i < circle.size(); ++i)
        circle[i] += radius * Eigen::Vector2d(std::cos(double(i) * 9 * oneDegree), std::sin(double(i) * 9 * oneDegree));
    drawOutline(seen, circle);
}
