// SPDX-License-Identifier: GPL-3.0-or-later
// Part of mapping_kernel.h, which includes it for each kind of processor.

constexpr int each = sizeof(Numbers) / sizeof(float);

FCD_TARGET inline void WeighBalls(const float (*x)[lanes], const Ball *ball, std::size_t n, float (*weight)[lanes]) {
    for (int g = 0; g < lanes; g += each) {
        Numbers at[3];
        for (int d = 0; d < 3; ++d)
            std::memcpy(&at[d], x[d] + g, sizeof(Numbers));
        for (std::size_t c = 0; c < n; ++c) {
            Numbers square = {};
            for (int d = 0; d < 3; ++d) {
                const Numbers way = ball[c].center[d] - at[d];
                square += way * way;
            }
            Numbers u = 1 - square * ball[c].inverse;
            u = u > 0 ? u : Numbers{};
            u = u * u * u;
            std::memcpy(weight[c] + g, &u, sizeof(Numbers));
        }
    }
}

FCD_TARGET inline void SumTerms(const float (*weight)[lanes], const float (*term)[terms], std::size_t n,
                                float (*sum)[lanes]) {
    static_assert(lanes % (2 * each) == 0, "pairs of groups");
    for (int first = 0; first < terms; first += 4) // as many as there are registers for
        for (int g = 0; g < lanes; g += 2 * each) {
            Numbers s0 = {}, s1 = {}, s2 = {}, s3 = {}, t0 = {}, t1 = {}, t2 = {}, t3 = {}, v, w;
            for (std::size_t c = 0; c < n; ++c) {
                const float *factor = term[c] + first;
                std::memcpy(&v, weight[c] + g, sizeof(Numbers));
                std::memcpy(&w, weight[c] + g + each, sizeof(Numbers));
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
    WeighBalls(b.x, b.ball, b.n, b.weight);
    if (b.whole < b.n && b.m > 0) {
        WeighBalls(b.x, b.shareBall, b.m, b.shareWeight);
        for (int g = 0; g < lanes; g += each) {
            Numbers total = {};
            for (std::size_t q = 0; q < b.m; ++q) {
                Numbers w;
                std::memcpy(&w, b.shareWeight[q] + g, sizeof(Numbers));
                total += w;
            }
            const float *share = b.share;
            for (std::size_t c = b.whole; c < b.n; ++c, share += b.m) {
                Numbers kept = {}, w;
                for (std::size_t q = 0; q < b.m; ++q) {
                    std::memcpy(&w, b.shareWeight[q] + g, sizeof(Numbers));
                    kept += share[q] * w;
                }
                std::memcpy(&w, b.weight[c] + g, sizeof(Numbers));
                w = total > 0 ? w * kept / total : w;
                std::memcpy(b.weight[c] + g, &w, sizeof(Numbers));
            }
        }
    }
    SumTerms(b.weight, b.term, b.n, b.sum);
}
