// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_WEIGHT_BRUSH_H
#define FCD_WEIGHT_BRUSH_H

#include "edit_fcd/fit/model/session.h"
#include "edit_fcd/view/brush.h"

/// A stroke of the brush that paints weights for a fit, on the layer or on its target.
class WeightBrush {
  public:
    /// Begins the stroke. \param weight as of FitSession::paint
    WeightBrush(FitSession &session, MeshModel &on, float weight, GLArea &view, const Camera &seen);
    int layer() const { return layerId; } ///< its number
    /// Paints the visible vertices within \p radius of the mouse's path since the last call. \param on the layer
    /// \param to pixels of the device
    void moveTo(const Eigen::Vector2d &to, double radius, const MeshModel &on, const Camera &seen);
    /// \return whether any weight has changed
    bool end() { return session.endStroke(); }

  private:
    FitSession &session;
    int layerId;
    float weight;
    std::vector<float> depth;
    std::optional<Eigen::Vector2d> from;
};

/// Colours of vertices that are carried along, one per vertex slot; empty if all count.
std::vector<vcg::Color4b> colorsOfCarried(const FitWeights &weights);

#endif
