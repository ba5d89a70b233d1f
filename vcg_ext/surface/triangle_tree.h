// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/nearest_in_triangle.h>
#include <vcg_ext/surface/triangle_boxes.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

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
    /// \param triangle slots of the corners, at least one triangle \throw Cancelled
    TriangleTree(const Eigen::Matrix3Xd &position, std::vector<std::array<Index, 3>> given,
                 const Progress &progress = {})
        : position(position), triangle(std::move(given)), boxes(TriangleBoxing(position, triangle, progress).Take()) {}

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
    static constexpr std::size_t wide = TriangleBoxes::wide;
    using Space = TriangleBoxes::Space;

    Nearest Find(const Eigen::Vector3d &p, Index begin, Nearest nearest) const {
        if (begin >= 0)
            Try(p, begin, nearest);
        for (std::size_t tree = 0; tree < boxes.trees; ++tree)
            SearchIn(boxes.spaces[tree], p, begin, nearest);
        return nearest;
    }

    void SearchIn(const Space &space, const Eigen::Vector3d &p, Index begin, Nearest &nearest) const {
        const Eigen::Vector3d q = (p - space.center) * space.scale;
        if (q.squaredNorm() < 1e6)
            Search<float>(space, p, q, begin, nearest);
        else // single precision tells too little from there
            Search<double>(space, p, q, begin, nearest);
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
    void Search(const Space &space, const Eigen::Vector3d &p, const Eigen::Vector3d &q, Index begin,
                Nearest &nearest) const {
        using Lanes = Eigen::Array<Real, int(wide), 1>;
        // What distances of boxes and triangles may be off by, in the units of the boxes: those, at most 1 from the
        // middle, are rounded to 2^-25 there, and turned in single precision, in which the axes are told, too; q and
        // the distance to a few of its last bits, triangles to a few of those of the coordinates.
        const double size = q.cwiseAbs().maxCoeff() + 1, epsilon = std::numeric_limits<Real>::epsilon();
        const double off = std::ldexp(1.0, -20) + 32 * epsilon * size +
                           std::ldexp((space.largest + p.cwiseAbs().maxCoeff()) * space.scale, -46);
        const auto within = [&] { // the square of what a box may be away
            const double least = std::sqrt(nearest.square) * space.scale + off;
            return Real(std::min(least * least * (1 + 8 * epsilon), double(std::numeric_limits<Real>::max())));
        };
        Real bound = within();
        const Real mostSquare = std::numeric_limits<float>::max(),
                   rounded = 1 + 2 * std::numeric_limits<float>::epsilon();
        const std::array<Real, 3> at{Real(q[0]), Real(q[1]), Real(q[2])};
        std::array<Step, 64> next; // three more a level, of 16 at most, and those too far
        int count = 0;
        next[std::size_t(count++)] = StepTo(0, space.root);
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
            if (std::size_t(child) >= boxes.nodes.size()) {
                SearchIn(boxes.spaces[std::size_t(child) - boxes.nodes.size()], p, begin, nearest);
                bound = within();
                continue;
            }
            const TriangleBoxes::Node &node = boxes.nodes[std::size_t(child)];
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
                const int isNear = int(each <= bound) & int(node.child[k] != TriangleBoxes::none);
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
    const TriangleBoxes boxes;
};

} // namespace vcg::fcd::detail
