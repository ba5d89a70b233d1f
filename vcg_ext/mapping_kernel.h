// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MAPPING_KERNEL_H
#define VCG_FCD_MAPPING_KERNEL_H

#include <cstddef>
#include <cstdint>
#include <cstring>

/// \file
/// The innermost loops of the mapping, over a few vertices of one patch at a time, compiled for each kind of processor.
/// All of them give the same bits: each vertex sees the same operations in the same order, none of them fused.

namespace vcg {
namespace fcd {

namespace detail {

constexpr int lanes = 16; ///< vertices at a time
constexpr int terms = 16; ///< numbers that are blended

/// Weight of a node: u^3 at u = 1 - (distance / radius)^2. Like Eq. 8 of the paper it falls from 1 at the node to 0 at
/// its reach, but without the cone's tip that (1 - r)^2 has at the node and the jump in curvature at its end: both show
/// as ripples.
struct Ball {
    float center[3];
    float inverse; ///< 1 / radius^2
    int node;      ///< at the centre
};

/// A linear combination for each of some vertices: of terms of candidates, by weights that fall with the distance.
struct Blending {
    const Ball *ball;           ///< n, of the candidates
    const float (*term)[terms]; ///< n
    std::size_t n;              ///< candidates
    std::size_t whole;          ///< the first so many keep all of their weight, the others a share, ...
    const Ball *shareBall;      ///< m: ... which is known at their centres
    const float *share;         ///< (n - whole) x m
    std::size_t m;
    alignas(64) float x[3][lanes]; ///< the vertices
    /// Rows for n, out: the weights of candidates active[0], ... active[used - 1], ascending. Those that are left out
    /// weigh nothing at any of the vertices.
    float (*weight)[lanes];
    std::uint32_t *active;
    std::size_t used;
    float (*shareWeight)[lanes];         ///< m, scratch
    std::uint32_t *shareActive;          ///< m, scratch
    alignas(64) float sum[terms][lanes]; ///< out: the terms times the weights
};

#define FCD_TARGET
namespace plain {
#ifdef __GNUC__
using Numbers = float __attribute__((vector_size(16))); ///< of some vertices, as many as a register holds
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

#if defined(__GNUC__) && defined(__x86_64__)
inline bool IsWide() {
    static const bool isWide = __builtin_cpu_supports("avx2");
    return isWide;
}
#define FCD_DISPATCH(call) IsWide() ? avx2::call : plain::call
#else
#define FCD_DISPATCH(call) plain::call
#endif

/// Weighs the candidates at each vertex, and sums up their terms.
inline void Blend(Blending &b) { FCD_DISPATCH(Blend(b)); }

/// Sums up other terms of the same candidates by the same weights. \param sum terms x lanes
inline void SumTerms(const Blending &b, const float (*term)[terms], float (*sum)[lanes]) {
    FCD_DISPATCH(SumTerms(b.weight, b.active, b.used, term, sum));
}
#undef FCD_DISPATCH

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
