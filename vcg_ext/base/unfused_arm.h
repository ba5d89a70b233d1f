// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_UNFUSED_ARM_H
#define VCG_FCD_UNFUSED_ARM_H

/// \file
/// Included before all else on 64-bit ARM (CMakeLists.txt), so that Eigen gives the same bits as elsewhere. If the
/// compiler defines __ARM_FEATURE_FMA, Eigen fuses products and sums there, whatever -ffp-contract says. So this
/// undefines the macro, after arm_neon.h, which needs it. And it sums three floats as two and one, in packets of two
/// that only ARM has.
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
