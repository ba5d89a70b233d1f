// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MOTION_SOURCES_H
#define FCD_MOTION_SOURCES_H

#include <vcg_ext/handles/motion_text.h> // before Qt

#include "parameters.h"

#include <map>
#include <vector>

/// The steps of a text of motions, by tag, in which "layer 'NAME'" leads to a layer from \p layer.
/// \throw vcg::fcd::Error what is wrong with the text
std::map<int, std::vector<vcg::fcd::MotionStep>> readMotionSteps(const MeshDocument &document, const MeshModel &layer,
                                                                 const QString &text);

/// Adds to \p handles of \p layer their motions, in world coordinates. That of a handle is the first that there is: in
/// the text, in the file, or what the dialog says. \param centers of the handles, in the layer's coordinates
/// \param rest as readHandles takes it \return whether any handle moves
/// \throw vcg::fcd::Error when the motions cannot be had: each message says what to do
bool readMotions(const MeshDocument &document, const MeshModel &layer, const Point3m *rest, const HandleParam &param,
                 const std::map<vcg::fcd::Index, Eigen::Vector3d> &centers, const Remark &remark,
                 vcg::fcd::Handles &handles);

#endif
