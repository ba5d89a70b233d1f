// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NEAREST_OTHERS_H
#define VCG_FCD_NEAREST_OTHERS_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/sort_short.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

namespace vcg::fcd {

/// The nearest others of points in blocks. Keeps its buffers between questions; one a thread.
template <class Scalar>
class NearestOthers {
  public:
    using Neighbour = typename PointTree<Scalar>::Neighbour;

    explicit NearestOthers(const PointTree<Scalar> &points) : points(points) {}

    /// Finds the \p count nearest others, or all where there are fewer, of each of the points [first, last), which are
    /// near each other. In the order of the blocks.
    void Ask(std::size_t first, std::size_t last, std::size_t count) {
        if (each != std::min(count, points.Size() - 1)) {
            each = std::min(count, points.Size() - 1);
            reach = usual = std::numeric_limits<Scalar>::infinity();
            most = 8 * (each + few);
            const std::size_t room = most + 2 * PointTree<Scalar>::most; // some are written before they are counted
            for (auto *buffer : {&square, &x, &y, &z, &key})
                buffer->resize(room);
            which.resize(room);
            place.resize(room);
        }
        from = first;
        to = last;
        told = 0;
        if (found.size() < (last - first) * each)
            found.resize((last - first) * each);
        if (each > 0)
            Answer(first, last);
    }
    /// Whether the answer of a point is there.
    bool Knows(std::size_t at, std::size_t count) const {
        return from <= at && at < to && each == std::min(count, points.Size() - 1);
    }
    std::size_t Each() const { return each; }
    /// The Each() nearest others of a point that was asked for, the nearest first.
    const Neighbour *Of(std::size_t at) const { return found.data() + (at - from) * each; }

  private:
    using Box = typename PointTree<Scalar>::Box;
    using Rank = std::conditional_t<sizeof(Scalar) == 8, std::int64_t, std::int32_t>; // as wide, to count in vectors
    static constexpr std::size_t few = 64;
    static constexpr std::size_t lanes = 8;                                         // few is a multiple of it
    static constexpr Scalar more = 1 + 16 * std::numeric_limits<Scalar>::epsilon(); // than what is rounded

    static Scalar Square(Scalar a) { return a * a * more; }

    /// Tells what is found of the points [first, last).
    void Answer(std::size_t first, std::size_t last) {
        if (last - first == 1) {
            points.Nearest(points.At(first), each, near, PointTree<Scalar>::none, first);
            Tell();
            return;
        }
        const Box box = points.BoxOf(first, last);
        const std::size_t begin = told;
        // About as far as those of the last ones; never farther than those of one of them, and the others from it.
        Scalar within = std::min(reach * Scalar(1.5), Square(std::sqrt(Beside(first)) + box.Diagonal()));
        for (;;) {
            told = begin;
            if (!Collect(box, within)) { // some of them are far from the others
                const std::size_t middle = (first + last) / 2;
                Answer(first, middle);
                Answer(middle, last);
                return;
            }
            if (candidates <= each) {
                within = std::max(4 * within, std::numeric_limits<Scalar>::min());
                continue;
            }
            reach = 0;
            for (std::size_t i = first; i < last; ++i) {
                Choose(i, i > first);
                usual = found[told - 1].square;
                reach = std::max(reach, usual);
            }
            if (reach <= within || candidates == points.Size())
                return;
            within = reach * more;
        }
    }

    /// Squares of distances from a point to those of some arrays.
    void Measure(std::size_t i, const Scalar *x, const Scalar *y, const Scalar *z, std::size_t count) {
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
        return *std::max_element(square.begin(), square.begin() + std::ptrdiff_t(each + 1));
    }

