// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POINT_SOURCES_H
#define FCD_POINT_SOURCES_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/handles/handle_file.h>
#include <vcg_ext/handles/handles.h>

#include "meshlab_host.h"

#include <vector>

/// Point handles of \p layer from a file in world coordinates: MeshLab's picked points (.pp), active ones in pairs of
/// start and target, or a list of correspondences (see vcg::fcd::ReadPointHandleFile). A start that is no vertex stands
/// for the vertex nearest to it, which moves as the start does.
/// \param rest positions per vertex slot, null where the layer is at rest
/// \param targets picked points of the other layer, to match those of \p file by name; may be empty
/// \throw vcg::fcd::Error when the file cannot be read or names a vertex that there is not: says what to do
std::vector<vcg::fcd::PointHandle> readPointHandles(const MeshModel &layer, const Point3m *rest, const QString &file,
                                                    const QString &targets = QString());

/// The pairs of such a file, as they are there. \throw vcg::fcd::Error as readPointHandles
std::vector<vcg::fcd::PointPair> readPointPairs(const MeshModel &layer, const QString &file);

#endif
