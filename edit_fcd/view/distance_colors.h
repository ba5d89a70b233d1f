// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DISTANCE_COLORS_H
#define FCD_DISTANCE_COLORS_H

#include <layer_fcd/meshlab_host.h>

/// The colour of a distance, of the largest that is shown: from blue by green and yellow to red.
vcg::Color4b colorOfDistance(double part);
/// What has no counterpart.
vcg::Color4b colorOfNoCounterpart();

#endif