    /// Takes the points near \p box. \param within square of how far \return false where they are so many that those of
    /// the box had better ask for themselves
    bool Collect(const Box &box, Scalar within) {
        candidates = 0;
        points.ForEachNear(box, within * more, [&](std::size_t first, std::size_t last) {
            Scalar far[PointTree<Scalar>::most] = {};
            for (std::size_t i = first; i < last; ++i)
                far[i - first] = box.SquareTo(points.X()[i], points.Y()[i], points.Z()[i]);
            std::size_t n = candidates;
            for (std::size_t i = first; i < last; ++i) { // without a branch that cannot be foreseen
                which[n] = Index(i);
                x[n] = points.X()[i];
                y[n] = points.Y()[i];
                z[n] = points.Z()[i];
                n += far[i - first] <= within * more;
            }
            candidates = n;
            return n <= most;
        });
        return candidates <= most;
    }

    /// The others among what was collected and last measured, within a distance (its square): sets key and place.
    /// \return how many
    std::size_t Within(std::size_t i, Scalar bound) {
        std::size_t hits = 0;
        for (std::size_t c = 0; c < candidates; ++c) {
            key[hits] = square[c];
            place[hits] = which[c];
            hits += std::size_t(square[c] <= bound) & std::size_t(std::size_t(which[c]) != i);
        }
        return hits;
    }

    /// Tells the nearest of what was collected. \param follows the point before it was the last one
    void Choose(std::size_t i, bool follows) {
        Measure(i, x.data(), y.data(), z.data(), candidates);
        // Mostly about as far as those of the last one; never farther than from there.
        std::size_t hits = Within(i, usual * Scalar(1.25));
        if (hits < each && follows)
            hits = Within(i, Square(std::sqrt(usual) + (points.At(i) - points.At(i - 1)).norm()));
        if (hits < each)
            hits = Within(i, std::numeric_limits<Scalar>::infinity());
        assert(hits >= each);
        if (hits <= few && Count(hits))
            return;
        near.clear();
        for (std::size_t h = 0; h < hits; ++h)
            near.push_back({key[h], points.Number(std::size_t(place[h])), place[h]});
        if (hits > 2 * each) {
            std::nth_element(near.begin(), near.begin() + std::ptrdiff_t(each), near.end());
            near.resize(each);
        }
        detail::SortShort(near.data(), near.data() + near.size());
        Tell();
    }

    /// Tells the first ones of `near`.
    void Tell() {
        std::copy(near.begin(), near.begin() + std::ptrdiff_t(each), found.begin() + std::ptrdiff_t(told));
        told += each;
    }

    /// Sorts the first few of key and place by counting how many are nearer than each: without a branch that cannot be
    /// foreseen. \return false where some are equally near
    bool Count(std::size_t hits) {
        std::fill_n(key.begin() + std::ptrdiff_t(hits), lanes, std::numeric_limits<Scalar>::infinity());
        Index at[few];
        Rank sum = 0;
        for (std::size_t begin = 0; begin < hits; begin += lanes) {
            Rank rank[lanes] = {};
            for (std::size_t h = 0; h < hits; ++h)
                for (std::size_t k = 0; k < lanes; ++k)
                    rank[k] += key[h] < key[begin + k];
            for (std::size_t k = 0; k < std::min(lanes, hits - begin); ++k) {
                at[rank[k]] = Index(begin + k);
                sum += rank[k];
            }
        }
        if (std::size_t(sum) != hits * (hits - 1) / 2)
            return false;
        for (std::size_t k = 0; k < each; ++k) {
            const Index p = place[at[k]];
            found[told++] = {key[at[k]], points.Number(std::size_t(p)), p};
        }
        return true;
    }

    const PointTree<Scalar> &points;
    std::size_t each = std::size_t(-1), from = 0, to = 0;
    std::size_t most = 0, candidates = 0; // how many may be collected, and how many are
    Scalar reach = 0, usual = 0;          // squares of how far those of the last ones, and of the last one, were found
    std::vector<Scalar> square, x, y, z, key; // of the collected points; key: of the candidates
    std::vector<Index> which, place;
    std::vector<Neighbour> near, found;
    std::size_t told = 0; // of found
};

} // namespace vcg::fcd

#endif
