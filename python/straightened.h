// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_STRAIGHTENED_H
#define PYMESHLAB_FCD_STRAIGHTENED_H

#include "posed.h"

/// Straightens a surface, or bends it.
/// \param prepared of a surface that is all free \param goal line, target (or None), and numbers, by name; see
/// straighten in Python \return the pose, and what is told of it
nb::tuple straighten(const std::shared_ptr<Prepared> &prepared, const nb::dict &goal, const nb::object &report);

#endif
