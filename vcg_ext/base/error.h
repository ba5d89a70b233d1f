// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ERROR_H
#define VCG_FCD_ERROR_H

#include <stdexcept>

/// \file
/// What the library throws: BadInput, Unsolvable, Cancelled (which is no Error), and std::bad_alloc. After each of
/// them, all arguments are as they were.

namespace vcg::fcd {

/// An error whose text tells a user what is wrong and what to do about it.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// An argument cannot be used: a mesh, a tag, a motion, a parameter, a file.
struct BadInput : Error {
    using Error::Error;
};

/// All arguments are valid, but the system of equations cannot be solved in numbers, or not in reasonable time.
struct Unsolvable : Error {
    using Error::Error;
};

/// The progress callback returned false.
struct Cancelled : std::runtime_error {
    Cancelled() : std::runtime_error("Cancelled.") {}
};

} // namespace vcg::fcd

#endif
