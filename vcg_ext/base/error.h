// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ERROR_H
#define VCG_FCD_ERROR_H

#include <stdexcept>

/// \file
/// What may go wrong, as types, so that a caller can tell one from the other: BadInput, Unsolvable, Cancelled (which is
/// no Error), and std::bad_alloc where memory runs out. After each of them nothing that was given is changed.

namespace vcg::fcd {

/// What went wrong and what to do about it, in words for the user.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// What was given cannot be worked with: a mesh, a tag, a motion, a parameter, a file.
struct BadInput : Error {
    using Error::Error;
};

/// What was given is sound, and yet there is no solution in numbers: a system that cannot be factorised.
struct Unsolvable : Error {
    using Error::Error;
};

/// Thrown out of a computation whose progress callback returned false.
struct Cancelled : std::runtime_error {
    Cancelled() : std::runtime_error("Cancelled.") {}
};

} // namespace vcg::fcd

#endif
