// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TRIANGLE_TREE_H
#define VCG_FCD_TRIANGLE_TREE_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/parallel.h>
#include <vcg_ext/base/symmetric_eigen.h>
#include <vcg_ext/surface/nearest_in_triangle.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <vector>

namespace vcg {
namespace fcd {
namespace detail {

/// The triangle nearest to a point, of those with the least square of its distance, as computed, the first one. A tree
/// of boxes around four boxes or triangles each, which are looked at together, in single precision; they only tell what
/// cannot be nearest, by more than all that is rounded, so no bit of what is found depends on them.
class TriangleTree {
  public:
    /// A triangle, the weights of its corners in its point that is nearest, and the square of the distance.
    struct Nearest {
        Index triangle = -1;
        Eigen::Vector3d weight = Eigen::Vector3d::Zero();
        double square = std::numeric_limits<double>::max();
        const Eigen::Vector3d *facing = nullptr; ///< where the fronts of those that count look to; null: all count
    };

    /// \param position 3 x slots, which must outlive this; no number beyond 1e100
    /// \param triangle slots of the corners, at least one triangle \param threads 0 = one a core
    TriangleTree(const Eigen::Matrix3Xd &position, std::vector<std::array<Index, 3>> given, unsigned threads = 0)
        : position(position), triangle(std::move(given)) {
        const std::size_t grain = 1 << 14;
        std::vector<Eigen::AlignedBox3d> boxes((triangle.size() + grain - 1) / grain);
        ParallelFor(threads, triangle.size(), grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t t = first; t < last; ++t)
                for (Index i : triangle[t])
                    boxes[first / grain].extend(Eigen::Vector3d(position.col(i)));
        });
        Eigen::AlignedBox3d all;
        for (const Eigen::AlignedBox3d &box : boxes)
            all.extend(box);
        center = 0.5 * all.min() + 0.5 * all.max();
        const double radius = 0.5 * all.sizes().norm();
        scale = radius > 1e-50 ? 1 / radius : 1; // a single point has none; no square of a distance is infinite
        largest = all.min().cwiseAbs().cwiseMax(all.max().cwiseAbs()).maxCoeff();
        middle.resize(triangle.size());
        ParallelFor(threads, triangle.size(), grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t t = first; t < last; ++t)
                middle[t] = BoxOf(Index(t)).center();
        });
        std::vector<Index> order(triangle.size());
        std::iota(order.begin(), order.end(), 0);
        const std::size_t count = std::max<std::size_t>(1, NodesAround(triangle.size()));
        nodes.reserve(count);
        PreferLargePages(nodes.data(), count * sizeof(Node));
        nodes.resize(count);
        Build(order.data(), order.data() + order.size(), 0, threads);
        middle = std::vector<Eigen::Vector3f>(); // {} would keep the memory
    }

    const std::array<Index, 3> &operator[](Index t) const { return triangle[std::size_t(t)]; }
    const std::vector<std::array<Index, 3>> &Triangles() const { return triangle; }

    /// \param p no number beyond 1e100 \param begin a triangle that may be near, which changes no bit; -1: none
    Nearest operator()(const Eigen::Vector3d &p, Index begin) const { return Find(p, begin, {}); }

    /// The same among those whose front looks to where \p normal does, by less than 90 degrees, no farther away than
    /// \p reach; none where there is none.
    Nearest Facing(const Eigen::Vector3d &p, const Eigen::Vector3d &normal, double reach) const {
        Nearest nearest;
        nearest.square = reach * reach;
        nearest.facing = &normal;
        return Find(p, -1, nearest);
    }

    /// Towards the front of a triangle, as long as twice its area.
    Eigen::Vector3d NormalOf(Index t) const {
        const auto &corners = triangle[std::size_t(t)];
        const Eigen::Vector3d a = position.col(corners[0]), b = position.col(corners[1]), c = position.col(corners[2]);
        return (b - a).cross(c - a);
    }
    double LongestEdgeOf(Index t) const {
        const auto &corners = triangle[std::size_t(t)];
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k)
            square = std::max(square, (position.col(corners[k]) - position.col(corners[(k + 1) % 3])).squaredNorm());
        return std::sqrt(square);
    }

  private:
    Nearest Find(const Eigen::Vector3d &p, Index begin, Nearest nearest) const {
        const Eigen::Vector3d q = (p - center) * scale;
        if (begin >= 0)
            Try(p, begin, nearest);
        if (q.squaredNorm() < 1e6)
            Search<float>(p, q, begin, nearest);
        else // single precision tells too little from there
            Search<double>(p, q, begin, nearest);
        return nearest;
    }

    static constexpr std::size_t wide = 4;
    /// Most triangles of a node with axes of its own. What holds more is hardly flat, and each level that has them
    /// makes a tree a seventh slower to build.
    static constexpr std::size_t flat = wide * wide * wide;
    static constexpr Index none = std::numeric_limits<Index>::max();

    /// Boxes of the children, from the middle of all triangles, in units of their radius. Those around few triangles
    /// are along axes of their own, in which these lie flat: seen from afar, a box that lies across a surface would
    /// stand for much that is nearer than its triangles are.
    struct Node {
        std::array<Eigen::Array<float, int(wide), 1>, 3> column; ///< of the rotation to those axes, and 0
        std::array<Eigen::Array<float, int(wide), 1>, 3> low, high;
        std::array<Index, wide> child; ///< a node, -1 - t for a triangle t, or none
    };

    Eigen::Vector3f Placed(Index slot) const { return ((position.col(slot) - center) * scale).cast<float>(); }

    Eigen::AlignedBox3f BoxOf(Index t) const {
        Eigen::AlignedBox3f box;
        for (Index i : triangle[std::size_t(t)])
            box.extend(Placed(i));
        return box;
    }

    /// The axes of triangles in which their corners lie flattest, as rows.
    Eigen::Matrix3f AxesOf(const Index *first, const Index *last) const {
        const Eigen::Vector3f origin = middle[std::size_t(*first)];
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
        for (const Index *t = first; t != last; ++t)
            for (Index i : triangle[std::size_t(*t)]) {
                const Eigen::Vector3f x = Placed(i) - origin;
                sum += x;
                squares += x * x.transpose();
            }
        squares -= sum * sum.transpose() / float(3 * (last - first));
        return SymmetricEigen(squares.cast<double>()).Vectors().transpose().cast<float>();
    }

    /// Divides the triangles along the longest side of the box of their middles.
    void Divide(Index *first, Index *at, Index *last) const {
        if (at >= last)
            return;
        Eigen::AlignedBox3f box;
        for (const Index *t = first; t != last; ++t)
            box.extend(middle[std::size_t(*t)]);
        int axis;
        box.sizes().maxCoeff(&axis);
        std::nth_element(first, at, last,
                         [&](Index a, Index b) { return middle[std::size_t(a)][axis] < middle[std::size_t(b)][axis]; });
    }

    /// How many nodes are around so many triangles, of which one alone has none.
    static std::size_t NodesAround(std::size_t triangles) {
        if (triangles < 2)
            return 0;
        const std::size_t part = PartOf(triangles);
        return 1 + triangles / part * ((part - 1) / (wide - 1)) + NodesAround(triangles % part);
    }
    /// How many triangles each child has, but the last one, so that nearly all nodes are full.
    static std::size_t PartOf(std::size_t triangles) {
        std::size_t part = 1;
        while (wide * part < triangles)
            part *= wide;
        return part;
    }

    /// Sets the nodes around these triangles, from number \p at on; theirs comes last. \return the triangles' box
    Eigen::AlignedBox3f Build(Index *first, Index *last, std::size_t at, unsigned threads) {
        const std::size_t count = std::size_t(last - first), part = PartOf(count);
        if (count < 1 << 15) // where threads would cost more than they save
            threads = 1;
        const auto to = [&](std::size_t k) { return first + std::min(k * part, count); };
        Divide(first, to(2), last);
        ParallelFor(threads, 2, 1, [&](std::size_t half, std::size_t) {
            Divide(to(2 * half), to(2 * half + 1), half == 0 ? to(2) : last);
        });
        std::array<Eigen::AlignedBox3f, wide> box;
        std::array<std::size_t, wide> end; // of each child's nodes; behind the last ones is this one
        for (std::size_t k = 0; k < wide; ++k)
            end[k] = at += NodesAround(std::size_t(to(k + 1) - to(k)));
        ParallelFor(threads, wide, 1, [&](std::size_t k, std::size_t) {
            if (to(k + 1) - to(k) == 1)
                box[k] = BoxOf(*to(k));
            else if (to(k) != to(k + 1))
                box[k] = Build(to(k), to(k + 1), end[k] - NodesAround(std::size_t(to(k + 1) - to(k))), threads);
        });
        Node &node = nodes[at];
        Eigen::AlignedBox3f all;
        for (const Eigen::AlignedBox3f &each : box)
            all.extend(each);
        Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();
        if (count <= flat) {
            axes = AxesOf(first, last);
            for (std::size_t k = 0; k < wide; ++k) {
                box[k].setEmpty();
                for (const Index *t = to(k); t != to(k + 1); ++t)
                    for (Index i : triangle[std::size_t(*t)])
                        box[k].extend(Eigen::Vector3f(axes * Placed(i)));
            }
        }
        for (int d = 0; d < 3; ++d)
            node.column[std::size_t(d)] << axes.col(d).array(), 0;
        for (std::size_t k = 0; k < wide; ++k) {
            const auto size = to(k + 1) - to(k);
            node.child[k] = size == 0 ? none : size == 1 ? -1 - *to(k) : Index(end[k]) - 1;
            for (std::size_t d = 0; d < 3; ++d) {
                node.low[d][Eigen::Index(k)] = box[k].min()[Eigen::Index(d)]; // of an empty box: farther than all
                node.high[d][Eigen::Index(k)] = box[k].max()[Eigen::Index(d)];
            }
        }
        return all;
    }

    /// A child and the square of how far it is at least, so that those of nearer ones are less.
    using Step = std::uint64_t;
    static Step StepTo(float square, Index child) {
        std::uint32_t bits; // of a number that is not negative, in its order
        std::memcpy(&bits, &square, sizeof bits);
        return Step(bits) << 32 | std::uint32_t(child);
    }
    static float SquareOf(Step step) {
        const auto bits = std::uint32_t(step >> 32);
        float square;
        std::memcpy(&square, &bits, sizeof square);
        return square;
    }

    /// Depth first, into the nearest box first.
    /// \param q p in the units of the boxes \param begin has been tried \param nearest in, out
    template <class Real>
    void Search(const Eigen::Vector3d &p, const Eigen::Vector3d &q, Index begin, Nearest &nearest) const {
        using Lanes = Eigen::Array<Real, int(wide), 1>;
        // What distances of boxes and triangles may be off by, in the units of the boxes: those, at most 1 from the
        // middle, are rounded to 2^-25 there, and turned in single precision, in which the axes are told, too; q and
        // the distance to a few of its last bits, triangles to a few of those of the coordinates.
        const double size = q.cwiseAbs().maxCoeff() + 1, epsilon = std::numeric_limits<Real>::epsilon();
        const double off =
            std::ldexp(1.0, -20) + 32 * epsilon * size + std::ldexp((largest + p.cwiseAbs().maxCoeff()) * scale, -46);
        const auto within = [&] { // the square of what a box may be away
            const double least = std::sqrt(nearest.square) * scale + off;
            return Real(std::min(least * least * (1 + 8 * epsilon), double(std::numeric_limits<Real>::max())));
        };
        Real bound = within();
        const Real mostSquare = std::numeric_limits<float>::max(),
                   rounded = 1 + 2 * std::numeric_limits<float>::epsilon();
        const std::array<Real, 3> at{Real(q[0]), Real(q[1]), Real(q[2])};
        std::array<Step, 64> next; // three more a level, of 16 at most, and those too far
        int count = 0;
        next[std::size_t(count++)] = StepTo(0, Index(nodes.size()) - 1);
        while (count > 0) {
            const Step step = next[std::size_t(--count)];
            if (Real(SquareOf(step)) > bound * rounded)
                continue;
            const auto child = Index(std::uint32_t(step));
            if (child < 0) {
                if (-1 - child != begin && Try(p, -1 - child, nearest))
                    bound = within();
                continue;
            }
            const Node &node = nodes[std::size_t(child)];
            const Lanes place = node.column[0].cast<Real>() * at[0] + node.column[1].cast<Real>() * at[1] +
                                node.column[2].cast<Real>() * at[2];
            Lanes square = Lanes::Zero();
            for (std::size_t d = 0; d < 3; ++d) {
                const Lanes along = Lanes::Constant(place[Eigen::Index(d)]);
                const Lanes beyond = (node.low[d].cast<Real>() - along).max(along - node.high[d].cast<Real>());
                square += beyond.max(Real(0)).square();
            }
            std::array<Step, wide> near;
            int found = 0;
            for (std::size_t k = 0; k < wide; ++k) {
                const Real each = square[Eigen::Index(k)];
                const int isNear = int(each <= bound) & int(node.child[k] != none);
                near[k] = StepTo(float(std::min(each, mostSquare)), node.child[k]) & (Step(0) - Step(isNear));
                found += isNear;
            }
            // Without a branch: which ones are near enough, and which of them first, a processor cannot foresee.
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
            // The nearest one comes last, but for those too far, which the next ones are written over.
            std::copy(near.begin(), near.end(), next.begin() + count);
            count += found;
        }
    }

    /// \return whether it is nearer
    bool Try(const Eigen::Vector3d &p, Index t, Nearest &nearest) const {
        const auto &corners = triangle[std::size_t(t)];
        const Eigen::Vector3d a = position.col(corners[0]), b = position.col(corners[1]), c = position.col(corners[2]);
        const Eigen::Vector3d weight = WeightsOfNearest(a, b, c, p);
        const double square = (a * weight[0] + b * weight[1] + c * weight[2] - p).squaredNorm();
        if (!(square < nearest.square || (square == nearest.square && t < nearest.triangle)))
            return false;
        if (nearest.facing && !((b - a).cross(c - a).dot(*nearest.facing) > 0))
            return false;
        nearest.triangle = t;
        nearest.weight = weight;
        nearest.square = square;
        return true;
    }

    const Eigen::Matrix3Xd &position;
    const std::vector<std::array<Index, 3>> triangle;
    std::vector<Eigen::Vector3f> middle; ///< of the triangles' boxes, while the tree is built
    std::vector<Node, Eigen::aligned_allocator<Node>> nodes;
    Eigen::Vector3d center;
    double scale = 1;   ///< of the triangles' coordinates to those of the boxes
    double largest = 0; ///< of the triangles' coordinates
};

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
