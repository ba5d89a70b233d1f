// SPDX-License-Identifier: GPL-3.0-or-later
// Part of mapping_kernel.h, which includes it for each kind of processor.

constexpr int each = sizeof(Numbers) / sizeof(float);

FCD_TARGET inline bool IsZero(const Numbers &v) {
    std::uint32_t bits[each], any = 0;
    std::memcpy(bits, &v, sizeof v);
    for (std::uint32_t b : bits)
        any |= b;
    return any == 0;
}

/// Weights of balls [first, end) that reach any of the vertices, from row \p used on. \return rows used then
FCD_TARGET inline std::size_t WeighBalls(const float (*x)[lanes], const Ball *ball, std::size_t first, std::size_t end,
                                         float (*weight)[lanes], std::uint32_t *active, std::size_t used) {
    constexpr std::size_t groups = lanes / each;
    Numbers at[groups][3];
    for (std::size_t g = 0; g < groups; ++g)
        for (int d = 0; d < 3; ++d)
            std::memcpy(&at[g][d], &x[d][g * each], sizeof(Numbers));
    for (std::size_t c = first; c < end; ++c) {
        Numbers sum = {};
        for (std::size_t g = 0; g < groups; ++g) {
            Numbers square = {};
            for (int d = 0; d < 3; ++d) {
                const Numbers way = ball[c].center[d] - at[g][d];
                square += way * way;
            }
            Numbers u = 1 - square * ball[c].inverse;
            u = u > 0 ? u : Numbers{};
            u = u * u * u;
            sum += u;
            std::memcpy(&weight[used][g * each], &u, sizeof(Numbers));
        }
        active[used] = std::uint32_t(c);
        used += !IsZero(sum);
    }
    return used;
}

FCD_TARGET inline void SumTerms(const float (*weight)[lanes], const std::uint32_t *active, std::size_t used,
                                const float (*term)[terms], float (*sum)[lanes]) {
    static_assert(lanes % (2 * each) == 0, "pairs of groups");
    for (int first = 0; first < terms; first += 4) // as many as there are registers for
        for (int g = 0; g < lanes; g += 2 * each) {
            Numbers s0 = {}, s1 = {}, s2 = {}, s3 = {}, t0 = {}, t1 = {}, t2 = {}, t3 = {}, v, w;
            for (std::size_t a = 0; a < used; ++a) {
                const float *factor = term[active[a]] + first;
                std::memcpy(&v, weight[a] + g, sizeof(Numbers));
                std::memcpy(&w, weight[a] + g + each, sizeof(Numbers));
                s0 += factor[0] * v;
                t0 += factor[0] * w;
                s1 += factor[1] * v;
                t1 += factor[1] * w;
                s2 += factor[2] * v;
                t2 += factor[2] * w;
                s3 += factor[3] * v;
                t3 += factor[3] * w;
            }
            const Numbers one[4] = {s0, s1, s2, s3}, other[4] = {t0, t1, t2, t3};
            for (int t = 0; t < 4; ++t) {
                std::memcpy(sum[first + t] + g, &one[t], sizeof(Numbers));
                std::memcpy(sum[first + t] + g + each, &other[t], sizeof(Numbers));
            }
        }
}

FCD_TARGET inline void Blend(Blending &b) {
    const std::size_t whole = WeighBalls(b.x, b.ball, 0, b.whole, b.weight, b.active, 0);
    b.used = WeighBalls(b.x, b.ball, b.whole, b.n, b.weight, b.active, whole);
    if (whole < b.used) {
        const std::size_t near = WeighBalls(b.x, b.shareBall, 0, b.m, b.shareWeight, b.shareActive, 0);
        for (int g = 0; g < lanes; g += each) {
            Numbers total = {};
            for (std::size_t q = 0; q < near; ++q) {
                Numbers w;
                std::memcpy(&w, b.shareWeight[q] + g, sizeof(Numbers));
                total += w;
            }
            for (std::size_t a = whole; a < b.used; ++a) {
                const float *share = b.share + (b.active[a] - b.whole) * b.m;
                Numbers kept = {}, w;
                for (std::size_t q = 0; q < near; ++q) {
                    std::memcpy(&w, b.shareWeight[q] + g, sizeof(Numbers));
                    kept += share[b.shareActive[q]] * w;
                }
                std::memcpy(&w, b.weight[a] + g, sizeof(Numbers));
                w = total > 0 ? w * kept / total : w;
                std::memcpy(b.weight[a] + g, &w, sizeof(Numbers));
            }
        }
    }
    SumTerms(b.weight, b.active, b.used, b.term, b.sum);
}
