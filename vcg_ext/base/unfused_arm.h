// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_UNFUSED_ARM_H
#define VCG_FCD_UNFUSED_ARM_H

/// \file
/// Included before all else on 64-bit ARM (CMakeLists.txt), where Eigen would give other bits than elsewhere. It fuses
/// products and sums by itself, whatever -ffp-contract says, if it is told that the processor can; the system's header
/// wants to know, too, and comes first. And it adds up three floats as two and one, in registers of two that it has
/// there alone, where elsewhere it adds the first to the sum of the others.
#if defined(__aarch64__) && defined(__ARM_NEON)
#include <arm_neon.h>
#undef __ARM_FEATURE_FMA

#include <Eigen/Core>

namespace Eigen {
namespace internal {
template <int Size>
struct find_best_packet<float, Size> {
    using type = Packet4f;
};
} // namespace internal
} // namespace Eigen
#endif

#endif
