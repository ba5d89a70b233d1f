// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/base/symmetric_eigen.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// The boxes of a TriangleTree, around four boxes or triangles each.
struct TriangleBoxes {
    static constexpr std::size_t wide = 4;
    static constexpr Index none = std::numeric_limits<Index>::max();

    /// Boxes of the children, in the units of their space. Those around few triangles are along axes of their own, in
    /// which these lie flat: seen from afar, a box that lies across a surface would stand for much that is nearer than
    /// its triangles are.
    struct Node {
        std::array<Eigen::Array<float, int(wide), 1>, 3> column; ///< of the rotation to those axes, and 0
        std::array<Eigen::Array<float, int(wide), 1>, 3> low, high;
        std::array<Index, wide> child; ///< a node; -1 - t: triangle t; as many as there are nodes + s: space s; or none
    };

    /// In which single precision tells boxes: from the middle of some triangles, in units of their radius. Those that
    /// are small beside all of them, as a surface is beside a triangle far away, have a space of their own.
    struct Space {
        Eigen::Vector3d center;
        double scale;   ///< of the triangles' coordinates to those of the boxes
        double largest; ///< of the triangles' coordinates
        Index root;     ///< the node around all of them

        Space(const Eigen::AlignedBox3d &box, Index root)
            : center(0.5 * box.min() + 0.5 * box.max()),
              largest(box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff()), root(root) {
            const double radius = 0.5 * box.sizes().norm();
            scale = radius > 1e-50 ? 1 / radius : 1; // a single point has none; no square of a distance is infinite
        }
    };

    std::vector<Node, Eigen::aligned_allocator<Node>> nodes;
    std::deque<Space> spaces; ///< first those of trees
    std::size_t trees = 0;    ///< more than one where some triangles are far from the others
};

