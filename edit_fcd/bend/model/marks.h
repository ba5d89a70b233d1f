// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_MARKS_H
#define FCD_BEND_MARKS_H

#include "edit_fcd/bend/model/reach.h"

#include <layer_fcd/bend_state.h>

#include <set>

/// \file
/// What is marked, and how far it bends what is around it where nothing is marked as fixed. \a diagonal is that of the
/// bounding box, world units; so are radii.

/// Of a vertex that is marked.
double rimAt(const BendState &state, std::size_t slot, double diagonal);
/// Of a handle; of a mark, that of its first vertex.
double radiusOf(const BendState &state, int tag, double diagonal);
/// \param vertexSlots of all vertices
void setRims(BendState &state, const std::vector<std::size_t> &vertices, double radius, std::size_t vertexSlots);
/// A handle was asked how far it bends, so its rank is the lowest.
void setRadiusOf(BendState &state, int tag, double radius);

/// Marks never touch: within the gap of a mark nothing else is held. What is fixed yields to handles, and an older
/// handle to a newer one, as far as the larger gap of the two. \param made tags, which begin as the marks
void freeGaps(const BendState &state, BendReach &reach, BendTags &made);

/// Marks become those of the state; points whose places they take are gone. \param marked where they are new
/// \param rim of these \param known tags of handles before \return those of the new handles
std::set<int> takeMarks(BendState &state, const BendTags &marks, const std::vector<std::size_t> &marked, double rim,
                        const std::map<vcg::fcd::Index, Eigen::Vector3d> &known);
/// What a handle holds is free.
void freeHandle(BendState &state, int tag);

#endif
