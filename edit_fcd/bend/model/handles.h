// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_HANDLES_H
#define FCD_BEND_HANDLES_H

#include <layer_fcd/bend_state.h>

/// \file
/// Reads and changes what a state has of one handle, by its tag.

const BendHandle &handleOf(const BendState &state, int tag);
void setHandle(BendState &state, int tag, BendHandle handle);
std::string nameOf(const BendState &state, int tag); ///< for the user
/// The steps of its motion; empty: at rest.
const std::vector<vcg::fcd::MotionStep> &motionOf(const BendState &state, int tag);
/// Its steps as text for "Motions as text"; empty: at rest.
std::string motionTextOf(const BendState &state, int tag);
/// The same in a few words. The last step is first, since a list may cut off the rest. The degrees of a turn are about
/// the axis whose largest coordinate is positive: two handles that turn together show the same sign.
std::string shortMotionOf(const BendState &state, int tag);
int rankOf(const BendState &state, int tag);
/// The rank of a new handle: above those of moved handles, so that these keep what they bend.
int rankOfNew(const BendState &state);
bool isGrip(const BendState &state, int tag);
/// Whether no mark holds a vertex.
bool isFree(const BendState &state, std::size_t slot);
/// The motions, for a change by hand: ends a blend of poses.
std::map<int, std::vector<vcg::fcd::MotionStep>> &motionByHand(BendState &state);

#endif
