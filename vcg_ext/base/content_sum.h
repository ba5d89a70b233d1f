// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CONTENT_SUM_H
#define VCG_FCD_CONTENT_SUM_H

#include <array>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace vcg {
namespace fcd {

/// What tells sets of items apart: a sum of hashes, one of each item, so that they may come in any order, and from
/// several threads. Two that differ have the same sum once in 2^64.
class ContentSum {
  public:
    using Value = std::array<std::uint64_t, 2>;

    /// Adds an item of numbers, whose order counts.
    template <class... Number>
    void Add(Number... number) {
        std::uint64_t hash = sizeof...(number);
        ((hash = Mixed(hash ^ BitsOf(number))), ...);
        sum[0] += hash;
        sum[1] += Mixed(hash ^ 0x9e3779b97f4a7c15u);
    }
    void Add(const ContentSum &other) {
        sum[0] += other.sum[0];
        sum[1] += other.sum[1];
    }

    const Value &Get() const { return sum; }

  private:
    template <class Number>
    static std::uint64_t BitsOf(Number number) {
        static_assert(std::is_arithmetic<Number>::value || std::is_enum<Number>::value, "no gaps");
        std::uint64_t bits = 0;
        std::memcpy(&bits, &number, sizeof number);
        return bits;
    }
    /// The finisher of MurmurHash3 (Appleby, public domain).
    static std::uint64_t Mixed(std::uint64_t h) {
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdu;
        h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53u;
        return h ^ (h >> 33);
    }

    Value sum = {0, 0};
};

} // namespace fcd
} // namespace vcg

#endif
