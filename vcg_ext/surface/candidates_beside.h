// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CANDIDATES_BESIDE_H
#define VCG_FCD_CANDIDATES_BESIDE_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/free_region.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace vcg::fcd::detail {

/// Calls body(number) for the cell of \p x in a grid of \p cells a unit, and for other cells within \p hair of \p x.
/// \param hair at most the width of a cell. Within the frame, the numbers of cells are unique.
template <class Body>
void ForCells(const Eigen::Vector3f &x, float cells, float hair, const Body &body) {
    std::uint64_t low[3], high[3];
    for (int d = 0; d < 3; ++d) {
        const auto cellAt = [&](float at) {
            const float most = 1e15f; // far outside of the frame
            return std::uint64_t(std::int64_t(std::floor(std::min(most, std::max(-most, at * cells))))) &
                   ((std::uint64_t(1) << 21) - 1);
        };
        low[d] = cellAt(x[d] - hair);
        high[d] = cellAt(x[d] + hair);
    }
    for (int corner = 0; corner < 8; ++corner) {
        std::uint64_t number = 0;
        bool isNew = true;
        for (int d = 0; d < 3; ++d) {
            isNew &= !(corner >> d & 1) || high[d] != low[d];
            number = number << 21 | (corner >> d & 1 ? high[d] : low[d]);
        }
        if (isNew)
            body(number);
    }
}

/// A set of numbers that may also contain a few that were not inserted (a Bloom filter with one hash).
class CellSet {
  public:
    /// \param wanted expected number of insertions
    explicit CellSet(std::size_t wanted) {
        while (words < wanted)
            words *= 2;
        bits = std::make_unique<std::atomic<std::uint32_t>[]>(words);
    }
    void Insert(std::uint64_t cell) {
        const std::uint64_t h = Hash(cell);
        bits[Word(h)].fetch_or(1u << (h & 31), std::memory_order_relaxed);
    }
    bool Contains(std::uint64_t cell) const {
        const std::uint64_t h = Hash(cell);
        return bits[Word(h)].load(std::memory_order_relaxed) >> (h & 31) & 1;
    }

  private:
    static std::uint64_t Hash(std::uint64_t cell) {
        std::uint64_t h = cell * 0x9E3779B97F4A7C15u;
        h = (h ^ h >> 29) * 0xBF58476D1CE4E5B9u;
        return h >> 20;
    }
    std::size_t Word(std::uint64_t hash) const { return (hash >> 5) & (words - 1); }

    std::size_t words = 1 << 10;
    std::unique_ptr<std::atomic<std::uint32_t>[]> bits;
};

/// Coarse cells of a box that have points in or near them: a quick test that rules out most other points.
class CoarseCells {
  public:
    /// \param box not flat
    explicit CoarseCells(const Eigen::AlignedBox3f &box)
        : low(box.min()), scale(across / box.sizes().array()), bits(new std::atomic<std::uint64_t>[Row(across, 0)]()) {}
    void Insert(const Eigen::Vector3f &x, float margin) {
        const Cell first = At(x.array() - margin), last = At(x.array() + margin);
        for (int i = first[0]; i <= last[0]; ++i)
            for (int j = first[1]; j <= last[1]; ++j) {
                const std::uint64_t row = std::uint64_t(-1) >> (across - 1 - last[2]) & std::uint64_t(-1) << first[2];
                auto &word = bits[Row(i, j)];
                if (row & ~word.load(std::memory_order_relaxed))
                    word.fetch_or(row, std::memory_order_relaxed);
            }
    }
    bool Contains(const Eigen::Vector3f &x) const {
        const Cell c = At(x);
        return bits[Row(c[0], c[1])].load(std::memory_order_relaxed) >> c[2] & 1;
    }

  private:
    static constexpr int across = 64;
    using Cell = Eigen::Array3i;
    static std::size_t Row(int i, int j) { return std::size_t(i) * across + std::size_t(j); }
    /// Beyond the box, the outermost cell.
    Cell At(const Eigen::Array3f &x) const { return ((x - low) * scale).max(0.f).min(float(across - 1)).cast<int>(); }

    Eigen::Array3f low, scale;
    std::unique_ptr<std::atomic<std::uint64_t>[]> bits;
};

