// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PATCH_CLUSTERS_H
#define VCG_FCD_PATCH_CLUSTERS_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/patches/lloyd.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/morton.h>
#include <vcg_ext/base/progress.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace vcg::fcd::detail {

/// The name of the stage, for Progress.
constexpr const char *samplingStage = "Sampling patches";

/// Small connected clusters of the nodes that take part: the components of the cells of a regular grid.
struct Clusters {
    Graph graph;                  ///< a node per cluster, at its barycentre; edges where clusters touch
    std::vector<Index> clusterOf; ///< of each node; -1: does not take part
    std::vector<float> mass;      ///< of each cluster
    std::vector<float> extent;    ///< of each cluster: distance from its barycentre to its farthest node
};

/// The cells of a regular grid that hold nodes. \param graph in Morton order \param bits the side of a cell is 2^-bits
/// \return the first node of each cell, and the number of nodes
inline std::vector<Index> CellBegins(const Graph &graph, int bits, const Progress &progress) {
    const int shift = 30 - 3 * bits;
    auto code = [&](Index u) {
        return MortonCode(graph.position(0, u), graph.position(1, u), graph.position(2, u)) >> shift;
    };
    std::vector<Index> begin =
        NumbersThat(progress, samplingStage, graph.Size(), [&](Index u) { return u == 0 || code(u) != code(u - 1); });
    begin.push_back(graph.Size());
    return begin;
}

/// Sets barycentre, mass and extent of the clusters.
inline void MeasureClusters(const Lloyd &nodes, const std::vector<Index> &cellBegin, Clusters &c, Index clusters,
                            const Progress &progress) {
    const Graph &graph = nodes.graph;
    c.graph.position = Eigen::Matrix3Xf::Zero(3, clusters);
    c.mass.assign(clusters, 0);
    c.extent.assign(clusters, 0);
    // A cluster is in one cell, so that no two threads write to it.
    const auto forEach = [&](const Progress &progress, const auto &measure) {
        ParallelFor(progress, samplingStage, cellBegin.size() - 1, 256, [&](std::size_t first, std::size_t last) {
            for (Index u = cellBegin[first]; u < cellBegin[last]; ++u)
                if (c.clusterOf[u] >= 0)
                    measure(u, c.clusterOf[u]);
        });
    };
    forEach(progress.Slice(0, 0.5), [&](Index u, Index i) {
        const float mass = std::max(nodes.mass[u], 1e-30f); // so that a cluster without mass has a barycentre
        c.graph.position.col(i) += mass * graph.position.col(u);
        c.mass[i] += mass;
    });
    for (Index i = 0; i < clusters; ++i)
        c.graph.position.col(i) /= c.mass[i];
    forEach(progress.Slice(0.5, 1), [&](Index u, Index i) {
        c.extent[i] = std::max(c.extent[i], (graph.position.col(u) - c.graph.position.col(i)).norm() +
                                                (nodes.extent.empty() ? 0 : nodes.extent[u]));
    });
}

/// \param nodes in Morton order \param bits the side of a cell is 2^-bits
inline Clusters MakeClusters(const Lloyd &nodes, int bits, const Progress &progress) {
    Clusters c;
    const std::vector<Index> cellBegin = CellBegins(nodes.graph, bits, progress.Slice(0, 0.1));
    std::vector<Index> cellOf;
    AssignLarge(cellOf, nodes.graph.Size(), Index(0));
    for (std::size_t cell = 0; cell + 1 < cellBegin.size(); ++cell)
        std::fill(cellOf.begin() + cellBegin[cell], cellOf.begin() + cellBegin[cell + 1], Index(cell));
    const Index clusters = ConnectedComponents(
        nodes.graph.adjacency, [&](Index u) { return nodes.grower.TakesPart(u); },
        [&](Index u, Index v) { return cellOf[u] == cellOf[v]; }, c.clusterOf, progress.Slice(0.1, 0.5), samplingStage);
    MeasureClusters(nodes, cellBegin, c, clusters, progress.Slice(0.5, 0.7));
    c.graph.adjacency = QuotientGraph<char>(
                            nodes.graph.adjacency, c.clusterOf, clusters, [](Index, Index, char &) { return true; },
                            progress.Slice(0.7, 1), samplingStage)
                            .adjacency;
    return c;
}

