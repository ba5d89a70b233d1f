// SPDX-License-Identifier: GPL-3.0-or-later
// Part of mapping_kernel.h, which includes it for each kind of processor.

constexpr int perRegister = sizeof(Numbers) / sizeof(float);

FCD_TARGET inline bool IsZero(const Numbers &v) {
    std::uint32_t bits[perRegister], any = 0;
    std::memcpy(bits, &v, sizeof v);
    for (std::uint32_t b : bits)
        any |= b;
    return any == 0;
}

/// Appends the weights of balls [first, end) that reach any of the vertices, from row \p used on. \return rows used
FCD_TARGET inline std::size_t WeighBalls(const float (*x)[lanes], const Ball *ball, std::size_t first, std::size_t end,
                                         float (*weight)[lanes], std::uint32_t *active, std::size_t used) {
    constexpr std::size_t groups = lanes / perRegister;
    Numbers at[groups][3];
    for (std::size_t g = 0; g < groups; ++g)
        for (int d = 0; d < 3; ++d)
            std::memcpy(&at[g][d], &x[d][g * perRegister], sizeof(Numbers));
    for (std::size_t c = first; c < end; ++c) {
        Numbers sum = {};
        for (std::size_t g = 0; g < groups; ++g) {
            Numbers square = {};
            for (int d = 0; d < 3; ++d) {
                const Numbers offset = ball[c].center[d] - at[g][d];
                square += offset * offset;
            }
            Numbers u = 1 - square * ball[c].inverse;
            u = u > 0 ? u : Numbers{};
            u = u * u * u;
            sum += u;
            std::memcpy(&weight[used][g * perRegister], &u, sizeof(Numbers));
        }
        active[used] = std::uint32_t(c);
        used += !IsZero(sum);
    }
    return used;
}

FCD_TARGET inline void SumTerms(const float (*weight)[lanes], const std::uint32_t *active, std::size_t used,
                                const float (*term)[terms], float (*sum)[lanes]) {
    static_assert(lanes % (2 * perRegister) == 0, "pairs of groups");
    for (int first = 0; first < terms; first += 4) // as many as there are registers for
        for (int g = 0; g < lanes; g += 2 * perRegister) {
            Numbers s0 = {}, s1 = {}, s2 = {}, s3 = {}, t0 = {}, t1 = {}, t2 = {}, t3 = {}, v, w;
            for (std::size_t a = 0; a < used; ++a) {
                const float *factor = term[active[a]] + first;
                std::memcpy(&v, weight[a] + g, sizeof(Numbers));
                std::memcpy(&w, weight[a] + g + perRegister, sizeof(Numbers));
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
                std::memcpy(sum[first + t] + g + perRegister, &other[t], sizeof(Numbers));
            }
        }
}

