// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARKING_H
#define FCD_MARKING_H

#include "edit_fcd/bend/model/session.h"
#include "edit_fcd/view/brush.h"

/// What is being marked in a view: by a brush, a rectangle or a polygon. All coordinates are those of the window.
struct BendMarking {
    enum Kind { Brush, Rectangle, Polygon };

    Kind kind = Brush;
    std::vector<Eigen::Vector2d> corners; ///< of a rectangle two opposite ones, of a brush its last place
    std::vector<float> depth;             ///< as depthOf gives it, where only what is seen is marked; else empty

    /// The polygon that is marked; of a brush none.
    std::vector<Eigen::Vector2d> outline() const;
    /// Vertices inside of the outline, and those on the other side of the mirror.
    std::vector<std::size_t> inside(const BendSession &session, const Camera &view) const;
    /// Moves the brush. \return vertices, as above, within \p radius of its way
    std::vector<std::size_t> strokeTo(const Eigen::Vector2d &to, double radius, const BendSession &session,
                                      const Camera &view);

  private:
    std::vector<std::size_t> verticesIn(const SeenPart::IsIn &isIn, const BendSession &session,
                                        const Camera &view) const;
};

#endif
