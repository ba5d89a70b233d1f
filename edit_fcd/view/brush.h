// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BRUSH_H
#define FCD_BRUSH_H

#include <layer_fcd/edit_host.h> // before Qt

#include "edit_fcd/view/camera.h"

#include <functional>
#include <vector>

/// \file
/// What of the world a brush or an outline covers in a window. All coordinates are those of the window: pixels of the
/// device, y up.

/// Depths of the window as it is drawn, from its lowest row on, from 0 to 1.
std::vector<float> depthOf(GLArea &view, const Camera &seen);

/// Whether places of the world are in a part of the window, and seen there.
class SeenPart {
  public:
    using IsIn = std::function<bool(const Eigen::Vector2d &)>;

    /// All of these must outlive it. \param depth as depthOf gives it; empty: what is hidden is as good
    /// \param diagonal of the layer, world units: a place a hair of it behind what is seen is seen as well
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

/// Those of so many vertex slots that \p isSeen says yes to, ascending.
template <class IsSeen>
std::vector<std::size_t> slotsThat(std::size_t count, const IsSeen &isSeen) {
    using vcg::fcd::Index;
    return vcg::fcd::CollectInOrder<std::size_t>(vcg::fcd::Progress(), "Marking", Index(count),
                                                 [&](Index i, std::vector<std::size_t> &found) {
                                                     if (isSeen(std::size_t(i)))
                                                         found.push_back(std::size_t(i));
                                                 });
}

/// Draws a polygon in the window.
void drawOutline(const Camera &seen, const std::vector<Eigen::Vector2d> &polygon);
/// How many pixels a brush has once the wheel has made steps, one at least for each.
int brushAfter(int pixels, double steps);
/// Draws how far a brush reaches.
void drawBrush(const Camera &seen, const Eigen::Vector2d &place, double radius);

#endif