FCD_TARGET inline void Blend(Blending &b) {
    const std::size_t whole = WeighBalls(b.x, b.ball, 0, b.whole, b.weight, b.active, 0);
    b.used = WeighBalls(b.x, b.ball, b.whole, b.n, b.weight, b.active, whole);
    if (whole < b.used) {
        const std::size_t near = WeighBalls(b.x, b.shareBall, 0, b.m, b.shareWeight, b.shareActive, 0);
        for (int g = 0; g < lanes; g += perRegister) {
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

FCD_TARGET inline void MoveByBlend(const Blending &b, const float *inverse, const PatchMotion &own, const Space &space,
                                   Vertices &v) {
    // The differences of the candidates' motions from that of the patch are small: float is enough.
    double fromCenter[3][lanes], moved[3][lanes];
    float local[3][lanes], offset[3][lanes];
    for (int d = 0; d < 3; ++d) {
        const double center = own.center[d];
        for (int l = 0; l < lanes; ++l)
            fromCenter[d][l] = v.rest[d][l] - center;
    }
    for (int d = 0; d < 3; ++d) {
        const double x = space.toFrame[d], y = space.toFrame[3 + d], z = space.toFrame[6 + d];
        for (int l = 0; l < lanes; ++l)
            local[d][l] = float(x * fromCenter[0][l] + y * fromCenter[1][l] + z * fromCenter[2][l]) -
                          0.5f * b.sum[12 + d][l] * inverse[l];
    }
    for (int d = 0; d < 3; ++d)
        for (int l = 0; l < lanes; ++l)
            offset[d][l] = (local[0][l] * b.sum[d][l] + local[1][l] * b.sum[3 + d][l] + local[2][l] * b.sum[6 + d][l] +
                            b.sum[9 + d][l]) *
                           inverse[l];
    for (int d = 0; d < 3; ++d) {
        const double shift = own.shift[d], x = own.turn[d], y = own.turn[3 + d], z = own.turn[6 + d];
        const double i = space.fromFrame[d], j = space.fromFrame[3 + d], k = space.fromFrame[6 + d];
        for (int l = 0; l < lanes; ++l)
            moved[d][l] =
                v.rest[d][l] + (shift + (x * fromCenter[0][l] + y * fromCenter[1][l] + z * fromCenter[2][l]) +
                                (i * double(offset[0][l]) + j * double(offset[1][l]) + k * double(offset[2][l])));
    }
    std::memcpy(v.moved, moved, sizeof moved);
}

FCD_TARGET inline void MapsOfBlend(const Blending &b, const float *inverse, const PatchMotion &own, const Space &space,
                                   Vertices &v) {
    float more[9][lanes];
    for (int d = 0; d < 9; ++d)
        for (int l = 0; l < lanes; ++l)
            more[d][l] = b.sum[d][l] * inverse[l];
    if (!space.isSame) {
        double half[9][lanes];
        for (std::size_t row = 0; row < 3; ++row)
            for (std::size_t column = 0; column < 3; ++column) {
                const double *m = space.metric + 3 * column;
                for (int l = 0; l < lanes; ++l)
                    half[3 * column + row][l] =
                        double(more[row][l]) * m[0] + double(more[3 + row][l]) * m[1] + double(more[6 + row][l]) * m[2];
            }
        for (std::size_t row = 0; row < 3; ++row)
            for (std::size_t column = 0; column < 3; ++column) {
                const double *m = space.inverseMetric + row;
                for (int l = 0; l < lanes; ++l)
                    more[3 * column + row][l] = float(m[0] * half[3 * column][l] + m[3] * half[3 * column + 1][l] +
                                                      m[6] * half[3 * column + 2][l]);
            }
    }
    for (int d = 0; d < 9; ++d) {
        const float mine = float(own.turn[d] + (d % 4 == 0));
        for (int l = 0; l < lanes; ++l)
            v.linear[d][l] = mine + more[d][l];
    }
}

FCD_TARGET inline void Carry(const Blending &b, const PatchMotion &own, const Space &space, bool linear, Vertices &v) {
    float inverse[lanes];
    for (int l = 0; l < lanes; ++l) { // 0 if no ball reaches it, as around an isolated vertex
        const float total = b.sum[15][l];
        inverse[l] = total > 0 ? 1 / total : 0;
    }
    MoveByBlend(b, inverse, own, space, v);
    if (linear)
        MapsOfBlend(b, inverse, own, space, v);
}

FCD_TARGET inline void TurnNormals(Vertices &v) {
    const auto &m = v.linear;
    const auto &n = v.normal;
    float after[3][lanes], turns[lanes];
    double factor[lanes];
    for (int d = 0; d < 3; ++d) { // by the cofactors
        const int i = (d + 1) % 3, j = (d + 2) % 3;
        for (int l = 0; l < lanes; ++l)
            after[d][l] = (m[3 + i][l] * m[6 + j][l] - m[3 + j][l] * m[6 + i][l]) * n[0][l] +
                          (m[6 + i][l] * m[j][l] - m[6 + j][l] * m[i][l]) * n[1][l] +
                          (m[i][l] * m[3 + j][l] - m[j][l] * m[3 + i][l]) * n[2][l];
    }
    for (int l = 0; l < lanes; ++l) {
        double before = 0, square = 0;
        for (int d = 0; d < 3; ++d) {
            before += double(n[d][l]) * double(n[d][l]);
            square += double(after[d][l]) * double(after[d][l]);
        }
        factor[l] = square > 0 ? before / square : 0;
    }
    for (double &square : factor)
        square = std::sqrt(square);
    for (int l = 0; l < lanes; ++l) {
        float off = 0;
        for (int d = 0; d < 9; ++d)
            off += std::abs(m[d][l] - float(d % 4 == 0));
        turns[l] = factor[l] > 0 ? off : 0;
    }
    for (int d = 0; d < 3; ++d)
        for (int l = 0; l < lanes; ++l)
            v.normal[d][l] = float(double(after[d][l]) * factor[l]);
    std::memcpy(v.turns, turns, sizeof turns);
}
