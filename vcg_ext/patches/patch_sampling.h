// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PATCH_SAMPLING_H
#define VCG_FCD_PATCH_SAMPLING_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>

#include <memory>
#include <vector>

namespace vcg::fcd {

namespace detail {
struct Clusters;
}

/// The clusters of nodes that a sampling made, for the next one of the same graph, tags and masses: it gives the same.
struct KeptClusters {
    int bits = 0; ///< of the side of their cells; 0: none yet
    std::shared_ptr<const detail::Clusters> clusters;
};

/// How the patches are chosen (paper, sec. 2.1).
struct PatchParam {
    double targetRadius = 0;  ///< D, units of the graph's positions, > 0: no patch reaches farther from its centre
    int initialPatches = 300; ///< k0, seeds to begin with, >= 1
    int maxIterations = 100;  ///< >= 1
    double tolerance = 1e-3;  ///< converged when an iteration lowers the cost (Eq. 1) by less than this fraction of it
    unsigned randomSeed = 1;  ///< of the first seeds
    bool rough = false; ///< where many nodes are in a patch, the last steps are left out: borders are those of clusters
                        ///< of nodes, some patches are larger than D, and it takes a third of the time
};

/// One iteration of the sampling.
struct SamplingStep {
    Index patches;  ///< that were grown in it
    double seconds; ///< that it took
};

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

/// Samples \p graph with centroidal patches of bounded radius (paper, sec. 2.1): every node that takes part is in
/// exactly one patch; every patch is connected; when converged, no patch but one of a single node is larger than D.
///
/// Lloyd's iteration with splits runs on clusters of nodes where there are many nodes to a patch, and is finished on
/// the nodes themselves.
/// \param tag n values, nodes of tag 1 take part; empty: all do
/// \param mass n values, >= 0: what each node counts in Eq. 1 and for the seeds; empty: 1 each (the paper's)
/// \param kept read and written, null: none \pre the nodes are in Morton order (BuildSurfaceGraph)
Patches SamplePatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &mass,
                      const PatchParam &param, const Progress &progress = {}, KeptClusters *kept = nullptr);

/// Patches around given centres (different nodes that take part), which stay where they are; a part that no centre
/// leads to gets its own. \param spacing of the centres, about, > 0; 0: as of so many
Patches GrowPatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<Index> &center,
                    const Progress &progress = {}, float spacing = 0);

} // namespace vcg::fcd

#endif
