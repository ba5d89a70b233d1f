// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POINTING_H
#define FCD_POINTING_H

#include "edit_fcd/view/camera.h"

#include <layer_fcd/edit_host.h> // before Qt
#include <layer_fcd/meshlab_host.h>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

/// \file
/// Brushes and outlines in a window. All coordinates are window coordinates: pixels of the device, y up.

/// The depths of the drawn window, [0, 1], row by row from the lowest.
std::vector<float> depthOf(GLArea &view, const Camera &seen);

/// Tells whether points are visible in a part of the window.
class SeenPart {
  public:
    using IsIn = std::function<bool(const Eigen::Vector2d &)>;

    /// All arguments must outlive it. \param depth from depthOf; empty: hidden points count, too \param diagonal of the
    /// layer, world units: points 0.5 % of it behind the visible surface are visible
    SeenPart(const Camera &seen, const IsIn &isIn, const std::vector<float> &depth, double diagonal)
        : seen(seen), isIn(isIn), depth(depth), hair(0.005 * diagonal) {}
    bool has(const Eigen::Vector3d &p) const;

  private:
    bool isSeen(const Eigen::Vector3d &p, const Eigen::Vector3d &window) const;

    const Camera &seen;
    const IsIn &isIn;
    const std::vector<float> &depth;
    const double hair;
};

/// The slots below \p count for which \p isSeen, ascending.
template <class IsSeen>
std::vector<std::size_t> slotsThat(std::size_t count, const IsSeen &isSeen) {
    return vcg::fcd::NumbersThat<std::size_t>(vcg::fcd::Progress(), "Marking", count, isSeen);
}

/// Draws a polygon in the window.
void drawOutline(const Camera &seen, const std::vector<Eigen::Vector2d> &polygon);
/// The size of a brush after steps of the wheel, pixels; each step changes it by one at least.
int brushAfter(int pixels, double steps);
/// Draws the outline of a brush.
void drawBrush(const Camera &seen, const Eigen::Vector2d &place, double radius);

/// Where a ray from the eye meets a layer.
struct LayerHit {
    Eigen::Vector3d place;               ///< world
    double depth = 0;                    ///< along the ray, [0, 1], from the near to the far clipping plane
    std::size_t slot = 0;                ///< of the triangle's nearest vertex
    std::array<std::size_t, 3> corner{}; ///< slots of the triangle's corners; without faces, thrice the vertex
    Eigen::Vector3d weight;              ///< of the corners (barycentric)
};

/// The point of a layer nearest to the eye at a point of the window, whatever other layers hide. Without faces, a
/// vertex. \param window pixels of the device, y up \param behind least depth \return none if it is not hit
std::optional<LayerHit> hitLayer(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window,
                                 double behind = 0);

/// The middle between the first and the next point where the ray meets the layer.
std::optional<Eigen::Vector3d> middleBehind(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window);

/// The point nearest to the eye there, of all visible layers but one.
std::optional<Eigen::Vector3d> hitOthers(const MeshDocument &document, const MeshModel &but, const Camera &seen,
                                         const Eigen::Vector2d &window);

#endif