/// The candidates of \p region that may be within \p hair of one of its parts, as ascending slots. Compares cells of a
/// grid, so a few may be farther away.
/// \param parts, candidates how many slots are flagged as such
/// \param at at(slot): position, frame units \param inFrame inFrame(position in mesh units): in frame units
/// \param box of the parts, frame units \param hair frame units, >= 0
template <class At, class InFrame>
std::vector<std::uint32_t> CandidatesBeside(const Region &region, std::size_t parts, std::size_t candidates,
                                            const At &at, const InFrame &inFrame, const Eigen::AlignedBox3f &box,
                                            float hair, const Progress &progress) {
    const std::size_t slots = region.flag.size();
    // Cells 20 hairs wide: the hair of a point mostly touches one cell, and few other points share it.
    const float cells = hair > 0 ? 0.05f / hair : 1e6f;
    // First leave out boxes of candidates that are far from all parts: by more than cells, hair and rounding.
    const Eigen::Vector3f reach =
        Eigen::Vector3f::Constant(hair + 2 / cells) + 1e-6f * box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs());
    const Eigen::AlignedBox3f near(box.min() - reach, box.max() + reach);
    std::vector<char> isNear(region.box.size());
    for (std::size_t b = 0; b < isNear.size(); ++b) {
        Eigen::AlignedBox3f there;
        for (int corner = 0; corner < 8 && !region.box[b].isEmpty(); ++corner)
            there.extend(inFrame(region.box[b].corner(Eigen::AlignedBox3d::CornerType(corner))));
        isNear[b] = near.intersects(there);
    }
    const auto forCells = [&](const Eigen::Vector3f &x, bool ofPart, const auto &body) {
        ForCells(x, cells, ofPart ? hair : 0, body);
    };
    const auto isOn = [&](std::size_t i, bool ofPart) {
        return ofPart ? region.flag[i] == Region::part
                      : region.flag[i] == Region::candidate && isNear[i / Region::boxed];
    };
    // First list the cells of the fewer ones, parts or candidates. Of the others, keep those in these cells. Then keep
    // of the fewer ones those in the cells of what was kept.
    const bool partsFirst = parts <= candidates;
    CellSet first(std::min(parts, candidates));
    CoarseCells coarse(near);
    const float margin = reach.maxCoeff(); // points that share a fine cell are nearer than this
    ParallelForEach(progress.Slice(0, 0.5), readingStage, slots, 1 << 16, [&](std::size_t i) {
        if (!isOn(i, partsFirst))
            return;
        const Eigen::Vector3f x = at(i);
        if (!near.contains(x))
            return;
        coarse.Insert(x, margin);
        forCells(x, partsFirst, [&](std::uint64_t cell) { first.Insert(cell); });
    });
    const auto thoseIn = [&](const CellSet &set, bool ofPart) {
        return NumbersThat<std::uint32_t>(progress.Slice(0.5, 1), readingStage, slots, [&](std::size_t i) {
            if (!isOn(i, ofPart))
                return false;
            const Eigen::Vector3f x = at(i);
            bool isIn = false;
            if (near.contains(x) && coarse.Contains(x))
                forCells(x, ofPart, [&](std::uint64_t cell) { isIn = isIn || set.Contains(cell); });
            return isIn;
        });
    };
    std::vector<std::uint32_t> part = thoseIn(first, !partsFirst), beside;
    CellSet second(part.size());
    for (std::uint32_t i : part)
        forCells(at(i), !partsFirst, [&](std::uint64_t cell) { second.Insert(cell); });
    beside = thoseIn(second, partsFirst);
    if (partsFirst)
        part.swap(beside);
    std::vector<std::uint64_t> cell;
    for (std::uint32_t i : part)
        forCells(at(i), true, [&](std::uint64_t c) { cell.push_back(c); });
    std::sort(cell.begin(), cell.end());
    const auto isNowhere = [&](std::uint32_t i) {
        bool isIn = false;
        forCells(at(i), false, [&](std::uint64_t c) { isIn = std::binary_search(cell.begin(), cell.end(), c); });
        return !isIn;
    };
    beside.erase(std::remove_if(beside.begin(), beside.end(), isNowhere), beside.end());
    return beside;
}

} // namespace vcg::fcd::detail

#endif
