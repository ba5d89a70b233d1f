// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_HANDLE_SOURCES_H
#define FCD_HANDLE_SOURCES_H

#include <vcg_ext/handles/motion_text.h> // before Qt

#include "parameters.h"
#include "tag_sources.h"

#include <map>
#include <vector>

/// Tags (one per vertex slot) and point handles of \p layer, without motions.
/// \param rest positions per vertex slot; null: the layer is at rest \throw vcg::fcd::Error they cannot be read
vcg::fcd::Handles readHandles(const MeshModel &layer, const Point3m *rest, const HandleParam &param,
                              const Remark &remark);

/// The steps of a text of motions, by tag. In it, "layer 'NAME'" is the motion from \p layer to that layer.
/// \throw vcg::fcd::Error what is wrong with the text
std::map<int, std::vector<vcg::fcd::MotionStep>> readMotionSteps(const MeshDocument &document, const MeshModel &layer,
                                                                 const QString &text);

/// Sets the motions of \p handles, world units. The text goes before the file, and the file before the dialog.
/// \param centers of the handles, mesh units \param rest as in readHandles \return whether any handle moves
/// \throw vcg::fcd::Error the motions cannot be read
bool readMotions(const MeshDocument &document, const MeshModel &layer, const Point3m *rest, const HandleParam &param,
                 const std::map<vcg::fcd::Index, Eigen::Vector3d> &centers, const Remark &remark,
                 vcg::fcd::Handles &handles);

#endif
