// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_POINT_CLOUD_H
#define VCG_FCD_POINT_CLOUD_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/triangle_graph.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace vcg {
namespace fcd {
namespace detail {

/// How many of the nearest points are a point's neighbours: twice a triangulation's six, so that those of the Delaunay
/// triangulation are among them where one direction is sampled two or three times as densely as the other.
constexpr int cloudNeighbours = 12;

/// Triangles with a repeated corner that join each point with its nearest ones.
inline TriangleList NearestNeighbourPairs(const Eigen::Matrix3Xf &position, const Progress &progress) {
    const Index n = Index(position.cols());
    const std::unique_ptr<PointTree<float>> tree = TreeOf(position);
    const int wanted = std::min<int>(cloudNeighbours, n - 1);
    TriangleList pairs;
    pairs.count = std::size_t(n) * wanted;
    pairs.corner = LargeArray<Index>(3 * pairs.count);
    ParallelFor(progress, "Finding neighbours", n, 1 << 12, [&](std::size_t first, std::size_t last) {
        std::vector<PointTree<float>::Found> nearest;
        std::vector<Index> found;
        for (std::size_t i = first; i < last; ++i) {
            tree->Nearest(position.col(Eigen::Index(i)), std::size_t(wanted) + 1, nearest);
            found.clear();
            for (const auto &each : nearest)
                if (each.point != Index(i))
                    found.push_back(each.point);
            std::sort(found.begin(), found.end());
            Index *at = pairs.corner.get() + i * wanted * 3;
            for (int j = 0; j < wanted; ++j, at += 3) {
                at[0] = Index(i);
                at[1] = at[2] = j < int(found.size()) ? found[j] : Index(i);
            }
        }
    });
    return pairs;
}

/// The area that each point of a cloud stands for: that of a point of an evenly random set of the density around it,
/// where the k-th nearest of the others is at k / (pi density) squared on average. Held points, of whose neighbours
/// only those beside free ones are known, have none. \param tag as of SurfaceGraph
inline void CloudAreas(const Graph &graph, const std::vector<Index> &tag, unsigned threads, std::vector<float> &area) {
    ParallelFor(threads, graph.Size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        std::vector<float> squares;
        for (std::size_t u = first; u < last; ++u) {
            squares.clear();
            if (!tag.empty() && tag[u] != 1) {
                area[u] = 0;
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
