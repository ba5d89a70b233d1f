// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARKING_H
#define FCD_MARKING_H

#include "edit_fcd/bend/model/session.h"
#include "edit_fcd/view/brush.h"

/// A marking in a view: by a brush, a rectangle or a polygon. Window coordinates.
struct BendMarking {
    enum Kind { Brush, Rectangle, Polygon };

    Kind kind = Brush;
    std::vector<Eigen::Vector2d> corners; ///< of a polygon; a rectangle's two opposite ones; a brush's last place
    std::vector<float> depth;             ///< from depthOf, to mark visible vertices only; empty: all

    /// The outline; empty for a brush.
    std::vector<Eigen::Vector2d> outline() const;
    /// The vertices inside the outline, and those on the other side of the mirror.
    std::vector<std::size_t> inside(const BendSession &session, const Camera &view) const;
    /// Moves the brush. \return the same vertices, within \p radius of its path
    std::vector<std::size_t> strokeTo(const Eigen::Vector2d &to, double radius, const BendSession &session,
                                      const Camera &view);

  private:
    std::vector<std::size_t> verticesIn(const SeenPart::IsIn &isIn, const BendSession &session,
                                        const Camera &view) const;
};

#endif
