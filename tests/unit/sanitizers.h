// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TEST_SANITIZERS_H
#define FCD_TEST_SANITIZERS_H

namespace fcd_test {

// Of the method in a program: each says so itself, since the tests are compiled once for all of them (sanitizers.cpp).

/// Sanitizers slow everything down tenfold: large tests are smaller then.
extern const bool sanitized;

} // namespace fcd_test

#endif
