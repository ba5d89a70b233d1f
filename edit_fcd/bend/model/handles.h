// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_HANDLES_H
#define FCD_BEND_HANDLES_H

#include <layer_fcd/bend_state.h>

/// \file
/// What a state says of one handle, by its tag, and what can be said of it.

const BendHandle &handleOf(const BendState &state, int tag);
void setHandle(BendState &state, int tag, BendHandle handle);
std::string nameOf(const BendState &state, int tag); ///< as a person reads it
/// That make its motion; none: it is at rest.
const std::vector<vcg::fcd::MotionStep> &motionOf(const BendState &state, int tag);
/// Its steps as "Motions as text" takes them; empty: it is at rest.
std::string motionTextOf(const BendState &state, int tag);
/// The same in a few words, the last step first, as a list may cut the rest. Of a turn, degrees are those about the
/// axis whose largest part is positive: where a handle was turned by -45 degrees with another, it says so.
std::string shortMotionOf(const BendState &state, int tag);
int rankOf(const BendState &state, int tag);
/// What a new handle frees must not let go what is posed.
int rankOfNew(const BendState &state);
bool isGrip(const BendState &state, int tag);
/// Whether a vertex is not marked as anything else.
bool isFree(const BendState &state, std::size_t slot);
/// The motions, which are about to be given otherwise than by poses.
std::map<int, std::vector<vcg::fcd::MotionStep>> &motionByHand(BendState &state);

#endif
