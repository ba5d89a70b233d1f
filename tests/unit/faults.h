// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TEST_FAULTS_H
#define FCD_TEST_FAULTS_H

#include <atomic>
#include <limits>

/// Faults of a program that is linked with faults.cpp.
namespace fcd_test::faults {

constexpr long never = std::numeric_limits<long>::max();
inline std::atomic<long> countdown{never}; ///< allocations until one fails
inline std::atomic<bool> forGood{false};   ///< all later ones fail, too
inline std::atomic<long> requests{0}, live{0};
inline std::atomic<long> threadsLeft{never}; ///< that can be started

} // namespace fcd_test::faults

#endif
