// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/parallel.h> // before Qt

#include "edit_fcd/view/layer_drawing.h"
#include "edit_fcd/view/pointing.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_matrix.h>
#include <layer_fcd/parameters.h>

#include <cmath>
#include <limits>

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

namespace {

/// Where a ray meets a triangle (T. Moeller, B. Trumbore 1997), in lengths of \p direction, from \p least; or infinity.
double meets(const Eigen::Vector3d &from, const Eigen::Vector3d &direction, const Eigen::Vector3d corner[3],
             double least) {
    const double none = std::numeric_limits<double>::infinity();
    const Eigen::Vector3d a = corner[1] - corner[0], b = corner[2] - corner[0], across = direction.cross(b);
    const double volume = a.dot(across);
    if (volume == 0)
        return none;
    const Eigen::Vector3d off = from - corner[0], other = off.cross(a);
    const double u = off.dot(across) / volume, v = direction.dot(other) / volume, t = b.dot(other) / volume;
    return u >= 0 && v >= 0 && u + v <= 1 && t >= least && t <= 1 ? t : none;
}

} // namespace

std::optional<LayerHit> hitLayer(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window,
                                 double behind) {
    const double none = std::numeric_limits<double>::infinity();
    const CMeshO &mesh = layer.cm;
    const Eigen::Affine3d world = invertibleMatrixOf(layer);
    if (mesh.fn == 0) {
        const double reach = 6; // pixels around the mouse, since points have no size
        const std::optional<Least> hit = leastOf(mesh.vert.size(), [&](std::size_t i) {
            if (mesh.vert[i].IsD())
                return none;
            const Eigen::Vector3d at = seen.toWindow(world * toVector(mesh.vert[i].cP()));
            return (at.head<2>() - window).norm() <= reach && at[2] >= behind && at[2] <= 1 ? at[2] : none;
        });
        if (!hit)
            return {};
        const std::size_t slot = hit->item;
        return LayerHit{world * toVector(mesh.vert[slot].cP()), hit->value, slot, {slot, slot, slot}, {1, 0, 0}};
    }
    const Eigen::Affine3d toLayer = world.inverse();
    const Eigen::Vector3d from = toLayer * seen.toWorld({window[0], window[1], 0}),
                          direction = toLayer * seen.toWorld({window[0], window[1], 1}) - from;
    const std::optional<Least> hit = leastOf(mesh.face.size(), [&](std::size_t f) {
        const CFaceO &face = mesh.face[f];
        if (face.IsD())
            return none;
        const Eigen::Vector3d corner[3] = {toVector(face.cP(0)), toVector(face.cP(1)), toVector(face.cP(2))};
        return meets(from, direction, corner, behind);
    });
    if (!hit)
        return {};
    const CFaceO &face = mesh.face[hit->item];
    const Eigen::Vector3d place = from + hit->value * direction, origin = toVector(face.cP(0)),
                          a = toVector(face.cP(1)) - origin, b = toVector(face.cP(2)) - origin, normal = a.cross(b);
    LayerHit found;
    found.place = world * place;
    found.depth = hit->value;
    found.weight[1] = (place - origin).cross(b).dot(normal) / normal.squaredNorm();
    found.weight[2] = a.cross(place - origin).dot(normal) / normal.squaredNorm();
    found.weight[0] = 1 - found.weight[1] - found.weight[2];
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        found.corner[std::size_t(k)] = std::size_t(face.cV(k) - mesh.vert.data());
        const double distance = (toVector(face.cP(k)) - place).norm();
        if (distance < nearest) {
            nearest = distance;
            found.slot = found.corner[std::size_t(k)];
        }
    }
    return found;
}

std::optional<Eigen::Vector3d> middleBehind(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window) {
    const std::optional<LayerHit> front = hitLayer(layer, seen, window);
    if (!front)
        return {};
    const double beside = 1e-9; // of the ray: skips other triangles at an edge
    const std::optional<LayerHit> back = hitLayer(layer, seen, window, front->depth + beside);
    return back ? Eigen::Vector3d((front->place + back->place) / 2) : front->place;
}

std::optional<Eigen::Vector3d> hitOthers(const MeshDocument &document, const MeshModel &but, const Camera &seen,
                                         const Eigen::Vector2d &window) {
    double least = std::numeric_limits<double>::infinity();
    std::optional<Eigen::Vector3d> first;
    for (const MeshModel *layer : host::layers(document)) {
        if (layer == &but || !layer->isVisible())
            continue;
        try {
            const std::optional<LayerHit> hit = hitLayer(*layer, seen, window);
            if (!hit)
                continue;
            const double depth = seen.toWindow(hit->place)[2];
            if (depth < least) {
                least = depth;
                first = hit->place;
            }
        } catch (const vcg::fcd::Error &) { // a matrix without an inverse: it is not visible
        }
    }
    return first;
}
