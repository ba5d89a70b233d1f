// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_STRAIGHTENED_H
#define PYMESHLAB_FCD_STRAIGHTENED_H

#include "posed.h"

/// Straightens a surface, or bends it along a line. \param prepared a surface that is all free \param goal by name:
/// line, target (or None), and parameters as in straighten in Python \return the pose, the report, its
/// warnings, and what to do against folds
nb::tuple straighten(const std::shared_ptr<Prepared> &prepared, const nb::dict &goal, const nb::object &report);

#endif
