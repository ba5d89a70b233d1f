// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TRIANGLE_TREE_H
#define VCG_FCD_TRIANGLE_TREE_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/base/symmetric_eigen.h>
#include <vcg_ext/surface/triangle_weights.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// Finds the triangle nearest to a point; of equally near ones, the first. A tree of boxes around four boxes or
/// triangles each. Boxes only rule out what is farther away by more than rounding, so the tree changes no bit of the
/// result.
class TriangleTree {
  public:
    /// The nearest triangle, and the conditions of the search.
    struct Nearest {
        Index triangle = -1;                                ///< -1: none
        Eigen::Vector3d weight = Eigen::Vector3d::Zero();   ///< barycentric coordinates of the nearest point
        double square = std::numeric_limits<double>::max(); ///< of the distance
        const Eigen::Vector3d *facing = nullptr;            ///< only triangles that face along it count; null: all
        const std::function<bool(Index)> *counts = nullptr; ///< only triangles for which it is true count; null: all
    };

    /// \param position 3 x slots, any unit, no number beyond 1e100; must outlive this
    /// \param given slots of the corners, at least one triangle \throw Cancelled
    TriangleTree(const Eigen::Matrix3Xd &position, std::vector<std::array<Index, 3>> given,
                 const Progress &progress = {})
        : position(position), triangle(std::move(given)), middle(triangle.size()) {
        ParallelForEach(progress.Slice(0, 0.1), stage, triangle.size(), 1 << 14,
                        [&](std::size_t t) { middle[t] = BoxOf(Index(t)).center(); });
        std::vector<Index> order(triangle.size());
        std::iota(order.begin(), order.end(), 0);
        nodeCount = std::max<std::size_t>(1, NodesAround(order.size()));
        nodes = LargeArray<Node>(nodeCount);
        Progress building = progress.Slice(0.1, 1);
        building.threads = ThreadsFor(progress.threads);
        Build(order.data(), order.data() + order.size(), 0, building);
        std::vector<Eigen::Vector3d>().swap(middle);
    }

