// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_RAY_H
#define FCD_LAYER_RAY_H

#include "edit_fcd/view/camera.h" // before Qt

#include <layer_fcd/meshlab_host.h>

#include <array>
#include <cstddef>
#include <optional>

/// Where a ray from the eye meets a layer.
struct LayerHit {
    Eigen::Vector3d place;               ///< world
    double depth = 0;                    ///< along the ray, [0, 1], from the near to the far clipping plane
    std::size_t slot = 0;                ///< of the triangle's nearest vertex
    std::array<std::size_t, 3> corner{}; ///< slots of the triangle's corners; without faces, thrice the vertex
    Eigen::Vector3d weight;              ///< of the corners (barycentric)
};

/// The point of a layer nearest to the eye at a point of the window. Other layers do not matter. For a layer without
/// faces, a vertex there. \param window pixels of the device, y up \param behind least depth \return none if it is not
/// hit
std::optional<LayerHit> hitLayer(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window,
                                 double behind = 0);

/// The middle between the first and the next point where the ray meets the layer.
std::optional<Eigen::Vector3d> middleBehind(const MeshModel &layer, const Camera &seen, const Eigen::Vector2d &window);

/// The point nearest to the eye there, of all visible layers but one.
std::optional<Eigen::Vector3d> hitOthers(const MeshDocument &document, const MeshModel &but, const Camera &seen,
                                         const Eigen::Vector2d &window);

#endif
