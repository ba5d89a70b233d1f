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

/// How many neighbours a point has: twice a triangulation's six, so that the Delaunay neighbours are among them even if
/// one direction is sampled two or three times as densely as the other.
constexpr int cloudNeighbours = 12;

/// Finds the neighbours of a cloud's points, one point at a time. It looks at more points until they lie on all sides.
/// In scan lines, which are denser along than across, the nearest points are on one line and tell nothing of the
/// surface.
template <class Scalar>
class CloudNeighbourhood {
  public:
    /// Points this many times nearer to each other than to the next point are a clump, which counts as one position. Of
    /// evenly random points, that happens to one in a thousand.
    static constexpr double apart = 30;
    /// The most points that are looked at. If lines are a times as dense along as across, points of the next line are
    /// among the nearest 4 a, and enough of them on all sides among 6 a. So this works for lines up to 30 times as
    /// dense.
    static constexpr std::size_t most = 192;

    explicit CloudNeighbourhood(const PointTree<Scalar> &points)
        : points(points), others(points.Size() - 1), inBlock(points), wideInBlock(points), alone(points) {}

    /// Looks around a point; sets around, isWide and isOneSided. \param place of the point, in the order of the blocks;
    /// fastest if ascending
    void Look(std::size_t place) {
        at = place;
        const std::size_t fewest = std::min<std::size_t>(cloudNeighbours, others), last = std::min(most, others);
        std::size_t wanted = fewest, first = 0; // the least number with points on all sides
        double reached = 0;
        Find(wanted);
        isOneSided = isWide = false;
        if (IsSurelyAcross()) // mostly
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
        if (reached < evenAcross && wanted > std::max(first, fewest)) { // a corner, or really a line
            wanted = std::max(first, fewest);
            Find(wanted);
        }
        isWide = wanted > fewest;
    }

