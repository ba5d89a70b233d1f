// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/patches/lloyd.h>
#include <vcg_ext/patches/patch_clusters.h>
#include <vcg_ext/patches/patch_sampling.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace vcg::fcd {

namespace {

Patches TakePatches(detail::Lloyd &lloyd) {
    Patches patches;
    lloyd.Measure();
    patches.patchOf = std::move(lloyd.grower.patchOf);
    patches.center.reserve(lloyd.center.size());
    for (const detail::Center &c : lloyd.center) {
        patches.center.push_back(c.node);
        patches.tag.push_back(1);
    }
    patches.radius = std::move(lloyd.radius);
    patches.cost = lloyd.cost;
    return patches;
}

} // namespace

Patches SamplePatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &mass,
                      const PatchParam &param, const Progress &progress, KeptClusters *kept) {
    assert(tag.empty() || Index(tag.size()) == graph.Size());
    assert(mass.empty() || Index(mass.size()) == graph.Size());
    assert(param.targetRadius > 0 && param.initialPatches >= 1 && param.maxIterations >= 1);
    const std::vector<float> each = detail::Masses(graph, tag, mass);
    const std::vector<Index> seed = detail::RandomSample(each, param.initialPatches, param.randomSeed);
    std::vector<SamplingStep> history;
    detail::Lloyd lloyd(graph, tag, each, progress.threads);
    const double coarsest =
        detail::BinaryLogarithm(3 / std::max(param.targetRadius, 1e-6)); // Morton codes have ten bits
    const int leastBits = std::max(1, int(std::ceil(coarsest))), bits = std::min(leastBits + (param.rough ? 2 : 1), 10);
    const int used = detail::SampleClusters(lloyd, seed, param, bits, leastBits, history, progress.Slice(0, 0.7), kept);
    const bool isEnough = param.rough && !lloyd.center.empty();
    bool converged = used > (isEnough ? 0 : leastBits);
    if (used && !isEnough) {
        lloyd.Measure();
        const std::vector<detail::Center> added = lloyd.Splits(param.targetRadius);
        converged &= added.empty();
        if (int(history.size()) < param.maxIterations)
            lloyd.center.insert(lloyd.center.end(), added.begin(), added.end());
    }
    if (!converged && !isEnough) {
        if (lloyd.center.empty())
            for (Index u : seed)
                lloyd.center.push_back({u, graph.position.col(u)});
        converged = lloyd.Iterate(param, history, progress.Slice(0.7, 1));
    }
    Patches patches = TakePatches(lloyd);
    patches.iterations = int(history.size());
    patches.history = std::move(history);
    patches.converged = converged;
    return patches;
}

Patches GrowPatches(const Graph &graph, const std::vector<Index> &tag, const std::vector<Index> &center,
                    const Progress &progress, float spacing) {
    const std::vector<float> mass(graph.Size(), 1);
    detail::Lloyd lloyd(graph, tag, mass, progress.threads);
    for (Index u : center)
        lloyd.center.push_back({u, graph.position.col(u)});
    if (!(spacing > 0))
        spacing = 1 / std::sqrt(float(std::max<std::size_t>(1, lloyd.center.size())));
    lloyd.grower.Grow(lloyd.center, spacing / 128, progress);
    Patches patches = TakePatches(lloyd);
    patches.converged = true;
    return patches;
}

} // namespace vcg::fcd
