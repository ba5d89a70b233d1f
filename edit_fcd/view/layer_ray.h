// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_RAY_H
#define FCD_LAYER_RAY_H

#include "edit_fcd/view/camera.h" // before Qt

#include <layer_fcd/meshlab_host.h>

#include <array>
#include <cstddef>
#include <optional>

/// A place of a layer that is seen.
struct LayerHit {
    Eigen::Vector3d place;               ///< world
    double depth = 0;                    ///< along the ray, from 0 to 1: how far it is cut off there
    std::size_t slot = 0;                ///< of the nearest vertex of its triangle
    std::array<std::size_t, 3> corner{}; ///< of the triangle, slots; thrice the vertex where there is none
    Eigen::Vector3d weight;              ///< of the corners, whose mean the place is; they add up to 1
};

/// The place of a layer that is nearest to the eye at a place of the window, whatever else is before it; of a layer
/// without faces, a vertex there. \param window pixels of the device, y up \param behind a depth, of which no place
/// before is taken \return none where it is not hit
std::optional<LayerHit> hitLayer(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window,
                                 double behind = 0);

/// Half way from there to where the ray leaves the layer again.
std::optional<Eigen::Vector3d> middleBehind(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window);

/// The place of all visible layers but one that is nearest to the eye there.
std::optional<Eigen::Vector3d> hitOthers(const MeshDocument &document, const MeshModel &but, const Camera &seen,
                                         const Eigen::Vector2d &window);

#endif