/// Removes nodes near the borders of patches from these, to be grown again. The nodes of a cluster stay if no
/// neighbouring cluster is in another patch, and such clusters connect it with the patch's centre.
/// \param lloyd of the nodes, with the patches of their clusters \param patchOf of each cluster
/// \return the nodes of clusters that stay beside one that does not
inline std::vector<Index> ClearBorders(Lloyd &lloyd, const Clusters &clusters, const std::vector<Index> &patchOf,
                                       const Progress &progress) {
    const Index count = clusters.graph.Size();
    const Csr &adjacency = clusters.graph.adjacency;
    std::vector<char> inner(count), kept(count, 0), front(count, 0);
    for (Index c = 0; c < count; ++c) {
        inner[c] = 1;
        for (Index n : adjacency[c])
            inner[c] &= patchOf[n] == patchOf[c];
    }
    std::vector<Index> stack;
    for (const Center &center : lloyd.center) {
        stack.assign(1, clusters.clusterOf[center.node]);
        while (!stack.empty()) {
            const Index c = stack.back();
            stack.pop_back();
            if (!inner[c] || kept[c])
                continue;
            kept[c] = 1;
            for (Index n : adjacency[c])
                stack.push_back(n);
        }
    }
    for (Index c = 0; c < count; ++c)
        for (Index n : adjacency[c])
            front[c] |= kept[c] && !kept[n];
    return CollectInOrder(progress, samplingStage, lloyd.graph.Size(), [&](Index u, auto &nodes) {
        const Index c = clusters.clusterOf[u];
        if (c < 0)
            return;
        if (!kept[c])
            lloyd.grower.patchOf[u] = -1;
        else if (front[c])
            nodes.push_back(u);
    });
}

/// Lloyd's iteration on clusters of nodes, which comes close to the patches at a fraction of the cost; it begins on
/// still coarser clusters. Sets patches and centres of \p lloyd. Does nothing, and sets no centres, if there are too
/// few nodes a cluster or clusters a patch. \param bits cells have sides of 2^-bits at the finest, and 2^-leastBits at
/// the coarsest \return the bits of the finest cells, if the iteration converged; else 0
inline int SampleClusters(Lloyd &lloyd, const std::vector<Index> &seed, const PatchParam &param, int bits,
                          int leastBits, std::vector<SamplingStep> &history, const Progress &progress,
                          KeptClusters *kept = nullptr) {
    if (bits < leastBits)
        return 0;
    const Graph &graph = lloyd.graph;
    KeptClusters own;
    KeptClusters &used = kept ? *kept : own;
    if (used.bits != bits)
        used = {bits, std::make_shared<const Clusters>(MakeClusters(lloyd, bits, progress.Slice(0, 0.3)))};
    const Clusters &clusters = *used.clusters;
    const Index count = clusters.graph.Size();
    if (count == 0 || count < 8 * Index(seed.size()))
        return 0;
    if (count > graph.Size() / 3)
        return SampleClusters(lloyd, seed, param, bits - 1, leastBits, history, progress.Slice(0.3, 1), kept);
    progress(0.3, samplingStage);
    std::vector<Index> clusterSeed;
    const std::vector<Index> allTakePart;
    Lloyd coarse(clusters.graph, allTakePart, clusters.mass, progress.threads);
    coarse.extent = clusters.extent;
    for (float &e : coarse.extent)
        e *= 0.8f; // few nodes lie straight behind the barycentre of their cluster
    std::vector<bool> taken(count, false);
    for (Index s : seed)
        if (!taken[clusters.clusterOf[s]]) {
            taken[clusters.clusterOf[s]] = true;
            clusterSeed.push_back(clusters.clusterOf[s]);
        }
    const int coarser =
        SampleClusters(coarse, clusterSeed, param, param.rough ? std::min(bits - 1, leastBits) : bits - 1, leastBits,
                       history, progress.Slice(0.3, 0.5));
    const bool isEnough = param.rough && !coarse.center.empty();
    if (coarse.center.empty())
        for (Index s : clusterSeed)
            coarse.center.push_back({s, clusters.graph.position.col(s)});
    const bool converged = isEnough ? coarser > 0 : coarse.Iterate(param, history, progress.Slice(0.5, 0.6));

    // From clusters to nodes.
    const std::vector<Index> &patchOfCluster = coarse.grower.patchOf;
    std::vector<Index> &patchOf = lloyd.grower.patchOf;
    patchOf.resize(graph.Size());
    ParallelForEach(progress.Slice(0.6, 0.65), samplingStage, patchOf.size(), 1 << 16, [&](std::size_t u) {
        patchOf[u] = clusters.clusterOf[u] < 0 ? -1 : patchOfCluster[clusters.clusterOf[u]];
    });
    // Leave out centres that the last iteration added: no patch was grown from them.
    lloyd.center.resize(1 + *std::max_element(patchOfCluster.begin(), patchOfCluster.end()));
    lloyd.UpdateCenters();
    if (param.rough)
        return converged ? bits : 0;
    const std::vector<Index> front = ClearBorders(lloyd, clusters, patchOfCluster, progress.Slice(0.65, 0.7));
    lloyd.grower.GrowFrom(front, lloyd.center, param.targetRadius / 128, progress.Slice(0.7, 1));
    progress(1, samplingStage);
    lloyd.UpdateCenters();
    return converged ? bits : 0;
}

} // namespace vcg::fcd::detail

#endif
