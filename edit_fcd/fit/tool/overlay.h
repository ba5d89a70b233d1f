// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_OVERLAY_H
#define FCD_FIT_OVERLAY_H

#include "edit_fcd/view/camera.h" // before Qt
#include "edit_fcd/fit/model/session.h"

/// Which marks of pairs are drawn.
struct FitMarks {
    bool showsSource = true, showsTarget = true;
    int selected = -1; ///< pair, -1: none
};

/// One end of a pair.
struct FitEnd {
    std::size_t pair = 0;
    bool isTarget = false;
};

/// The end of a pair at a place of the window; of two ends, that on the target.
std::optional<FitEnd> endAt(const FitSession &session, const FitMarks &marks, const Camera &view,
                            const Eigen::Vector2d &window);

/// Draws the curves over all else, in the colours of the pairs. Draw the pairs afterwards.
void drawCurves(const FitSession &session, const FitMarks &marks);

/// Draws the pairs over all else: ends on the layer blue, ends on the target orange, and lines between.
void drawPairs(const FitSession &session, const FitMarks &marks);

#endif
