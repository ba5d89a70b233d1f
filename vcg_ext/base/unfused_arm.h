// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_UNFUSED_ARM_H
#define VCG_FCD_UNFUSED_ARM_H

/// \file
/// Included before all else on 64-bit ARM (CMakeLists.txt), where Eigen fuses products and sums by itself, whatever
/// -ffp-contract says, if it is told that the processor can: bits would be others than elsewhere. The system's header
/// wants to know, too, and comes first.
#if defined(__aarch64__) && defined(__ARM_NEON)
#include <arm_neon.h>
#undef __ARM_FEATURE_FMA
#endif

#endif
