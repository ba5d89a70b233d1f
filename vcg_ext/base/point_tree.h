// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_POINT_TREE_H
#define VCG_FCD_POINT_TREE_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/parallel.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// Finds the nearest of some points: a balanced k-d tree with blocks of neighbouring points as leaves. Safe for any
/// number of threads. (NearestOthers answers for all points of a block at once, in half of the time.)
template <class Scalar>
class PointTree {
  public:
    using Point = Eigen::Matrix<Scalar, 3, 1>;
    struct Box {
        Scalar lo[3], hi[3];
        Scalar Diagonal() const { return (Point(hi[0], hi[1], hi[2]) - Point(lo[0], lo[1], lo[2])).norm(); }
        /// Square of the distance from a point.
        Scalar SquareTo(Scalar x, Scalar y, Scalar z) const { return SquareTo(Box{{x, y, z}, {x, y, z}}); }
        /// Square of the distance to another box, up to rounding.
        Scalar SquareTo(const Box &o) const {
            Scalar sum = 0;
            for (int d = 0; d < 3; ++d) {
                const Scalar gap = std::max(std::max(lo[d] - o.hi[d], o.lo[d] - hi[d]), Scalar(0));
                sum += gap * gap;
            }
            return sum;
        }
    };

    struct Neighbour {
        Scalar square; ///< of the distance
        Index point;   ///< number of the point, as at construction
        Index at;      ///< its place in the order of the blocks
        bool operator<(const Neighbour &o) const { return square != o.square ? square < o.square : point < o.point; }
    };
    static constexpr std::size_t most = 16; ///< points of a block
    static constexpr std::size_t none = std::size_t(-1);

    /// \param position 3 x n, n >= 1; NaN counts as infinite \param threads as in ParallelFor
    explicit PointTree(const Eigen::Ref<const Eigen::Matrix<Scalar, 3, Eigen::Dynamic>> &position, unsigned threads = 1)
        : n(std::size_t(position.cols())) {
        assert(n > 0);
        while (((n + (std::size_t(1) << levels) - 1) >> levels) > most)
            ++levels;
        const std::unique_ptr<Item[]> item = LargeArray<Item>(n);
        ParallelForEach(threads, n, 1 << 16, [&](std::size_t i) {
            const auto p = position.col(Eigen::Index(i));
            item[i] = {{Ordered(p[0]), Ordered(p[1]), Ordered(p[2])}, Index(i)};
        });
        box.resize((std::size_t(2) << levels) - 1);
        least.resize(box.size());
        const int shared = std::min(levels, 6); // below this level, each cell is split by one thread
        std::vector<Box> cell{BoxOf(item.get(), 0, n)}, next;
        for (int level = 0; level < shared; ++level) {
            next.resize(2 * cell.size());
            ParallelFor(threads, cell.size(), 1, [&](std::size_t j, std::size_t) {
                Split(item.get(), level, j, cell[j], next[2 * j], next[2 * j + 1]);
            });
            cell.swap(next);
        }
        for (auto *axis : {&x, &y, &z})
            *axis = LargeArray<Scalar>(n);
        number = LargeArray<Index>(n);
        ParallelFor(threads, cell.size(), 1,
                    [&](std::size_t j, std::size_t) { SplitAll(item.get(), shared, j, cell[j]); });
        for (int level = shared; level-- > 0;)
            for (std::size_t j = 0; j < std::size_t(1) << level; ++j)
                Join(level, j);
    }

    explicit PointTree(const std::vector<Point> &points, unsigned threads = 1)
        : PointTree(Eigen::Map<const Eigen::Matrix<Scalar, 3, Eigen::Dynamic>>(points.data()->data(), 3,
                                                                               Eigen::Index(points.size())),
                    threads) {}

