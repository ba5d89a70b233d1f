// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TEXT_H
#define FCD_BEND_TEXT_H

#include "bend_state.h"

#include <string>
#include <utility>
#include <vector>

/// \file
/// The settings of FCD: Bend for a layer as a text that people can read, a line each.
///
///     FCD bend 1
///     smoothness S            options, as BendOptions has them; enumerations by their numbers
///     falloff N               left out if it is smooth
///     elastic 1               left out if it is not
///     rigidity R              left out if it is 1
///     detail N
///     distances N
///     symmetry N
///     axes N
///     pose PERCENT
///     point TAG VERTEX RADIUS [grip]
///     rank TAG RANK
///     name TAG ...            to the end of the line
///     hidden TAG
///     locked TAG
///     pivot TAG X Y Z
///     motions ...             as ReadMotionText reads them
///     mark TAG FIRST LAST FIRST LAST ...          of these vertices
///     rim RADIUS FIRST LAST FIRST LAST ...
///     weights PERCENT ...     of each pose that has a name
///     line A B C WA WB WC X Y Z                   of each point: BendLinePoint's corners, weights and place
///
/// Lines after the first may be left out. Live vertices are numbered from 0, as any program numbers them that opens the
/// layer's file.

/// The text of all but poses with names, applies and loads; numbers are to the bit.
/// \param live slots of the live vertices, ascending
std::string bendText(const BendState &state, const BendOptions &options, const std::vector<std::size_t> &live);

/// Reads such a text. \param name of the text, for messages \param vertexSlots number of all slots
/// \throw vcg::fcd::BadInput what is wrong, with the line
std::pair<BendState, BendOptions> readBendText(const std::string &text, const std::string &name,
                                               const std::vector<std::size_t> &live, std::size_t vertexSlots);

#endif