    /// The neighbours of the point of Look, ascending; sets area and here. \param far looks for clumps of up to \p most
    /// points
    const std::vector<Index> &Neighbours(bool far = false) {
        double sum = 0;
        for (const Other &other : beside)
            sum += other.square;
        area = around.empty() ? 0 : sum * 2 * EIGEN_PI / (double(around.size()) * double(around.size() + 1));
        here = 0;
        double before = INFINITY;
        const auto step = [&](double square) {
            if (square > apart * apart * before)
                here = 1.001 * std::sqrt(before); // more than rounding
            before = square;
        };
        if (far) {
            const auto *nearest = Wide(most).Of(at);
            std::for_each(nearest, nearest + std::min(most, others), [&](const auto &o) { step(double(o.square)); });
        } else {
            for (const Other &other : beside)
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

    /// Calls body(number) for the points around within \p reach, the nearest first.
    template <class Body>
    void ForEachWithin(double reach, const Body &body) const {
        for (std::size_t k = 0; k < beside.size() && std::sqrt(beside[k].square) <= reach; ++k)
            body(beside[k].number);
    }

    std::vector<Index> around; ///< the points that were looked at, the nearest first
    bool isWide = false;       ///< more points than cloudNeighbours were looked at
    bool isOneSided = false;   ///< even the most points lie along a line
    // Set by Neighbours:
    double area = 0; ///< that the point stands for, 1 / density: in an evenly random set, the k-th smallest squared
                     ///< distance is k / (pi density) on average
    double here = 0; ///< the radius of the point's clump; 0: there is none

  private:
    /// The least Across() with which points count as on all sides. A line has 0; twelve random directions have less
    /// than this one time in a hundred; a corner of an evenly sampled sheet has (1 - 2 / pi) / (1 + 2 / pi) = 0.22, and
    /// keeps about the points that it has.
    static constexpr double leastAcross = 0.25;
    /// The same for more points than cloudNeighbours. A disc has 1, and so does half a disc at a border; points that
    /// hardly reach the next lines have about a half.
    static constexpr double evenAcross = 0.8;

    struct Other {
        double square; // of its distance
        Index number;
        Eigen::Vector3d offset; // from the point to this one
        bool operator<(const Other &o) const { return square != o.square ? square < o.square : number < o.number; }
    };

    void Find(std::size_t wanted) {
        const NearestOthers<Scalar> &nearest = wanted > std::size_t(cloudNeighbours) ? Wide(wanted) : Close(wanted);
        around.resize(std::min(wanted, others));
        beside.resize(around.size());
        const typename PointTree<Scalar>::Point x = points.At(at);
        const auto *each = nearest.Of(at);
        for (std::size_t k = 0; k < beside.size(); ++k, ++each) {
            const Eigen::Vector3d offset = (points.At(std::size_t(each->at)) - x).template cast<double>();
            around[k] = each->point;
            beside[k] = {offset.squaredNorm(), each->point, offset};
        }
    }

    const NearestOthers<Scalar> &Close(std::size_t wanted) {
        if (!inBlock.Knows(at, wanted)) {
            const std::size_t block = points.BlockOf(at);
            inBlock.Ask(points.Begin(block), points.Begin(block + 1), wanted);
        }
        return inBlock;
    }

    /// The \p wanted nearest points, more than cloudNeighbours. In most clouds few points need so many, and one point
    /// is searched for alone. In scan lines nearly all need them: so if the point before needed as many, the rest of
    /// its block is searched for at once.
    const NearestOthers<Scalar> &Wide(std::size_t wanted) {
        const std::size_t block = points.BlockOf(at);
        const bool follows = lastWide < at && points.BlockOf(lastWide) == block && lastWanted >= wanted;
        const bool isKnown = wideInBlock.Knows(at, wanted);
        if (!isKnown && follows)
            wideInBlock.Ask(at, points.Begin(block + 1), lastWanted);
        else if (!isKnown)
            alone.Ask(at, at + 1, wanted);
        lastWanted = lastWide == at ? std::max(lastWanted, wanted) : wanted;
        lastWide = at;
        return isKnown || follows ? wideInBlock : alone;
    }

    /// Whether Across() is at least leastAcross for sure. A quick test without the eigenvalues a <= b <= c: c is at
    /// most mean + 2 spread, and the sign of the characteristic polynomial at leastAcross times that tells if only a is
    /// below, as it mostly is.
    bool IsSurelyAcross() const {
        if (beside.size() != std::size_t(cloudNeighbours))
            return false;
        double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
        for (int k = 0; k < cloudNeighbours; ++k) {
            const double w = 1 / beside[k].square, x = beside[k].offset[0], y = beside[k].offset[1],
                         z = beside[k].offset[2];
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
        return polynomial < -1e-4 * (mean * mean * mean); // far more than rounding
    }

    /// Second moments of the directions to the points around.
    Eigen::Matrix3d Moments() const {
        Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
        for (const Other &other : beside)
            moments += other.offset * other.offset.transpose() / other.square;
        return moments;
    }

    /// The second moment of the directions across the main one, over that along it, in the plane that they lie in: 0
    /// for a line, 1 for a disc.
    double Across() const {
        const Eigen::Vector3d values = SymmetricEigen(Moments()).values;
        return around.empty() ? 1 : values[1] / values[2];
    }

    /// Chooses the point's Delaunay neighbours in its plane: the points whose bisector cuts its Voronoi cell. Then, up
    /// to \p wanted, the points whose bisectors come nearest to the cell (distance over the reach of the cell).
    void Choose(std::size_t wanted) {
        const Eigen::Matrix3d axes = SymmetricEigen(Moments()).Vectors();
        const Eigen::Vector3d along = axes.col(2), across = axes.col(1);
        std::sort(beside.begin(), beside.end());
        inPlane.clear();
        for (const Other &other : beside)
            inPlane.emplace_back(other.offset.dot(along), other.offset.dot(across));
        // Points farther away than the last one cut nothing of the square of half that distance.
        const double half = 0.5 * std::sqrt(beside.back().square);
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
            neighbour.push_back(beside[rank[k].second].number);
    }

    const PointTree<Scalar> &points;
    const std::size_t others;
    std::size_t at = 0;
    NearestOthers<Scalar> inBlock, wideInBlock, alone; ///< of all points of a block, the rest of one, and one point
    std::size_t lastWide = PointTree<Scalar>::none;    ///< the last point of Wide
    std::size_t lastWanted = 0;                        ///< the most that it asked for
    std::vector<Other> beside;                         ///< to the points around
    std::vector<Index> neighbour;
    std::vector<Eigen::Vector2d> inPlane, cell, cut;
    std::vector<std::pair<double, std::size_t>> rank;
};

} // namespace vcg::fcd::detail

#endif
