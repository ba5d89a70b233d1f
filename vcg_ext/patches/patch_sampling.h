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

/// The clusters of a sampling, to reuse in the next one with the same graph, tags and masses; changes no bit.
struct KeptClusters {
    int bits = 0; ///< of the side of their cells; 0: none yet
    std::shared_ptr<const detail::Clusters> clusters;
};

/// How the patches are chosen (paper, sec. 2.1).
struct PatchParam {
    double targetRadius = 0;  ///< D, frame units, > 0: the largest radius of a patch
    int initialPatches = 300; ///< k0, number of seeds, >= 1
    int maxIterations = 100;  ///< >= 1
    double tolerance = 1e-3;  ///< converged when an iteration lowers the cost (Eq. 1) by less than this fraction of it
    unsigned randomSeed = 1;  ///< of the seeds
    bool rough = false;       ///< stops at clusters if patches have many nodes: borders are those of clusters, and some
                              ///< patches are larger than D; takes a third of the time
};

/// One iteration of the sampling.
struct SamplingStep {
    Index patches;  ///< number of patches that were grown
    double seconds; ///< time it took
};

/// Centroidal patches over a graph of n nodes.
struct Patches {
    std::vector<Index> patchOf; ///< n, patch of each node in [0, k); -1: none
    std::vector<Index> center;  ///< k, c: the node of the patch nearest to its barycentre
    std::vector<float> radius;  ///< k, d_j: largest distance from the centre to a node of the patch
    std::vector<Index> tag;     ///< k, of the patch's nodes; 1 also if it has a small held part
    double cost = 0;            ///< E of Eq. 1, with the squares weighted by mass over mean mass
    int iterations = 0;
    bool converged = false;
    std::vector<SamplingStep> history; ///< one per iteration

    Index Size() const { return Index(center.size()); }
};

/// Divides \p graph into centroidal patches of bounded radius (paper, sec. 2.1): every node that takes part is in
/// exactly one patch; every patch is connected; if it converged, no patch is larger than D.
///
/// Lloyd's iteration with splits runs on clusters if patches have many nodes, and ends on the nodes themselves.
/// \param graph in Morton order (BuildSurfaceGraph) \param tag n values, nodes of tag 1 take part; empty: all do
/// \param mass n values, >= 0: weights in Eq. 1 and for the seeds; empty: 1 each, as in the paper
/// \param kept in, out; null: none \throw Cancelled
Patches SamplePatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &mass,
                      const PatchParam &param, const Progress &progress = {}, KeptClusters *kept = nullptr);

/// Grows patches around given centres, which do not move. A component without a centre gets one.
/// \param center different nodes that take part \param spacing about the distance of the centres, frame units, > 0; 0:
/// by their number
Patches GrowPatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<Index> &center,
                    const Progress &progress = {}, float spacing = 0);

} // namespace vcg::fcd

#endif
