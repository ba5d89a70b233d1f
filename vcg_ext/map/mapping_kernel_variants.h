// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MAPPING_KERNEL_VARIANTS_H
#define VCG_FCD_MAPPING_KERNEL_VARIANTS_H

#include <vcg_ext/map/mapping_kernel.h>

#include <cmath>
#include <cstring>

/// \file
/// The innermost loops of the mapping, compiled for each kind of processor. All give the same bits: each vertex sees
/// the same operations in the same order, none of them fused.

namespace vcg::fcd::detail {

#define FCD_TARGET
namespace plain {
#ifdef __GNUC__
using Numbers = float __attribute__((vector_size(16))); ///< a register: one number of several vertices
#else
using Numbers = float;
#endif
#include "mapping_kernel_body.h"
} // namespace plain
#undef FCD_TARGET

#if defined(__GNUC__) && defined(__x86_64__)
#define FCD_TARGET __attribute__((target("avx2")))
namespace avx2 {
using Numbers = float __attribute__((vector_size(32)));
#include "mapping_kernel_body.h"
} // namespace avx2
#undef FCD_TARGET
#endif

} // namespace vcg::fcd::detail

#endif
