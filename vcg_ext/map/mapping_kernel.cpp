// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/map/mapping_kernel.h>
#include <vcg_ext/map/mapping_kernel_variants.h>

namespace vcg::fcd::detail {

#if defined(__GNUC__) && defined(__x86_64__)
inline bool IsWide() {
    static const bool isWide = __builtin_cpu_supports("avx2");
    return isWide;
}
#define FCD_DISPATCH(call) IsWide() ? avx2::call : plain::call
#else
#define FCD_DISPATCH(call) plain::call
#endif

void Blend(Blending &b) { FCD_DISPATCH(Blend(b)); }

void SumTerms(const Blending &b, const float (*term)[terms], float (*sum)[lanes]) {
    FCD_DISPATCH(SumTerms(b.weight, b.active, b.used, term, sum));
}

void Carry(const Blending &b, const PatchMotion &own, const Space &space, bool linear, Vertices &v) {
    FCD_DISPATCH(Carry(b, own, space, linear, v));
}

void TurnNormals(Vertices &v) { FCD_DISPATCH(TurnNormals(v)); }
#undef FCD_DISPATCH

} // namespace vcg::fcd::detail
