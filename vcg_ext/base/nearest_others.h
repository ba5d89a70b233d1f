// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NEAREST_OTHERS_H
#define VCG_FCD_NEAREST_OTHERS_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/point_blocks.h>
#include <vcg_ext/base/sort_short.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace vcg {
namespace fcd {

/// The nearest others of points in blocks. Keeps its buffers between questions; one a thread.
template <class Scalar>
class NearestOthers {
  public:
    struct Found {
        Scalar square; ///< of its distance
        Index number;  ///< of the point
        Index at;      ///< in the order of the blocks
        bool operator<(const Found &o) const { return square != o.square ? square < o.square : number < o.number; }
    };

    explicit NearestOthers(const PointBlocks<Scalar> &points) : points(points) {}

    /// Finds the \p count nearest others, or all where there are fewer, of each of the points [first, last), which are
    /// near each other. In the order of the blocks.
    void Ask(std::size_t first, std::size_t last, std::size_t count) {
        if (each != std::min(count, points.Size() - 1)) {
            each = std::min(count, points.Size() - 1);
            reach = usual = std::numeric_limits<Scalar>::infinity();
        }
        from = first;
        to = last;
        found.clear();
        if (each > 0)
            Answer(first, last);
    }
    /// Whether the answer of a point is there.
    bool Knows(std::size_t at, std::size_t count) const {
        return from <= at && at < to && each == std::min(count, points.Size() - 1);
    }
    std::size_t Each() const { return each; }
    /// The Each() nearest others of a point that was asked for, the nearest first.
    const Found *Of(std::size_t at) const { return found.data() + (at - from) * each; }

  private:
    using Box = typename PointBlocks<Scalar>::Box;
    static constexpr std::size_t few = 64;
    static constexpr Scalar more = 1 + 16 * std::numeric_limits<Scalar>::epsilon(); // than what is rounded

    static Scalar Square(Scalar a) { return a * a * more; }

    /// Appends what is found of the points [first, last).
    void Answer(std::size_t first, std::size_t last) {
        if (last - first == 1) {
            Alone(first);
            return;
        }
        const Box box = points.BoxOf(first, last);
        const std::size_t begin = found.size();
        // About as far as those of the last ones; never farther than those of one of them, and the others from it.
        Scalar within = std::min(reach * Scalar(1.5), Square(std::sqrt(Beside(first)) + box.Diagonal()));
        for (;;) {
            found.resize(begin);
            if (!Collect(box, within)) { // some of them are far from the others
                const std::size_t middle = (first + last) / 2;
                Answer(first, middle);
                Answer(middle, last);
                return;
            }
            if (which.size() <= each) {
                within = std::max(4 * within, std::numeric_limits<Scalar>::min());
                continue;
            }
            reach = 0;
            for (std::size_t i = first; i < last; ++i) {
                Choose(i, i > first);
                usual = found.back().square;
                reach = std::max(reach, usual);
            }
            if (reach <= within || which.size() == points.Size())
                return;
            within = reach * more;
        }
    }

    /// Squares of distances from a point to those of some arrays.
    void Measure(std::size_t i, const Scalar *x, const Scalar *y, const Scalar *z, std::size_t count) {
        square.resize(count);
        const Scalar px = points.X()[i], py = points.Y()[i], pz = points.Z()[i];
        Scalar *const s = square.data();
        for (std::size_t c = 0; c < count; ++c) {
            const Scalar dx = x[c] - px, dy = y[c] - py, dz = z[c] - pz;
            s[c] = dx * dx + dy * dy + dz * dz;
        }
    }

    /// Square of how far the nearest ones of a point are at most, as those beside it in the order show.
    Scalar Beside(std::size_t i) {
        const std::size_t first = std::min(i - std::min(i, each / 2), points.Size() - each - 1);
        Measure(i, points.X() + first, points.Y() + first, points.Z() + first, each + 1);
        return *std::max_element(square.begin(), square.end());
    }

