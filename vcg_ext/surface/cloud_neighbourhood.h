// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CLOUD_NEIGHBOURHOOD_H
#define VCG_FCD_CLOUD_NEIGHBOURHOOD_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/nearest_others.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/symmetric_eigen.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// How many neighbours a point has: twice a triangulation's six, so that those of the Delaunay triangulation are among
/// them where one direction is sampled two or three times as densely as the other.
constexpr int cloudNeighbours = 12;

/// The points around those of a set, one after the other: so many that they lie to all sides of it. Of scan lines,
/// which are sampled more densely along than across, the nearest ones are on one line and tell nothing of the surface.
template <class Scalar>
class CloudNeighbourhood {
  public:
    /// Points that are so much nearer to each other than to the next one are at one place. Among points that are evenly
    /// at random that is so at one in a thousand.
    static constexpr double apart = 30;
    /// Points that are looked at. Of lines that are sampled a times as densely along as across, the next ones are among
    /// the nearest 4 a, and there are enough of them on all sides among 6 a: lines up to 30 times as dense.
    static constexpr std::size_t most = 192;

    explicit CloudNeighbourhood(const PointTree<Scalar> &points)
        : points(points), others(points.Size() - 1), inBlock(points), alone(points) {}

    /// \param place of a point in the order of the blocks; one after the other is fastest
    void Look(std::size_t place) {
        at = place;
        const std::size_t fewest = std::min<std::size_t>(cloudNeighbours, others), last = std::min(most, others);
        std::size_t wanted = fewest, first = 0; // that is enough
        double reached = 0;
        Find(wanted);
        isOneSided = isWide = false;
        if (IsSurelyAcross()) // as mostly
            return;
        for (;; wanted = std::min(4 * wanted, last)) {
            if (wanted > fewest)
                Find(wanted);
            reached = Across();
            if (!first && reached >= leastAcross)
                first = wanted;
            if (first == fewest || reached >= evenAcross || wanted == last)
                break;
        }
        isOneSided = !first && last == most;
        if (reached < evenAcross && wanted > std::max(first, fewest)) { // a corner, or a line indeed
            wanted = std::max(first, fewest);
            Find(wanted);
        }
        isWide = wanted > fewest;
    }

    /// Which of the points around are neighbours, ascending, and what is told with them.
    /// \param far clumps may be of more points than are looked at
    const std::vector<Index> &Neighbours(bool far = false) {
        double sum = 0;
        for (const Other &other : ways)
            sum += other.square;
        area = around.empty() ? 0 : sum * 2 * EIGEN_PI / (double(around.size()) * double(around.size() + 1));
        here = 0;
        double before = INFINITY;
        const auto step = [&](double square) {
            if (square > apart * apart * before)
                here = 1.001 * std::sqrt(before); // which floats round
            before = square;
        };
        if (far) {
            alone.Ask(at, at + 1, most);
            std::for_each(alone.Of(at), alone.Of(at) + alone.Each(), [&](const auto &o) { step(double(o.square)); });
        } else {
            for (const Other &other : ways)
                step(other.square);
        }
        if (around.size() == std::size_t(cloudNeighbours)) {
            neighbour.resize(cloudNeighbours);
            SortDiffering<cloudNeighbours>(around.data(), neighbour.data());
            return neighbour;
        }
        neighbour.clear();
        if (isWide)
            Choose(cloudNeighbours);
        else
            neighbour = around;
        std::sort(neighbour.begin(), neighbour.end());
        return neighbour;
    }

    /// Those of the points around that are no farther away than \p reach, the nearest first.
    template <class Body>
    void ForEachWithin(double reach, const Body &body) const {
        for (std::size_t k = 0; k < ways.size() && std::sqrt(ways[k].square) <= reach; ++k)
            body(ways[k].number);
    }

    std::vector<Index> around; ///< all that were looked at, the nearest first
    bool isWide = false;       ///< more than neighbours were looked at
    bool isOneSided = false;   ///< all that can be looked at lie along a line
    // Known with the neighbours:
    double area = 0; ///< that the point stands for: that of a point of an evenly random set of the density around it,
                     ///< where the k-th nearest of the others is at k / (pi density) squared on average
    double here = 0; ///< points that are no farther away are at the same place

  private:
    /// Least share of the directions' second moments across, of those along: twelve directions by chance have less one
    /// time in a hundred, a line 0; a corner of an evenly sampled sheet has (1 - 2 / pi) / (1 + 2 / pi) = 0.22, and
    /// keeps about the points that it has.
    static constexpr double leastAcross = 0.25;
    /// The same of more points than neighbours: a disc has 1, and half of it at a border, too; one that only just
    /// touches the next lines has about a half.
    static constexpr double evenAcross = 0.8;

    struct Other {
        double square; // of its distance
        Index number;
        Eigen::Vector3d way;
        bool operator<(const Other &o) const { return square != o.square ? square < o.square : number < o.number; }
    };