    /// The \p count >= 1 points nearest to \p p, or all if there are fewer, the nearest first; of equally near ones,
    /// the smaller numbers. \param begin a block that may be near, for speed \param but a place in the order of the
    /// blocks: its point does not count
    void Nearest(const Point &p, std::size_t count, std::vector<Neighbour> &found, std::size_t begin = none,
                 std::size_t but = none) const {
        found.clear(); // a heap
        const auto limit = [&] {
            return found.size() < count ? Limit() : Limit{found.front().square, found.front().point};
        };
        const auto look = [&](std::size_t first, std::size_t last) {
            Scalar square[most] = {};
            for (std::size_t at = first; at < last; ++at) {
                const Scalar dx = x[at] - p[0], dy = y[at] - p[1], dz = z[at] - p[2];
                square[at - first] = dx * dx + dy * dy + dz * dz;
            }
            for (std::size_t at = first; at < last; ++at) {
                const Neighbour each{square[at - first], number[at], Index(at)};
                if (at == but || (found.size() == count && !(each < found.front())))
                    continue;
                if (found.size() == count) {
                    std::pop_heap(found.begin(), found.end());
                    found.pop_back();
                }
                found.push_back(each);
                std::push_heap(found.begin(), found.end());
            }
            return limit();
        };
        if (begin < Blocks())
            look(Begin(begin), Begin(begin + 1));
        const auto lookElsewhere = [&](std::size_t first, std::size_t last) {
            return begin < Blocks() && first == Begin(begin) ? limit() : look(first, last);
        };
        ForEachNearest(p, lookElsewhere, limit());
        std::sort_heap(found.begin(), found.end());
    }
    /// \return the number of the point nearest to \p p \param distance out; may be null
    Index Nearest(const Point &p, Scalar *distance = nullptr) const {
        std::vector<Neighbour> nearest;
        Nearest(p, 1, nearest);
        if (distance)
            *distance = std::sqrt(nearest.front().square);
        return nearest.front().point;
    }
    /// The distance of the farthest of the \p count nearest points.
    Scalar DistanceOf(const Point &p, std::size_t count) const {
        std::vector<Neighbour> nearest;
        Nearest(p, count, nearest);
        return std::sqrt(nearest.back().square);
    }
    /// The points no farther than \p distance from \p p, in no order.
    void Within(const Point &p, Scalar distance, std::vector<Index> &found) const {
        found.clear();
        const Scalar bound = distance * distance;
        ForEachNear(Box{{p[0], p[1], p[2]}, {p[0], p[1], p[2]}}, bound, [&](std::size_t first, std::size_t last) {
            for (std::size_t at = first; at < last; ++at)
                if ((At(at) - p).squaredNorm() <= bound)
                    found.push_back(number[at]);
            return true;
        });
    }

    std::size_t Size() const { return n; }
    std::size_t Blocks() const { return std::size_t(1) << levels; }
    /// The first place of a block, in the order of the blocks; Begin(Blocks()) is Size().
    std::size_t Begin(std::size_t block) const { return Begin(levels, block); }
    // Of a place in the order of the blocks: its block, the number of its point, and the point.
    std::size_t BlockOf(std::size_t at) const { return ((at + 1) * Blocks() - 1) / n; }
    Index Number(std::size_t at) const { return number[at]; }
    Point At(std::size_t at) const { return {x[at], y[at], z[at]}; }

    /// The box of the places [first, last), at least one.
    Box BoxOf(std::size_t first, std::size_t last) const {
        Box b;
        const Scalar *const axis[3] = {x.get(), y.get(), z.get()};
        for (int d = 0; d < 3; ++d) {
            const auto ends = std::minmax_element(axis[d] + first, axis[d] + last);
            b.lo[d] = *ends.first;
            b.hi[d] = *ends.second;
        }
        return b;
    }

    /// Calls body(first, last) for the blocks that may have a point near \p of, until it returns false.
    /// \param most squared distance
    template <class Body>
    void ForEachNear(const Box &of, Scalar most, const Body &body) const {
        struct Node {
            int level;
            std::size_t j;
        } stack[64];
        int open = 0;
        stack[open++] = {0, 0};
        while (open > 0) {
            const Node node = stack[--open];
            if (box[Place(node.level, node.j)].SquareTo(of) > most)
                continue;
            if (node.level == levels) {
                if (!body(Begin(node.j), Begin(node.j + 1)))
                    return;
            } else {
                stack[open++] = {node.level + 1, 2 * node.j};
                stack[open++] = {node.level + 1, 2 * node.j + 1};
            }
        }
    }

    /// Where a search ends: beyond a squared distance, and at it for larger numbers. (Without numbers, a search among
    /// many points at one place looks at all of them.)
    struct Limit {
        Scalar square = std::numeric_limits<Scalar>::infinity();
        Index point = std::numeric_limits<Index>::max();
    };

