// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_SIGHT_H
#define FCD_BEND_SIGHT_H

#include <vcg_ext/centroidal_deformation.h> // before Qt

#include <layer_fcd/meshlab_host.h>

#include <optional>

/// Where the line from one place to another, both in the world, first meets the faces of layers, all but one of those
/// that are seen. \return none where it meets none
std::optional<Eigen::Vector3d> firstOnOthers(const MeshDocument &document, const MeshModel &but,
                                             const Eigen::Vector3d &from, const Eigen::Vector3d &to);

#endif