    void Find(std::size_t wanted) {
        const bool isFirst = wanted <= std::size_t(cloudNeighbours);
        NearestOthers<Scalar> &nearest = isFirst ? inBlock : alone;
        if (!isFirst) {
            alone.Ask(at, at + 1, wanted);
        } else if (!inBlock.Knows(at, wanted)) {
            const std::size_t block = points.BlockOf(at);
            inBlock.Ask(points.Begin(block), points.Begin(block + 1), wanted);
        }
        around.resize(nearest.Each());
        ways.resize(nearest.Each());
        const typename PointTree<Scalar>::Point x = points.At(at);
        const auto *each = nearest.Of(at);
        for (std::size_t k = 0; k < ways.size(); ++k, ++each) {
            const Eigen::Vector3d way = (points.At(std::size_t(each->at)) - x).template cast<double>();
            around[k] = each->point;
            ways[k] = {way.squaredNorm(), each->point, way};
        }
    }

    /// Whether Across() is at least leastAcross for sure, without the eigenvalues a, b, c, ascending: none of them is
    /// above the one that the moments would have if a and b were equal. If b is above leastAcross times that, and a is
    /// not, as mostly, the characteristic polynomial tells it.
    bool IsSurelyAcross() const {
        if (ways.size() != std::size_t(cloudNeighbours))
            return false;
        double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
        for (int k = 0; k < cloudNeighbours; ++k) {
            const double w = 1 / ways[k].square, x = ways[k].way[0], y = ways[k].way[1], z = ways[k].way[2];
            const double wx = w * x, wy = w * y, wz = w * z;
            xx += wx * x;
            yy += wy * y;
            zz += wz * z;
            xy += wx * y;
            xz += wx * z;
            yz += wy * z;
        }
        const double mean = (xx + yy + zz) / 3;
        xx -= mean;
        yy -= mean;
        zz -= mean;
        const double spread = std::sqrt((xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz)) / 6);
        const double from = mean - leastAcross * (mean + 2 * spread);
        xx += from;
        yy += from;
        zz += from;
        const double polynomial = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
        return polynomial < -1e-4 * (mean * mean * mean); // what is rounded is far less
    }

    Eigen::Matrix3d Moments() const {
        Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
        for (const Other &other : ways)
            moments += other.way * other.way.transpose() / other.square;
        return moments;
    }

    /// The share of the directions' second moments across, in the plane that they lie in.
    double Across() const {
        const Eigen::Vector3d values = SymmetricEigen(Moments()).values;
        return around.empty() ? 1 : values[1] / values[2];
    }

    /// Takes the points that are neighbours in the plane's Delaunay triangulation, and those that come nearest to that:
    /// whose bisector cuts the point's Voronoi cell, or passes it by as the smallest share of the way.
    void Choose(std::size_t wanted) {
        const Eigen::Matrix3d axes = SymmetricEigen(Moments()).Vectors();
        const Eigen::Vector3d along = axes.col(2), across = axes.col(1);
        std::sort(ways.begin(), ways.end());
        inPlane.clear();
        for (const Other &other : ways)
            inPlane.emplace_back(other.way.dot(along), other.way.dot(across));
        // No point farther away than the last one cuts what is nearer than half of that.
        const double half = 0.5 * std::sqrt(ways.back().square);
        cell.assign({{half, half}, {-half, half}, {-half, -half}, {half, -half}});
        for (const Eigen::Vector2d &o : inPlane) {
            const auto beyond = [&](const Eigen::Vector2d &p) { return p.dot(o) - 0.5 * o.squaredNorm(); };
            cut.clear();
            for (std::size_t k = 0; k < cell.size(); ++k) {
                const Eigen::Vector2d &p = cell[k], &q = cell[(k + 1) % cell.size()];
                const double a = beyond(p), b = beyond(q);
                if (a <= 0)
                    cut.push_back(p);
                if ((a < 0 && b > 0) || (a > 0 && b < 0))
                    cut.emplace_back(p + (q - p) * (a / (a - b)));
            }
            if (cut.size() > 2)
                cell.swap(cut);
        }
        rank.clear();
        for (std::size_t k = 0; k < inPlane.size(); ++k) {
            double reach = 0;
            for (const Eigen::Vector2d &p : cell)
                reach = std::max(reach, p.dot(inPlane[k]));
            rank.emplace_back(reach > 0 ? inPlane[k].squaredNorm() / reach : INFINITY, k);
        }
        std::sort(rank.begin(), rank.end());
        for (std::size_t k = 0; k < wanted; ++k)
            neighbour.push_back(ways[rank[k].second].number);
    }

    const PointTree<Scalar> &points;
    const std::size_t others;
    std::size_t at = 0;
    NearestOthers<Scalar> inBlock, alone; ///< of all points of a block, and of one
    std::vector<Other> ways;              ///< to those around
    std::vector<Index> neighbour;
    std::vector<Eigen::Vector2d> inPlane, cell, cut;
    std::vector<std::pair<double, std::size_t>> rank;
};

} // namespace vcg::fcd::detail

#endif
