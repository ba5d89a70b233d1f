// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/bend/model/reach.h"

#include <cmath>

using vcg::fcd::Index;
using vcg::fcd::SurfaceGraph;

// Cells that a surface meets, times the area of a cell's side, over the surface's area: 1.5 for an oblique plane.
const double cellsOfArea = 1.5;

/// Numbers the clusters, in the order of their first nodes. Nodes of \p near stay alone. \return number of clusters
static Index findClusters(const SurfaceGraph &fine, double cell, const KeptNear &near, std::vector<Index> &cluster) {
    const Index n = fine.graph.Size();
    std::vector<Eigen::Vector3i> cellOf(static_cast<std::size_t>(n));
    std::vector<char> isKept(cellOf.size());
    for (Index u = 0; u < n; ++u) {
        cellOf[std::size_t(u)] = (fine.graph.position.col(u).cast<double>() / cell).array().floor().cast<int>();
        isKept[std::size_t(u)] = near.holds(fine.graph.position.col(u));
    }
    const auto joins = [&](Index u, Index v) {
        return !isKept[std::size_t(u)] && !isKept[std::size_t(v)] && cellOf[std::size_t(u)] == cellOf[std::size_t(v)];
    };
    return vcg::fcd::ConnectedComponents(
        fine.graph.adjacency, [](Index) { return true; }, joins, cluster, {}, "");
}

std::unique_ptr<SurfaceGraph> coarseOf(const SurfaceGraph &fine, Index most, const KeptNear &near) {
    const Index n = fine.graph.Size();
    if (n <= most || !(fine.area > 0))
        return nullptr;
    std::vector<Index> cluster;
    const Index count = findClusters(fine, std::sqrt(cellsOfArea * fine.area / most), near, cluster);
    auto coarse = std::make_unique<SurfaceGraph>();
    coarse->frame = fine.frame;
    coarse->area = fine.area;
    coarse->graph.isCloud = fine.graph.isCloud;
    coarse->graph.position = Eigen::Matrix3Xf::Zero(3, count);
    coarse->nodeArea.assign(std::size_t(count), 0);
    std::vector<float> size(std::size_t(count), 0);
    for (Index u = 0; u < n; ++u) {
        const Index own = cluster[std::size_t(u)];
        coarse->graph.position.col(own) += fine.graph.position.col(u);
        coarse->nodeArea[std::size_t(own)] += fine.nodeArea[std::size_t(u)];
        ++size[std::size_t(own)];
    }
    for (Index c = 0; c < count; ++c)
        coarse->graph.position.col(c) /= size[std::size_t(c)];
    coarse->graph.adjacency =
        vcg::fcd::QuotientGraph<char>(fine.graph.adjacency, cluster, count, [](Index, Index, char &) {
            return true;
        }).adjacency;
    coarse->nodeOf = fine.nodeOf;
    for (Index &node : coarse->nodeOf)
        if (node >= 0)
            node = cluster[std::size_t(node)];
    return coarse;
}
