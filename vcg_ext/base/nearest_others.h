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

/// Finds the nearest other points of all points of a block at once. Keeps its buffers; use one a thread.
template <class Scalar>
class NearestOthers {
  public:
    using Neighbour = typename PointTree<Scalar>::Neighbour;

    explicit NearestOthers(const PointTree<Scalar> &points) : points(points) {}

    /// Finds the \p count nearest others (or all, if there are fewer) of each of the points [first, last), in the order
    /// of the blocks; these points should be near each other.
    void Ask(std::size_t first, std::size_t last, std::size_t count) {
        if (each != std::min(count, points.Size() - 1)) {
            each = std::min(count, points.Size() - 1);
            reach = usual = std::numeric_limits<Scalar>::infinity();
            most = 8 * (each + few);
            const std::size_t room = most + 2 * PointTree<Scalar>::most; // points are written before they are counted
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
    /// Whether the last Ask was for this point and at least \p count.
    bool Knows(std::size_t at, std::size_t count) const {
        return from <= at && at < to && each >= std::min(count, points.Size() - 1);
    }
    std::size_t Each() const { return each; }
    /// The Each() nearest others of a point of Ask, the nearest first.
    const Neighbour *Of(std::size_t at) const { return found.data() + (at - from) * each; }

  private:
    using Box = typename PointTree<Scalar>::Box;
    using Rank = std::conditional_t<sizeof(Scalar) == 8, std::int64_t, std::int32_t>; // as wide as Scalar, for vectors
    static constexpr std::size_t few = 64;
    static constexpr std::size_t lanes = 8;                                         // few is a multiple of it
    static constexpr Scalar more = 1 + 16 * std::numeric_limits<Scalar>::epsilon(); // more than rounding

    static Scalar Square(Scalar a) { return a * a * more; }

    /// Appends the nearest others of the points [first, last) to `found`.
    void Answer(std::size_t first, std::size_t last) {
        if (last - first == 1) {
            points.Nearest(points.At(first), each, near, PointTree<Scalar>::none, first);
            Tell();
            return;
        }
        const Box box = points.BoxOf(first, last);
        const std::size_t begin = told;
        // Begin with about the distance of the last points' neighbours, at most that of one point's, plus the diagonal.
        Scalar within = std::min(reach * Scalar(1.5), Square(std::sqrt(Beside(first)) + box.Diagonal()));
        for (;;) {
            told = begin;
            if (!Collect(box, within)) { // too many candidates: the points are far from each other
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

    /// Sets `square` to the squared distances from a point to the points of some arrays.
    void Measure(std::size_t i, const Scalar *x, const Scalar *y, const Scalar *z, std::size_t count) {
        const Scalar px = points.X()[i], py = points.Y()[i], pz = points.Z()[i];
        Scalar *const s = square.data();
        for (std::size_t c = 0; c < count; ++c) {
            const Scalar dx = x[c] - px, dy = y[c] - py, dz = z[c] - pz;
            s[c] = dx * dx + dy * dy + dz * dz;
        }
    }

    /// An upper bound of the squared distance of a point's neighbours, from the points beside it in the order.
    Scalar Beside(std::size_t i) {
        const std::size_t first = std::min(i - std::min(i, each / 2), points.Size() - each - 1);
        Measure(i, points.X() + first, points.Y() + first, points.Z() + first, each + 1);
        return *std::max_element(square.begin(), square.begin() + std::ptrdiff_t(each + 1));
    }

    /// Collects the points near \p box as candidates. \param within squared distance \return false: there are too many
    bool Collect(const Box &box, Scalar within) {
        candidates = 0;
        points.ForEachNear(box, within * more, [&](std::size_t first, std::size_t last) {
            Scalar far[PointTree<Scalar>::most] = {};
            for (std::size_t i = first; i < last; ++i)
                far[i - first] = box.SquareTo(points.X()[i], points.Y()[i], points.Z()[i]);
            std::size_t n = candidates;
            for (std::size_t i = first; i < last; ++i) { // without branches, which could not be predicted
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

    /// Sets key and place of the candidates within a distance of point \p i. \pre Measure \param bound squared
    /// \return how many there are
    std::size_t Within(std::size_t i, Scalar bound) {
        std::size_t hits = 0;
        for (std::size_t c = 0; c < candidates; ++c) {
            key[hits] = square[c];
            place[hits] = which[c];
            hits += std::size_t(square[c] <= bound) & std::size_t(std::size_t(which[c]) != i);
        }
        return hits;
    }

    /// Appends the nearest candidates of point \p i to `found`. \param follows the last point was i - 1
    void Choose(std::size_t i, bool follows) {
        Measure(i, x.data(), y.data(), z.data(), candidates);
        // Mostly about as far as those of the last point; never farther than by the step from there.
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

    /// Appends the first of `near` to `found`.
    void Tell() {
        std::copy(near.begin(), near.begin() + std::ptrdiff_t(each), found.begin() + std::ptrdiff_t(told));
        told += each;
    }

    /// Appends the nearest of key and place to `found`. Sorts by counting how many are nearer than each, without
    /// branches that could not be predicted. \return false: some are equally near, and nothing was appended
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
    std::size_t most = 0, candidates = 0;     // how many may be collected, and how many are
    Scalar reach = 0, usual = 0;              // squared distance of the neighbours of the last range, and last point
    std::vector<Scalar> square, x, y, z, key; // of the candidates; key: squares of those within a distance
    std::vector<Index> which, place;          // places of the candidates in the order; of those of key
    std::vector<Neighbour> near, found;
    std::size_t told = 0; // length of found
};

} // namespace vcg::fcd

#endif
