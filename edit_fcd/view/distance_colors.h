// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DISTANCE_COLORS_H
#define FCD_DISTANCE_COLORS_H

#include <layer_fcd/meshlab_host.h>

/// The colour of a distance, from blue by green and yellow to red. \param part of the largest distance shown
vcg::Color4b colorOfDistance(double part);
/// The colour of vertices without a counterpart.
vcg::Color4b colorOfNoCounterpart();

#endif
