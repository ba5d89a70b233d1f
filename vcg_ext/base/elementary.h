// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_ELEMENTARY_H
#define VCG_FCD_ELEMENTARY_H

#include <algorithm>
#include <cmath>

namespace vcg::fcd::detail {

/// \file
/// Sine, exponential and the like with the same bits everywhere; those of C libraries differ in the last bit. They use
/// only operations that IEEE 754 rounds in one way: sums, products, quotients, square roots and shifts of the binary
/// point. Errors are at most four units in the last place (of 1, for sine and cosine). tests/rooms.py checks that the
/// method calls no others.

constexpr double pi = 3.141592653589793;

/// An angle as a multiple of pi / 2, modulo four, and the rest, in [-pi / 4, pi / 4].
struct Quadrant {
    double rest;
    int number;

    explicit Quadrant(double x) {
        x = std::remainder(x, 2 * pi); // exact
        const double k = std::nearbyint(x * (2 / pi));
        // pi / 2 in three parts; the first two have so few digits that their multiples are exact.
        rest = ((x - k * 0x1.921fb544p0) - k * 0x1.0b4611a4p-34) - k * 0x1.13198a2e03707p-65;
        number = int(k) & 3;
    }
    double Sine() const {
        const double square = rest * rest;
        double sum = 1;
        for (int n = 16; n >= 2; n -= 2)
            sum = 1 - square * sum / (n * (n + 1));
        return rest * sum;
    }
    double Cosine() const {
        const double square = rest * rest;
        double sum = 1;
        for (int n = 16; n >= 2; n -= 2)
            sum = 1 - square * sum / ((n - 1) * n);
        return sum;
    }
};

/// \param x radians
inline double Sine(double x) {
    const Quadrant q(x);
    const double value = q.number & 1 ? q.Cosine() : q.Sine();
    return q.number & 2 ? -value : value;
}

/// \param x radians
inline double Cosine(double x) {
    const Quadrant q(x);
    const double value = q.number & 1 ? q.Sine() : q.Cosine();
    return ((q.number + 1) & 2) ? -value : value;
}

/// The angle of (x, y) from the first axis, in [-pi, pi]; 0 if both are 0.
inline double ArcTangent(double y, double x) {
    const double a = std::abs(x), b = std::abs(y), longer = std::max(a, b);
    if (!(longer > 0))
        return 0;
    double t = std::min(a, b) / longer;
    for (int half = 0; half < 2; ++half)
        t /= 1 + std::sqrt(1 + t * t);
    double sum = 0;
    for (int n = 25; n >= 1; n -= 2)
        sum = 1. / n - t * t * sum;
    double angle = 4 * t * sum;
    if (b > a)
        angle = pi / 2 - angle;
    if (x < 0)
        angle = pi - angle;
    return y < 0 ? -angle : angle;
}

/// \param x in [-1, 1] \return in [0, pi]
inline double ArcCosine(double x) { return ArcTangent(std::sqrt(std::max(0., (1 - x) * (1 + x))), x); }

inline double Exponential(double x) {
    x = std::min(std::max(x, -750.), 710.); // beyond, the result is 0 or infinite
    const double k = std::nearbyint(x * 1.4426950408889634);
    const double rest = (x - k * 0x1.62e42feep-1) - k * 0x1.a39ef35793c76p-33; // of ln 2 in two parts
    double sum = 1;
    for (int n = 14; n >= 1; --n)
        sum = 1 + rest * sum / n;
    return std::ldexp(sum, int(k));
}

/// x = 2^exponent (1 + s) / (1 - s), |s| <= 0.172.
struct Scaled {
    double s;
    int exponent = 0; // set by frexp; = 0 for GCC's warning

    explicit Scaled(double x) {
        double part = std::frexp(x, &exponent);
        if (part < 0.7071067811865476) {
            part *= 2;
            --exponent;
        }
        s = (part - 1) / (part + 1);
    }
    double Logarithm() const { ///< of (1 + s) / (1 - s)
        double sum = 0;
        for (int n = 23; n >= 1; n -= 2)
            sum = 1. / n + s * s * sum;
        return 2 * s * sum;
    }
};

/// \param x > 0
inline double Logarithm(double x) {
    const Scaled scaled(x);
    return scaled.exponent * 0.6931471805599453 + scaled.Logarithm();
}

/// Exact for powers of two. \param x > 0
inline double BinaryLogarithm(double x) {
    const Scaled scaled(x);
    return scaled.exponent + scaled.Logarithm() * 1.4426950408889634;
}

/// x to the power of y. The error is up to |y ln x| + 1 times that of the others. \param x > 0
inline double Power(double x, double y) { return Exponential(y * Logarithm(x)); }

inline double Squared(double x) { return x * x; }

} // namespace vcg::fcd::detail

#endif
