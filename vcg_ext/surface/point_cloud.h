// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_POINT_CLOUD_H
#define VCG_FCD_POINT_CLOUD_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/triangle_graph.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace vcg {
namespace fcd {
namespace detail {

/// How many neighbours a point has: twice a triangulation's six, so that those of the Delaunay triangulation are among
/// them where one direction is sampled two or three times as densely as the other.
constexpr int cloudNeighbours = 12;

/// The points around one of a set, so many that they lie to all sides of it: of scan lines, which are sampled more
/// densely along than across, the nearest ones are on one line and tell nothing of the surface.
template <class Scalar>
class CloudNeighbourhood {
  public:
    using Point = typename PointTree<Scalar>::Point;
    /// Points that are so much nearer to each other than to the next one are at one place. Among points that are evenly
    /// at random that is so at one in a thousand.
    static constexpr double apart = 30;

    /// \param at at(i): the i-th of the tree's points; they lie at different places
    template <class At>
    CloudNeighbourhood(const PointTree<Scalar> &tree, std::size_t points, std::size_t i, const At &at) : x(at(i)) {
        const std::size_t others = points - 1, fewest = std::min<std::size_t>(cloudNeighbours, others);
        const std::size_t last = std::min(most, others);
        std::size_t wanted = fewest, first = 0; // that is enough
        double reached = 0;
        for (;; wanted = std::min(4 * wanted, last)) {
            Find(tree, i, wanted);
            reached = Across(at);
            if (!first && reached >= leastAcross)
                first = wanted;
            if (first == fewest || reached >= evenAcross || wanted == last)
                break;
        }
        if (reached < evenAcross && wanted > std::max(first, fewest)) { // a corner, or a line indeed
            wanted = std::max(first, fewest);
            Find(tree, i, wanted);
            Across(at);
        }
        isWide = wanted > fewest;
    }

    /// Which of the points around are neighbours, ascending, and what is told with them.
    /// \param far the tree, where clumps may be of more points than are looked at; or null
    template <class At>
    std::vector<Index> Neighbours(const At &at, const PointTree<Scalar> *far = nullptr) {
        neighbour.clear();
        if (isWide)
            Choose(at, cloudNeighbours);
        else
            neighbour = around;
        std::sort(neighbour.begin(), neighbour.end());
        std::vector<double> distance;
        if (far) {
            far->Nearest(x, most + 1, found);
            for (const auto &each : found)
                if (each.square > 0)
                    distance.push_back(std::sqrt(double(each.square)));
        } else {
            for (Index j : around)
                distance.push_back((at(std::size_t(j)) - x).template cast<double>().norm());
        }
        std::sort(distance.begin(), distance.end());
        for (std::size_t k = 1; k < distance.size(); ++k)
            if (distance[k] > apart * distance[k - 1])
                here = 1.001 * distance[k - 1]; // which floats round
        return std::move(neighbour);
    }

    std::vector<Index> around; ///< all that were looked at
    bool isWide;               ///< more than neighbours were looked at
    // Known with the neighbours:
    double area = 0; ///< that the point stands for, as of CloudAreas; only where more were looked at
    double here = 0; ///< points that are no farther away are at the same place

  private:
    /// Points that are looked at. Of lines that are sampled a times as densely along as across, the next ones are among
    /// the nearest 4 a, and there are enough of them on all sides among 6 a: lines up to 30 times as dense.
    static constexpr std::size_t most = 192;
    /// Least share of the directions' second moments across, of those along: twelve directions by chance have less one
    /// time in a hundred, a line 0; a corner of an evenly sampled sheet has (1 - 2 / pi) / (1 + 2 / pi) = 0.22, and
    /// keeps about the points that it has.
    static constexpr double leastAcross = 0.25;
    /// The same of more points than neighbours: a disc has 1, and half of it at a border, too; one that only just
    /// touches the next lines has about a half.
    static constexpr double evenAcross = 0.8;

    void Find(const PointTree<Scalar> &tree, std::size_t i, std::size_t wanted) {
        tree.Nearest(x, wanted + 1, found);
        around.clear();
        for (const auto &each : found)
            if (each.point != Index(i))
                around.push_back(each.point);
    }

