// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PATCH_SAMPLING_H
#define VCG_FCD_PATCH_SAMPLING_H

#include "graph.h"
#include "lloyd.h"
#include "patch_clusters.h"
#include "progress.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg {
namespace fcd {

/// Centroidal patches over a graph of n nodes.
struct Patches {
    std::vector<Index> patchOf; ///< n, patch of each node in [0, k), -1 for a node that is in none
    std::vector<Index> center;  ///< k, c: the node of the patch nearest its barycentre
    std::vector<float> radius;  ///< k, d_j: largest distance from the centre to a node of the patch
    std::vector<Index> tag;     ///< k, that of the patch's nodes; 1 where small held parts lie in it, too
    double cost = 0;            ///< E of Eq. 1, the squares weighed by the nodes' mass over the mean of it
    int iterations = 0;
    bool converged = false;
    std::vector<SamplingStep> history; ///< one per iteration

    Index Size() const { return Index(center.size()); }
};

namespace detail {

inline Patches TakePatches(Lloyd &lloyd) {
    Patches patches;
    lloyd.Measure();
    patches.patchOf = std::move(lloyd.grower.patchOf);
    patches.center.reserve(lloyd.center.size());
    for (const Center &c : lloyd.center) {
        patches.center.push_back(c.node);
        patches.tag.push_back(1);
    }
    patches.radius = std::move(lloyd.radius);
    patches.cost = lloyd.cost;
    return patches;
}

} // namespace detail

/// Samples \p graph with centroidal patches of bounded radius (paper, sec. 2.1): every node that takes part is in
/// exactly one patch; every patch is connected; when converged, no patch but one of a single node is larger than D.
///
/// Lloyd's iteration with splits runs on clusters of nodes where there are many nodes to a patch, and is finished on
/// the nodes themselves.
/// \param tag n values, nodes of tag 1 take part; empty: all do
/// \param mass n values, >= 0: what each node counts in Eq. 1 and for the seeds; empty: 1 each (the paper's)
/// \pre the nodes are in Morton order (BuildSurfaceGraph)
inline Patches SamplePatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &mass,
                             const PatchParam &param, const Progress &progress = {}) {
    const std::vector<float> each = detail::Masses(graph, tag, mass);
    const std::vector<Index> seed = detail::RandomSample(each, param.initialPatches, param.randomSeed);
    std::vector<SamplingStep> history;
    detail::Lloyd lloyd(graph, tag, each, progress.threads);
    const double coarsest = std::log2(3 / std::max(param.targetRadius, 1e-6)); // more than ten bits are not used
    const int leastBits = std::max(1, int(std::ceil(coarsest))), bits = std::min(leastBits + 1, 10);
    const int used = detail::SampleClusters(lloyd, seed, param, bits, leastBits, history, progress.Slice(0, 0.7));
    bool converged = used > leastBits;
    if (used) {
        lloyd.Measure();
        const std::vector<detail::Center> added = lloyd.Splits(param.targetRadius);
        converged &= added.empty();
        if (int(history.size()) < param.maxIterations)
            lloyd.center.insert(lloyd.center.end(), added.begin(), added.end());
    }
    if (!converged) {
        if (lloyd.center.empty())
            for (Index u : seed)
                lloyd.center.push_back({u, graph.position.col(u)});
        converged = lloyd.Iterate(param, history, progress.Slice(0.7, 1));
    }
    Patches patches = detail::TakePatches(lloyd);
    patches.iterations = int(history.size());
    patches.history = std::move(history);
    patches.converged = converged;
    return patches;
}

/// Patches around given centres (different nodes that take part), which stay where they are; a part that no centre
/// leads to gets its own.
inline Patches GrowPatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<Index> &center,
                           const Progress &progress = {}) {
    const std::vector<float> mass(graph.Size(), 1);
    detail::Lloyd lloyd(graph, tag, mass, progress.threads);
    for (Index u : center)
        lloyd.center.push_back({u, graph.position.col(u)});
    const float spacing = 1 / std::sqrt(float(std::max<std::size_t>(1, lloyd.center.size())));
    lloyd.grower.Grow(lloyd.center, spacing / 128, progress);
    Patches patches = detail::TakePatches(lloyd);
    patches.converged = true;
    return patches;
}

} // namespace fcd
} // namespace vcg

#endif