    /// Calls body(first, last) for blocks, the nearest first, up to \p limit, then up to what body returns.
    template <class Body>
    void ForEachNearest(const Point &p, const Body &body, Limit limit = {}) const {
        struct Node {
            std::size_t j;
            int level;
            Scalar square;
        } stack[64];
        const auto make = [&](int level, std::size_t j) {
            return Node{j, level, box[Place(level, j)].SquareTo(p[0], p[1], p[2])};
        };
        int open = 0;
        stack[open++] = make(0, 0);
        while (open > 0) {
            const Node node = stack[--open];
            if (node.square > limit.square ||
                (node.square == limit.square && least[Place(node.level, node.j)] > limit.point))
                continue;
            if (node.level == levels) {
                limit = body(Begin(node.j), Begin(node.j + 1));
                continue;
            }
            Node a = make(node.level + 1, 2 * node.j), b = make(node.level + 1, 2 * node.j + 1);
            if (a.square <= b.square) // of equally near ones, that with the smaller numbers first
                std::swap(a, b);
            stack[open++] = a;
            stack[open++] = b;
        }
    }

    const Scalar *X() const { return x.get(); }
    const Scalar *Y() const { return y.get(); }
    const Scalar *Z() const { return z.get(); }

  private:
    struct Item {
        Scalar p[3];
        Index number;
    };

    static Scalar Ordered(Scalar x) { return std::isnan(x) ? std::numeric_limits<Scalar>::infinity() : x; }
    static std::size_t Place(int level, std::size_t j) { return (std::size_t(1) << level) - 1 + j; }
    std::size_t Begin(int level, std::size_t j) const { return std::size_t(std::uint64_t(n) * j >> level); }

    static Box BoxOf(const Item *item, std::size_t first, std::size_t last) {
        Box b;
        for (int d = 0; d < 3; ++d)
            b.lo[d] = b.hi[d] = item[first].p[d];
        for (std::size_t i = first; i < last; ++i)
            for (int d = 0; d < 3; ++d) {
                b.lo[d] = std::min(b.lo[d], item[i].p[d]);
                b.hi[d] = std::max(b.hi[d], item[i].p[d]);
            }
        return b;
    }

    /// Halves the points of a node along the longest side of its cell.
    void Split(Item *item, int level, std::size_t j, const Box &cell, Box &below, Box &above) const {
        int d = 0;
        for (int other = 1; other < 3; ++other)
            if (cell.hi[other] - cell.lo[other] > cell.hi[d] - cell.lo[d])
                d = other;
        const std::size_t middle = Begin(level + 1, 2 * j + 1);
        std::nth_element(
            item + Begin(level, j), item + middle, item + Begin(level, j + 1),
            [d](const Item &a, const Item &b) { return a.p[d] != b.p[d] ? a.p[d] < b.p[d] : a.number < b.number; });
        below = above = cell;
        below.hi[d] = above.lo[d] = item[middle].p[d];
    }

    void SplitAll(Item *item, int level, std::size_t j, const Box &cell) {
        if (level < levels) {
            Box below, above;
            Split(item, level, j, cell, below, above);
            SplitAll(item, level + 1, 2 * j, below);
            SplitAll(item, level + 1, 2 * j + 1, above);
            Join(level, j);
            return;
        }
        const std::size_t first = Begin(j), last = Begin(j + 1);
        // nth_element leaves the order within a block open.
        std::sort(item + first, item + last, [](const Item &a, const Item &b) { return a.number < b.number; });
        for (std::size_t i = first; i < last; ++i) {
            x[i] = item[i].p[0];
            y[i] = item[i].p[1];
            z[i] = item[i].p[2];
            number[i] = item[i].number;
        }
        box[Place(level, j)] = BoxOf(item, first, last);
        least[Place(level, j)] = item[first].number;
    }

    void Join(int level, std::size_t j) {
        const Box &a = box[Place(level + 1, 2 * j)], &b = box[Place(level + 1, 2 * j + 1)];
        Box &both = box[Place(level, j)];
        for (int d = 0; d < 3; ++d) {
            both.lo[d] = std::min(a.lo[d], b.lo[d]);
            both.hi[d] = std::max(a.hi[d], b.hi[d]);
        }
        least[Place(level, j)] = std::min(least[Place(level + 1, 2 * j)], least[Place(level + 1, 2 * j + 1)]);
    }

    const std::size_t n;
    int levels = 0;
    std::unique_ptr<Scalar[]> x, y, z; // in the order of the blocks
    std::unique_ptr<Index[]> number;
    // Of each node of the tree, level by level.
    std::vector<Box> box;
    std::vector<Index> least; // the smallest number
};

/// A tree over some nodes of a graph. \param position 3 x n \param node at least one; the tree numbers them in this
/// order
inline std::unique_ptr<PointTree<float>> TreeOf(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) {
    return std::make_unique<PointTree<float>>(Eigen::Matrix3Xf(position(Eigen::all, node)));
}

} // namespace vcg::fcd

#endif