    /// Sets the plane that the directions to the points around lie in. \return the share of their second moments across
    template <class At>
    double Across(const At &at) {
        Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
        for (Index j : around) {
            const Eigen::Vector3d way = (at(std::size_t(j)) - x).template cast<double>();
            moments += way * way.transpose() / way.squaredNorm();
        }
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
        solver.computeDirect(moments);
        along = solver.eigenvectors().col(2);
        across = solver.eigenvectors().col(1);
        return around.empty() ? 1 : solver.eigenvalues()[1] / solver.eigenvalues()[2];
    }

    /// Takes the points that are neighbours in the plane's Delaunay triangulation, and those that come nearest to that:
    /// whose bisector cuts the point's Voronoi cell, or passes it by as the smallest share of the way.
    template <class At>
    void Choose(const At &at, std::size_t wanted) {
        struct Other {
            double square; // of its distance
            Index number;
            Eigen::Vector2d way;
            bool operator<(const Other &o) const { return square != o.square ? square < o.square : number < o.number; }
        };
        std::vector<Other> others;
        double sum = 0;
        for (Index j : around) {
            const Eigen::Vector3d way = (at(std::size_t(j)) - x).template cast<double>();
            others.push_back({way.squaredNorm(), j, {way.dot(along), way.dot(across)}});
            sum += way.squaredNorm();
        }
        std::sort(others.begin(), others.end());
        area = sum * 2 * EIGEN_PI / (double(around.size()) * double(around.size() + 1));
        // No point farther away than the last one cuts what is nearer than half of that.
        const double half = 0.5 * std::sqrt(others.back().square);
        std::vector<Eigen::Vector2d> cell{{half, half}, {-half, half}, {-half, -half}, {half, -half}}, cut;
        for (const Other &o : others) {
            const auto beyond = [&](const Eigen::Vector2d &p) { return p.dot(o.way) - 0.5 * o.way.squaredNorm(); };
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
        std::vector<std::pair<double, std::size_t>> rank;
        for (std::size_t k = 0; k < others.size(); ++k) {
            double reach = 0;
            for (const Eigen::Vector2d &p : cell)
                reach = std::max(reach, p.dot(others[k].way));
            rank.emplace_back(reach > 0 ? others[k].way.squaredNorm() / reach : INFINITY, k);
        }
        std::sort(rank.begin(), rank.end());
        for (std::size_t k = 0; k < wanted; ++k)
            neighbour.push_back(others[rank[k].second].number);
    }

    std::vector<Index> neighbour;
    const Point x;
    std::vector<typename PointTree<Scalar>::Found> found;
    Eigen::Vector3d along, across;
};

/// The neighbours of a cloud's points.
struct CloudPairs {
    TriangleList list;       ///< triangles with a repeated corner that join each point with its neighbours
    std::vector<float> area; ///< of points that have more around them than neighbours; 0 for others
    std::vector<std::pair<Index, Index>> same; ///< at one place, the smaller first
    std::size_t inClumps = 0;                  ///< points that are much nearer to others than these to the next ones
};

/// \pre points that are near have numbers that are close (Morton order), for speed \param hair units of positions
/// \param clumps as CloudNeighbourhood finds them are at one place, of any number of points
inline CloudPairs PairNeighbours(const Eigen::Matrix3Xf &position, float hair, bool clumps, const Progress &progress) {
    const Index n = Index(position.cols());
    const std::unique_ptr<PointTree<float>> tree = TreeOf(position);
    const int wanted = std::min<int>(cloudNeighbours, n - 1);
    const std::size_t grain = 1 << 12;
    CloudPairs pairs;
    pairs.list.count = std::size_t(n) * wanted;
    pairs.list.corner = LargeArray<Index>(3 * pairs.list.count);
    AssignLarge(pairs.area, std::size_t(n), 0.f);
    std::vector<std::vector<std::pair<Index, Index>>> same((std::size_t(n) + grain - 1) / grain);
    std::vector<std::size_t> inClumps(same.size(), 0);
    const auto at = [&](std::size_t i) { return Eigen::Vector3f(position.col(Eigen::Index(i))); };
    ParallelFor(progress, "Finding neighbours", n, grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            CloudNeighbourhood<float> found(*tree, std::size_t(n), i, at);
            const std::vector<Index> neighbours = found.Neighbours(at, clumps ? tree.get() : nullptr);
            if (found.isWide)
                pairs.area[i] = float(found.area);
            Index *to = pairs.list.corner.get() + i * wanted * 3;
            for (int j = 0; j < wanted; ++j, to += 3) {
                to[0] = Index(i);
                to[1] = to[2] = j < int(neighbours.size()) ? neighbours[std::size_t(j)] : Index(i);
            }
            inClumps[first / grain] += found.here > 0;
            const double reach = std::max(double(hair), clumps ? found.here : 0);
            for (Index j : found.around)
                if ((at(std::size_t(j)) - at(i)).cast<double>().norm() <= reach)
                    same[first / grain].emplace_back(std::minmax(Index(i), j));
        }
    });
    pairs.inClumps = std::accumulate(inClumps.begin(), inClumps.end(), std::size_t(0));
    for (const auto &each : same)
        pairs.same.insert(pairs.same.end(), each.begin(), each.end());
    return pairs;
}

/// Where most of a cloud's points are in clumps, each without a neighbour outside of it and much smaller than the way
/// to the next one, the points of these as pairs at one place; else none: parts of a cloud that lie apart are no
/// clumps.
inline std::vector<std::pair<Index, Index>> ClumpsOf(const Eigen::Matrix3Xf &position, const TriangleList &list,
                                                     const Progress &progress) {
    const Index n = Index(position.cols());
    std::vector<Index> first(n); // of its component
    std::iota(first.begin(), first.end(), 0);
    const auto root = [&](Index u) {
        while (first[u] != u)
            u = first[u] = first[first[u]];
        return u;
    };
    for (const Index *c = list.corner.get(); c < list.corner.get() + 3 * list.count; c += 3) {
        const Index a = root(c[0]), b = root(c[1]);
        first[std::max(a, b)] = std::min(a, b);
    }
    std::vector<std::pair<Index, Index>> same;
    std::vector<Eigen::AlignedBox3f> box;
    std::vector<Index> alone; // the first node of each component
    for (bool isNew = true; isNew;) {
        alone.clear();
        box.assign(n, Eigen::AlignedBox3f());
        for (Index u = 0; u < n; ++u) {
            if (root(u) == u)
                alone.push_back(u);
            box[root(u)].extend(Eigen::Vector3f(position.col(u)));
        }
        if (alone.size() < 2)
            return same;
        progress(0.45, "Finding neighbours");
        const std::unique_ptr<PointTree<float>> tree = TreeOf(position, alone);
        std::vector<PointTree<float>::Found> nearest;
        isNew = false;
        std::vector<char> isClump(n, 0);
        for (Index u : alone) {
            tree->Nearest(position.col(u), 2, nearest);
            for (const auto &each : nearest) {
                const Index v = alone[std::size_t(each.point)];
                if (v == u)
                    continue;
                const double sizes = double(box[u].diagonal().norm()) + double(box[v].diagonal().norm());
                isClump[u] = sizes * CloudNeighbourhood<float>::apart <= std::sqrt(double(each.square));
                if (std::sqrt(double(each.square)) <= sizes && root(u) != root(v)) { // two halves of one
                    first[std::max(root(u), root(v))] = std::min(root(u), root(v));
                    isNew = true;
                }
            }
        }
        if (!isNew)
            for (Index u : alone)
                if (isClump[u])
                    box[u].setEmpty();
    }
    for (Index u = 0; u < n; ++u)
        if (const Index a = root(u); a != u && box[a].isEmpty())
            same.emplace_back(a, u);
    if (2 * same.size() < std::size_t(n))
        same.clear();
    return same;
}

/// The area that each point of a cloud stands for: that of a point of an evenly random set of the density around it,
/// where the k-th nearest of the others is at k / (pi density) squared on average. Held points, of whose neighbours
/// only those beside free ones are known, have none. \param tag as of SurfaceGraph \param known as of CloudPairs
inline void CloudAreas(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &known,
                       unsigned threads, std::vector<float> &area) {
    ParallelFor(threads, graph.Size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        std::vector<float> squares;
        for (std::size_t u = first; u < last; ++u) {
            squares.clear();
            if (!tag.empty() && tag[u] != 1) {
                area[u] = 0;
                continue;
            }
            if (known[u] > 0) {
                area[u] = known[u];
                continue;
            }
            for (Index v : graph.adjacency[Index(u)])
                squares.push_back((graph.position.col(v) - graph.position.col(u)).squaredNorm());
            std::sort(squares.begin(), squares.end());
            squares.resize(std::min<std::size_t>(squares.size(), cloudNeighbours));
            const std::size_t k = squares.size();
            const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
            area[u] = k ? float(sum * 2 * EIGEN_PI / double(k * (k + 1))) : 0.f;
        }
    });
}

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
