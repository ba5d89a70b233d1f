// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POINT_SOURCES_H
#define FCD_POINT_SOURCES_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/handles/handle_file.h>
#include <vcg_ext/handles/handles.h>

#include "meshlab_host.h"

#include <vector>

/// Point handles of \p layer from a file in world coordinates: MeshLab's picked points (.pp), in pairs of start and
/// target, or a list (vcg::fcd::ReadPointHandleFile). A start that is no vertex stands for the vertex nearest to it,
/// which moves as the start does.
/// \param rest positions per vertex slot; null: the layer is at rest
/// \param targets picked points of the other layer, paired with those of \p file by name; may be empty
/// \throw vcg::fcd::Error the file cannot be read, or names a vertex that does not exist
std::vector<vcg::fcd::PointHandle> readPointHandles(const MeshModel &layer, const Point3m *rest, const QString &file,
                                                    const QString &targets = QString());

/// The pairs of such a file, unchanged. \throw as readPointHandles
std::vector<vcg::fcd::PointPair> readPointPairs(const MeshModel &layer, const QString &file);

#endif