/// Puts triangles into boxes.
class TriangleBoxing {
  public:
    /// \param position, triangle as of TriangleTree \throw Cancelled
    TriangleBoxing(const Eigen::Matrix3Xd &position, const std::vector<std::array<Index, 3>> &triangle,
                   const Progress &progress)
        : position(position), triangle(triangle), middle(triangle.size()) {
        const std::size_t grain = 1 << 14;
        ParallelFor(progress.Slice(0, 0.1), stage, triangle.size(), grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t t = first; t < last; ++t) {
                const Eigen::AlignedBox3d box = BoxOf(Index(t));
                middle[t] = 0.5 * box.min() + 0.5 * box.max();
            }
        });
        std::vector<Index> order(triangle.size());
        std::iota(order.begin(), order.end(), 0);
        const std::vector<std::size_t> trees = WithoutStrays(order);
        std::size_t count = 0;
        for (std::size_t tree = 0; tree + 1 < trees.size(); ++tree) {
            Eigen::AlignedBox3d box;
            for (std::size_t i = trees[tree]; i < trees[tree + 1]; ++i)
                box.extend(BoxOf(order[i]));
            count += std::max<std::size_t>(1, NodesAround(trees[tree + 1] - trees[tree]));
            made.spaces.emplace_back(box, Index(count) - 1);
        }
        made.trees = trees.size() - 1;
        made.nodes.reserve(count);
        PreferLargePages(made.nodes.data(), count * sizeof(Node));
        made.nodes.resize(count);
        Progress building = progress.Slice(0.1, 1);
        building.threads = ThreadsFor(progress.threads);
        for (std::size_t tree = 0, at = 0; tree < made.trees; at = std::size_t(made.spaces[tree++].root) + 1)
            Build(order.data() + trees[tree], order.data() + trees[tree + 1], at, SpaceAt(tree),
                  building.Slice(tree > 0, 1));
    }

    TriangleBoxes Take() { return std::move(made); }

  private:
    using Node = TriangleBoxes::Node;
    using Space = TriangleBoxes::Space;
    static constexpr std::size_t wide = TriangleBoxes::wide;
    static constexpr const char *stage = "Sorting the triangles";
    /// Most triangles of a node with axes of its own. What holds more is hardly flat, and each level that has them
    /// makes a tree a seventh slower to build. Nor have so few a space of their own: they are looked at as soon.
    static constexpr std::size_t flat = wide * wide * wide;
    /// What is smaller than this share of a space has one of its own. The edges of more triangles than `flat` that fill
    /// it are an eighth of it, hundred times what the boxes' distances may be off by.
    static constexpr double small = 1.0 / 1024;

    /// Puts triangles far outside of all others behind these, and those of them that are far outside of their others
    /// behind these: each time, four fifths and more stay. \return where what is together begins in \p order, and its
    /// end
    std::vector<std::size_t> WithoutStrays(std::vector<Index> &order) const {
        std::vector<std::size_t> begin{0};
        while (begin.back() < order.size()) {
            Index *const first = order.data() + begin.back(), *const last = order.data() + order.size();
            const Eigen::AlignedBox3d core =
                detail::WithoutStrays(BoxOfMiddles(first, last), std::size_t(last - first),
                                      [&](std::size_t i) { return middle[std::size_t(first[i])]; });
            const auto stays = [&](Index t) { return core.contains(middle[std::size_t(t)]); };
            const Index *const end = std::size_t(last - first) <= flat ? last : std::partition(first, last, stays);
            begin.push_back(end == first ? order.size() : std::size_t(end - order.data()));
        }
        return begin;
    }

    struct Built {
        Eigen::AlignedBox3d box; // of the corners
        Index child;             // how a node's child stands for them
    };

    static Eigen::Vector3f Placed(const Eigen::Vector3d &p, const Space &space) {
        return ((p - space.center) * space.scale).cast<float>();
    }

    Eigen::AlignedBox3d BoxOf(Index t) const {
        Eigen::AlignedBox3d box;
        for (Index i : triangle[std::size_t(t)])
            box.extend(Eigen::Vector3d(position.col(i)));
        return box;
    }

    Eigen::AlignedBox3d BoxOfMiddles(const Index *first, const Index *last) const {
        Eigen::AlignedBox3d box;
        for (const Index *t = first; t != last; ++t)
            box.extend(middle[std::size_t(*t)]);
        return box;
    }

    /// The axes of triangles in which their corners lie flattest, as rows.
    Eigen::Matrix3f AxesOf(const Index *first, const Index *last, const Space &space) const {
        const Eigen::Vector3f origin = Placed(middle[std::size_t(*first)], space);
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
        for (const Index *t = first; t != last; ++t)
            for (Index i : triangle[std::size_t(*t)]) {
                const Eigen::Vector3f x = Placed(position.col(i), space) - origin;
                sum += x;
                squares += x * x.transpose();
            }
        squares -= sum * sum.transpose() / float(3 * (last - first));
        return SymmetricEigen(squares.cast<double>()).Vectors().transpose().cast<float>();
    }

    /// Divides triangles along the longest side of the box of their middles.
    void Divide(Index *first, Index *at, Index *last, const Eigen::AlignedBox3d &box) const {
        if (at >= last)
            return;
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

    /// The number of a space of their own for triangles in \p around; 0: none. \param box of their middles
    std::size_t SpaceFor(const Index *first, const Index *last, Eigen::AlignedBox3d box, const Space &around,
                         Index root) {
        const auto isSmall = [&] { return 0.5 * box.sizes().norm() * around.scale < small; };
        if (std::size_t(last - first) <= flat || !isSmall())
            return 0;
        for (const Index *t = first; t != last; ++t)
            box.extend(BoxOf(*t));
        if (!isSmall() || !(box.sizes().norm() > 1e-50))
            return 0;
        const std::lock_guard<std::mutex> guard(lock);
        made.spaces.emplace_back(box, root);
        return made.spaces.size() - 1;
    }

    const Space &SpaceAt(std::size_t number) {
        const std::lock_guard<std::mutex> guard(lock);
        return made.spaces[number]; // which stays where it is
    }

    /// Sets the nodes around these triangles, from number \p at on; theirs comes last.
    Built Build(Index *const first, Index *last, std::size_t at, const Space &around, const Progress &progress) {
        const std::size_t count = std::size_t(last - first), part = PartOf(count);
        if (count >= 1 << 12)
            progress(0, stage);
        const Eigen::AlignedBox3d middles = BoxOfMiddles(first, last);
        const std::size_t number = SpaceFor(first, last, middles, around, Index(at + NodesAround(count)) - 1);
        const Space &space = number > 0 ? SpaceAt(number) : around;
        Progress child = progress;
        if (count < 1 << 15) // where threads would cost more than they save
            child.threads = 1;
        const Progress both = child;
        child.threads = std::max(1u, child.threads / unsigned(wide));
        const auto to = [&](std::size_t k) { return first + std::min(k * part, count); };
        Divide(first, to(2), last, middles);
        ParallelFor(both.threads, 2, 1, [&](std::size_t half, std::size_t) {
            Index *const end = half == 0 ? to(2) : last;
            if (to(2 * half + 1) < end)
                Divide(to(2 * half), to(2 * half + 1), end, BoxOfMiddles(to(2 * half), end));
        });
        std::array<std::size_t, wide> begin; // of each child's nodes; behind the last ones is this one
        for (std::size_t k = 0; k < wide; ++k) {
            begin[k] = at;
            at += NodesAround(std::size_t(to(k + 1) - to(k)));
        }
        std::array<Built, wide> built;
        ParallelTasks(both, stage, wide, [&](std::size_t k, const Progress &shared) {
            built[k].child = TriangleBoxes::none;
            if (to(k) == to(k + 1))
                return;
            if (to(k) + 1 == to(k + 1)) {
                built[k] = {BoxOf(*to(k)), -1 - *to(k)};
                return;
            }
            Progress its = shared;
            its.threads = child.threads;
            built[k] = Build(to(k), to(k + 1), begin[k], space, its);
        });
        Built all;
        for (const Built &each : built)
            all.box.extend(each.box);
        all.child = Index(number > 0 ? made.nodes.size() + number : at);
        SetNode(made.nodes[at], built, to, space, count <= flat);
        return all;
    }

    /// \param to to(k): the first triangle of child k
    template <class To>
    void SetNode(Node &node, const std::array<Built, wide> &built, const To &to, const Space &space,
                 bool hasAxes) const {
        const Eigen::Matrix3f axes =
            hasAxes ? AxesOf(to(0), to(wide), space) : Eigen::Matrix3f(Eigen::Matrix3f::Identity());
        for (int d = 0; d < 3; ++d)
            node.column[std::size_t(d)] << axes.col(d).array(), 0;
        for (std::size_t k = 0; k < wide; ++k) {
            Eigen::AlignedBox3f box; // an empty one is farther than all
            if (hasAxes)
                for (const Index *t = to(k); t != to(k + 1); ++t)
                    for (Index i : triangle[std::size_t(*t)])
                        box.extend(Eigen::Vector3f(axes * Placed(position.col(i), space)));
            else if (!built[k].box.isEmpty())
                box = {Placed(built[k].box.min(), space), Placed(built[k].box.max(), space)};
            node.child[k] = built[k].child;
            for (std::size_t d = 0; d < 3; ++d) {
                node.low[d][Eigen::Index(k)] = box.min()[Eigen::Index(d)];
                node.high[d][Eigen::Index(k)] = box.max()[Eigen::Index(d)];
            }
        }
    }

    const Eigen::Matrix3Xd &position;
    const std::vector<std::array<Index, 3>> &triangle;
    std::vector<Eigen::Vector3d> middle; ///< of the triangles' boxes
    TriangleBoxes made;
    std::mutex lock; ///< of its spaces
};

} // namespace vcg::fcd::detail
