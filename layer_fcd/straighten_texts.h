// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_STRAIGHTEN_TEXTS_H
#define FCD_STRAIGHTEN_TEXTS_H

#include "parameters.h"

/// What "FCD: Straighten Mesh", and the tool, say of their parameters. The values of \p shape stand in the order of
/// StraightenMeshParam::Shape.
struct StraightenTexts {
    ParameterText middle, shape, angle, direction, towards, target, reverse, length, untwist;
};
StraightenTexts straightenTexts();

#endif
