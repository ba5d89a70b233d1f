// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_WEIGHT_BRUSH_H
#define FCD_WEIGHT_BRUSH_H

#include "edit_fcd/fit/model/session.h"
#include "edit_fcd/view/brush.h"

/// A stroke of the brush that paints what counts in a fit, on the layer or on its target.
class WeightBrush {
  public:
    /// A stroke begins. \param weight as FitSession::paint takes it
    WeightBrush(FitSession &session, MeshModel &on, float weight, GLArea &view, const Camera &seen);
    int layer() const { return layerId; } ///< its number
    /// Paints what is seen within \p radius of the way of the mouse from where it was. \param on the layer
    /// \param to pixels of the device
    void moveTo(const Eigen::Vector2d &to, double radius, const MeshModel &on, const Camera &seen);
    /// \return whether anything has another weight
    bool end() { return session.endStroke(); }

  private:
    FitSession &session;
    int layerId;
    float weight;
    std::vector<float> depth;
    std::optional<Eigen::Vector2d> from;
};

/// The colours that show what of a layer is carried along, one per vertex slot; empty where all counts.
std::vector<vcg::Color4b> colorsOfCarried(const FitWeights &weights);

#endif