    const std::array<Index, 3> &operator[](Index t) const { return triangle[t]; }
    const std::vector<std::array<Index, 3>> &Triangles() const { return triangle; }
    /// \param p no number beyond 1e100 \param begin a triangle that may be near, for speed; -1: none
    Nearest operator()(const Eigen::Vector3d &p, Index begin) const {
        Nearest nearest;
        if (begin >= 0)
            Try(p, begin, nearest);
        Search(p, begin, nearest);
        return nearest;
    }
    /// The same among triangles whose normal makes less than 90 degrees with \p normal, within \p reach.
    Nearest Facing(const Eigen::Vector3d &p, const Eigen::Vector3d &normal, double reach) const {
        Nearest nearest;
        nearest.square = reach * reach;
        nearest.facing = &normal;
        Search(p, -1, nearest);
        return nearest;
    }
    /// The same among triangles for which \p counts is true.
    Nearest Among(const Eigen::Vector3d &p, const std::function<bool(Index)> &counts) const {
        Nearest nearest;
        nearest.counts = &counts;
        Search(p, -1, nearest);
        return nearest;
    }
    /// The normal of a triangle, as long as twice its area.
    Eigen::Vector3d NormalOf(Index t) const {
        const auto &corners = triangle[t];
        const Eigen::Vector3d a = position.col(corners[0]), b = position.col(corners[1]), c = position.col(corners[2]);
        return (b - a).cross(c - a);
    }
    double LongestEdgeOf(Index t) const {
        const auto &corners = triangle[t];
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k)
            square = std::max(square, (position.col(corners[k]) - position.col(corners[(k + 1) % 3])).squaredNorm());
        return std::sqrt(square);
    }

  private:
    static constexpr const char *stage = "Sorting the triangles";
    static constexpr std::size_t wide = 4;
    static constexpr std::uint32_t often = 1 << 20; ///< comparisons between reports: some hundredths of a second
    static constexpr Index none = std::numeric_limits<Index>::max();

    /// The most triangles of a node with axes of its own: more are hardly flat.
    static constexpr std::size_t flat = wide * wide * wide;

    /// The boxes of four children. Around few triangles they have axes of their own, in which the triangles lie flat: a
    /// box oblique to the surface would reach much nearer to a far point than its triangles do.
    struct Node {
        Eigen::Matrix3f axes; ///< rows
        double low[3][wide], high[3][wide];
        std::array<Index, wide> child; ///< a node; -1 - t: triangle t; or none, in an empty box
    };
    struct Built {
        Eigen::AlignedBox3d box;
        Index child = none;
    };

    Eigen::AlignedBox3d BoxOf(Index t) const {
        Eigen::AlignedBox3d box;
        for (Index i : triangle[t])
            box.extend(Eigen::Vector3d(position.col(i)));
        return box;
    }

    /// Divides triangles along the longest side of the box of their middles. \throw Cancelled
    void Divide(Index *first, Index *at, Index *last, const Progress &progress) const {
        if (at >= last)
            return;
        Eigen::AlignedBox3d box;
        for (const Index *t = first; t != last; ++t)
            box.extend(middle[std::size_t(*t)]);
        int axis;
        box.sizes().maxCoeff(&axis);
        std::uint32_t compared = 0;
        std::nth_element(first, at, last, [&](Index a, Index b) {
            if (++compared % often == 0)
                progress(0, stage);
            return middle[a][axis] < middle[b][axis];
        });
    }

    /// The number of nodes of a tree over so many triangles; 0 for a single one.
    static std::size_t NodesAround(std::size_t triangles) {
        if (triangles < 2)
            return 0;
        const std::size_t part = PartOf(triangles);
        return 1 + triangles / part * ((part - 1) / (wide - 1)) + NodesAround(triangles % part);
    }
    /// The number of triangles of each child except the last one, so that nearly all nodes are full.
    static std::size_t PartOf(std::size_t triangles) {
        std::size_t part = 1;
        while (wide * part < triangles)
            part *= wide;
        return part;
    }

    /// Builds the nodes over these triangles, from number \p at on; the root comes last.
    Built Build(Index *const first, Index *last, std::size_t at, const Progress &progress) {
        const std::size_t count = std::size_t(last - first), part = PartOf(count);
        if (count >= 1 << 12)
            progress(0, stage);
        Progress both = progress;
        if (count < 1 << 15) // threads would cost more than they save
            both.threads = 1;
        const auto to = [&](std::size_t k) { return first + std::min(k * part, count); };
        Divide(first, to(2), last, both);
        ParallelTasks(both.Slice(0, 0), stage, 2, [&](std::size_t half, const Progress &shared) {
            Divide(to(2 * half), to(2 * half + 1), half == 0 ? to(2) : last, shared);
        });
        std::array<std::size_t, wide> begin; // of each child's nodes; this node comes after all of them
        for (std::size_t k = 0; k < wide; ++k) {
            begin[k] = at;
            at += NodesAround(std::size_t(to(k + 1) - to(k)));
        }
        std::array<Built, wide> built;
        ParallelTasks(both, stage, wide, [&](std::size_t k, const Progress &shared) {
            if (to(k) + 1 == to(k + 1)) {
                built[k] = {BoxOf(*to(k)), -1 - *to(k)};
            } else if (to(k) < to(k + 1)) {
                Progress share = shared;
                share.threads = std::max(1u, both.threads / unsigned(wide));
                built[k] = Build(to(k), to(k + 1), begin[k], share);
            }
        });
        Node &node = nodes[at];
        node.axes = count <= flat ? AxesOf(first, last) : Eigen::Matrix3f(Eigen::Matrix3f::Identity());
        Built all{{}, Index(at)};
        for (std::size_t k = 0; k < wide; ++k) {
            all.box.extend(built[k].box);
            Eigen::AlignedBox3d box = built[k].box;
            if (count <= flat) {
                box.setEmpty();
                for (const Index *t = to(k); t != to(k + 1); ++t)
                    for (Index i : triangle[std::size_t(*t)])
                        box.extend(node.axes.cast<double>() * position.col(i));
            }
            node.child[k] = built[k].child;
            // More than distances to its triangles are rounded by: a few of the last bits of the coordinates.
            const double margin = std::ldexp(box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff(), -46);
            for (int d = 0; d < 3; ++d) {
                node.low[d][k] = box.min()[d] - margin;
                node.high[d][k] = box.max()[d] + margin;
            }
        }
        return all;
    }

    /// The axes, as rows, in which the corners of the triangles lie flattest.
    Eigen::Matrix3f AxesOf(const Index *first, const Index *last) const {
        const Eigen::Vector3d origin = middle[std::size_t(*first)];
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
        for (const Index *t = first; t != last; ++t)
            for (Index i : triangle[std::size_t(*t)]) {
                const Eigen::Vector3d x = position.col(i) - origin;
                sum += x;
                squares += x * x.transpose();
            }
        squares -= sum * sum.transpose() / double(3 * (last - first));
        return SymmetricEigen(squares).Vectors().transpose().cast<float>();
    }

    /// A child and, in the upper half, the upper half of the square of its least distance. Nearer steps are smaller
    /// numbers.
    using Step = std::uint64_t;
    static constexpr Step upper = Step(-1) << 32;
    static Step StepTo(double square, Index child) {
        Step bits; // of numbers >= 0, the bits have the order of the numbers
        std::memcpy(&bits, &square, sizeof bits);
        return (bits & upper) | std::uint32_t(child);
    }
    static double SquareOf(Step step) {
        step &= upper;
        double square;
        std::memcpy(&square, &step, sizeof square);
        return square;
    }

    /// Depth first, into the nearest box first. \param begin has been tried \param nearest in, out
    void Search(const Eigen::Vector3d &p, Index begin, Nearest &nearest) const {
        // Rounding of coordinates (the boxes' margins have theirs), and of the axes, which are floats.
        const double off = std::ldexp(p.cwiseAbs().maxCoeff(), -46), turned = 1 + std::ldexp(1.0, -20);
        const auto within = [&] { // square of the distance up to which a box may hold a nearer triangle
            const double least = std::sqrt(nearest.square) + off;
            return least * least * turned;
        };
        double bound = within();
        std::array<Step, 64> next; // three more a level, of 16 levels at most, and steps that are too far
        int count = 0;
        next[std::size_t(count++)] = StepTo(0, Index(nodeCount) - 1);
        while (count > 0) {
            const Step step = next[std::size_t(--count)];
            if (SquareOf(step) > bound)
                continue;
            const auto child = Index(std::uint32_t(step));
            if (child < 0) {
                if (-1 - child != begin && Try(p, -1 - child, nearest))
                    bound = within();
                continue;
            }
            const Node &node = nodes[child];
            double square[wide] = {};
            const Eigen::Vector3d q = node.axes.cast<double>() * p;
            for (int d = 0; d < 3; ++d)
                for (std::size_t k = 0; k < wide; ++k) {
                    const double beyond = std::max(std::max(node.low[d][k] - q[d], q[d] - node.high[d][k]), 0.0);
                    square[k] += beyond * beyond;
                }
            std::array<Step, wide> near;
            int found = 0;
            for (std::size_t k = 0; k < wide; ++k) {
                const int isNear = int(square[k] <= bound) & int(node.child[k] != none);
                near[k] = StepTo(square[k], node.child[k]) & (Step(0) - Step(isNear));
                found += isNear;
            }
            // Sort without branches, which a processor could not predict.
            const auto order = [&near](std::size_t a, std::size_t b) {
                const Step nearer = std::min(near[a], near[b]);
                near[a] = std::max(near[a], near[b]);
                near[b] = nearer;
            };
            order(0, 1);
            order(2, 3);
            order(0, 2);
            order(1, 3);
            order(1, 2);
            // The nearest one comes last; the next ones overwrite those that are too far.
            std::copy(near.begin(), near.end(), next.begin() + count);
            count += found;
        }
    }

    /// Sets \p nearest to triangle \p t if that is nearer and counts. \return whether it did
    bool Try(const Eigen::Vector3d &p, Index t, Nearest &nearest) const {
        const auto &corners = triangle[t];
        const Eigen::Vector3d a = position.col(corners[0]), b = position.col(corners[1]), c = position.col(corners[2]);
        const Eigen::Vector3d weight = WeightsOfNearest(a, b, c, p);
        const double square = (a * weight[0] + b * weight[1] + c * weight[2] - p).squaredNorm();
        if (!(square < nearest.square || (square == nearest.square && t < nearest.triangle)))
            return false;
        if (nearest.facing && !((b - a).cross(c - a).dot(*nearest.facing) > 0))
            return false;
        if (nearest.counts && !(*nearest.counts)(t))
            return false;
        nearest.triangle = t;
        nearest.weight = weight;
        nearest.square = square;
        return true;
    }

    const Eigen::Matrix3Xd &position;
    const std::vector<std::array<Index, 3>> triangle;
    std::vector<Eigen::Vector3d> middle; ///< of the triangles' boxes, while they are sorted
    std::unique_ptr<Node[]> nodes;       ///< not initialised before Build
    std::size_t nodeCount = 0;
};

} // namespace vcg::fcd::detail

#endif