    /// As any k-d tree answers.
    void Alone(std::size_t i) {
        near.clear();
        const typename PointBlocks<Scalar>::Point p = points.At(i);
        points.ForEachNearest(p, [&](std::size_t first, std::size_t last) {
            Measure(i, points.X() + first, points.Y() + first, points.Z() + first, last - first);
            for (std::size_t at = first; at < last; ++at) {
                const Found other{square[at - first], points.Number(at), Index(at)};
                if (at == i || (near.size() == each && !(other < near.front())))
                    continue;
                if (near.size() == each) {
                    std::pop_heap(near.begin(), near.end());
                    near.pop_back();
                }
                near.push_back(other);
                std::push_heap(near.begin(), near.end());
            }
            return near.size() < each ? std::numeric_limits<Scalar>::infinity() : near.front().square * more;
        });
        std::sort_heap(near.begin(), near.end());
        found.insert(found.end(), near.begin(), near.end());
    }

    /// Takes the points near \p box. \param within square of how far \return false where they are so many that those of
    /// the box had better ask for themselves
    bool Collect(const Box &box, Scalar within) {
        const std::size_t most = 8 * (each + few);
        which.clear();
        points.ForEachNear(box, within * more, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                if (box.SquareTo(points.X()[i], points.Y()[i], points.Z()[i]) <= within * more)
                    which.push_back(Index(i));
            return which.size() <= most;
        });
        if (which.size() > most)
            return false;
        x.resize(which.size());
        y.resize(which.size());
        z.resize(which.size());
        hit.resize(which.size() + 1);
        for (std::size_t c = 0; c < which.size(); ++c) {
            x[c] = points.X()[which[c]];
            y[c] = points.Y()[which[c]];
            z[c] = points.Z()[which[c]];
        }
        return true;
    }

    /// How many of what was collected are within a distance (its square), the point itself included: sets hit.
    std::size_t Within(Scalar bound) {
        hits = 0;
        for (std::size_t c = 0; c < square.size(); ++c) {
            hit[hits] = std::uint32_t(c);
            hits += square[c] <= bound;
        }
        return hits;
    }

    /// Appends the nearest of what was collected. \param follows the point before it was the last one
    void Choose(std::size_t i, bool follows) {
        Measure(i, x.data(), y.data(), z.data(), x.size());
        // Mostly about as far as those of the last one; never farther than from there.
        if (Within(usual * Scalar(1.25)) <= each &&
            (!follows || Within(Square(std::sqrt(usual) + (points.At(i) - points.At(i - 1)).norm())) <= each))
            Within(std::numeric_limits<Scalar>::infinity());
        near.clear();
        for (std::size_t h = 0; h < hits; ++h)
            if (const Index at = which[hit[h]]; std::size_t(at) != i)
                near.push_back({square[hit[h]], points.Number(std::size_t(at)), at});
        assert(near.size() >= each);
        if (near.size() <= few && Rank())
            return;
        if (near.size() > 2 * each) {
            std::nth_element(near.begin(), near.begin() + std::ptrdiff_t(each), near.end());
            near.resize(each);
        }
        detail::SortShort(near.data(), near.data() + near.size());
        found.insert(found.end(), near.begin(), near.begin() + std::ptrdiff_t(each));
    }

    /// Sorts by counting how many are nearer, for each of a few: without a branch that cannot be foreseen.
    /// \return false where some are equally near
    bool Rank() {
        const std::size_t n = near.size(), begin = found.size();
        Scalar key[few];
        for (std::size_t h = 0; h < n; ++h)
            key[h] = near[h].square;
        found.resize(begin + each);
        std::size_t sum = 0;
        for (std::size_t h = 0; h < n; ++h) {
            int rank = 0;
            for (std::size_t g = 0; g < n; ++g)
                rank += key[g] < key[h];
            sum += std::size_t(rank);
            if (std::size_t(rank) < each)
                found[begin + std::size_t(rank)] = near[h];
        }
        if (sum == n * (n - 1) / 2)
            return true;
        found.resize(begin);
        return false;
    }

    const PointBlocks<Scalar> &points;
    std::size_t each = std::size_t(-1), from = 0, to = 0, hits = 0;
    Scalar reach = 0, usual = 0; // squares of how far those of the last ones, and of the last one, were found
    std::vector<Scalar> square, x, y, z;
    std::vector<Index> which;
    std::vector<std::uint32_t> hit;
    std::vector<Found> near, found;
};

} // namespace fcd
} // namespace vcg

#endif
