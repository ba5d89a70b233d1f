// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_TEXT_H
#define FCD_BEND_TEXT_H

#include "bend_state.h"

#include <string>
#include <utility>
#include <vector>

/// \file
/// What a person has said of a layer, for another day: a text with a line for each thing, which people can read.
///
///     FCD bend 1
///     smoothness S            options, as BendOptions has them; enumerations by their numbers
///     falloff N               left out where it is smooth
///     elastic 1               left out where it is not
///     rigidity R              left out where it is 1
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
/// Lines after the first may be left out. Vertices are numbered from 0 as the live ones follow each other, which is how
/// any program numbers them that opens the layer's file.

/// All but poses that have names, applies and loads. \param live slots of the live vertices, ascending \return what
/// readBendText reads, each number to the bit
std::string bendText(const BendState &state, const BendOptions &options, const std::vector<std::size_t> &live);

/// What such a text says. \param name what messages call it \param vertexSlots of all vertices
/// \throw vcg::fcd::BadInput what is wrong, with the line
std::pair<BendState, BendOptions> readBendText(const std::string &text, const std::string &name,
                                               const std::vector<std::size_t> &live, std::size_t vertexSlots);

#endif
