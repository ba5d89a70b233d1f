// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LLOYD_H
#define VCG_FCD_LLOYD_H

#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/patches/patch_growing.h>
#include <vcg_ext/patches/patch_sampling.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace vcg::fcd {

namespace detail {

/// The mass of each node over the mean mass; 1 without \p mass; 0 for nodes that do not take part.
inline std::vector<float> Masses(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &mass) {
    std::vector<float> each;
    AssignLarge(each, graph.Size(), 1.f);
    double sum = 0, count = 0;
    for (Index u = 0; u < graph.Size(); ++u)
        if (!tag.empty() && tag[u] != 1) {
            each[u] = 0;
        } else {
            sum += mass.empty() ? 1 : mass[u];
            ++count;
        }
    if (!mass.empty() && sum > 0)
        for (Index u = 0; u < graph.Size(); ++u)
            each[u] *= float(mass[u] * (count / sum));
    return each;
}

/// Random seeds: a node from each of \p count stretches of equal mass, different ones, ascending. In Morton order, a
/// stretch is a part of the surface, so no part is left without a seed. Fewer than \p count if a stretch is less than a
/// node. \param mass n values
inline std::vector<Index> RandomSample(const std::vector<float> &mass, Index count, unsigned seed) {
    // Not std::uniform_real_distribution, which differs between libraries; the engine does not.
    std::mt19937_64 random(seed);
    const double total = std::accumulate(mass.begin(), mass.end(), 0.0);
    std::vector<Index> sample;
    if (!(total > 0))
        return sample;
    double sum = 0; // of the nodes before u
    Index u = 0, last = -1;
    for (Index i = 0; i < count; ++i) {
        const double at = (i + double(random() >> 11) * 0x1p-53) * (total / count);
        while (u + 1 < Index(mass.size()) && sum + mass[u] <= at)
            sum += mass[u++];
        if (u != last && mass[u] > 0)
            sample.push_back(u);
        last = u;
    }
    return sample;
}

/// Lloyd's iteration with splits. A node may stand for a cluster of nodes, in a ball of radius extent around it; then
/// distances are measured to the barycentres of patches. Without extents, they are measured to the central nodes.
struct Lloyd {
    const Graph &graph;
    const std::vector<Index> &tag;
    const std::vector<float> &mass;
    unsigned threads;
    std::vector<float> extent;

    PatchGrower grower{graph, tag};
    std::vector<Center> center;  ///< of the patches
    std::vector<Index> farthest; ///< of each patch: the node farthest from its centre
    std::vector<float> radius;   ///< the distance of that node, plus its extent
    double cost = 0;             ///< Eq. 1

    Lloyd(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &mass, unsigned threads)
        : graph(graph), tag(tag), mass(mass), threads(threads) {}

    /// Sets radius, farthest and cost for the present patches and centres.
    void Measure() {
        struct Part {
            std::vector<float> radius;
            std::vector<Index> farthest;
            double cost = 0;
        };
        const std::size_t k = center.size();
        std::vector<Part> parts(Parts());
        ForEachPart([&](std::size_t part, Index first, Index last) {
            Part p;
            p.radius.assign(k, -1);
            p.farthest.assign(k, -1);
            for (Index u = first; u < last; ++u) {
                const Index at = grower.patchOf[u];
                if (at < 0)
                    continue;
                const float d2 = (graph.position.col(u) - center[at].position).squaredNorm();
                float reach = std::sqrt(d2);
                if (!extent.empty() && u != center[at].node)
                    reach += extent[u];
                p.cost += mass[u] * d2;
                if (reach > p.radius[at]) {
                    p.radius[at] = reach;
                    p.farthest[at] = u;
                }
            }
            parts[part] = std::move(p);
        });
        radius.assign(k, -1);
        farthest.assign(k, -1);
        cost = 0;
        for (const Part &p : parts) {
            cost += p.cost;
            for (std::size_t c = 0; c < k; ++c)
                if (p.radius[c] > radius[c]) {
                    radius[c] = p.radius[c];
                    farthest[c] = p.farthest[c];
                }
        }
    }

    /// Moves each centre to the node of its patch nearest the barycentre.
    void UpdateCenters() {
        struct Sum {
            Eigen::Vector3d position = Eigen::Vector3d::Zero();
            double mass = 0;
        };
        struct Nearest {
            float d2 = std::numeric_limits<float>::infinity();
            Index node = -1;
        };
        const std::size_t k = center.size();
        std::vector<std::vector<Sum>> sums(Parts());
        ForEachPart([&](std::size_t part, Index first, Index last) {
            std::vector<Sum> sum(k);
            for (Index u = first; u < last; ++u) {
                if (grower.patchOf[u] < 0)
                    continue;
                const float m = std::max(mass[u], 1e-30f); // so that a patch without mass has a barycentre
                Sum &s = sum[grower.patchOf[u]];
                s.position += (m * graph.position.col(u)).cast<double>();
                s.mass += m;
            }
            sums[part] = std::move(sum);
        });
        Eigen::Matrix3Xf barycenter(3, k);
        for (std::size_t c = 0; c < k; ++c) {
            Sum total;
            for (const std::vector<Sum> &sum : sums) {
                total.position += sum[c].position;
                total.mass += sum[c].mass;
            }
            barycenter.col(c) = (total.position / total.mass).cast<float>();
        }
        std::vector<std::vector<Nearest>> nearests(Parts());
        ForEachPart([&](std::size_t part, Index first, Index last) {
            std::vector<Nearest> nearest(k);
            for (Index u = first; u < last; ++u) {
                const Index c = grower.patchOf[u];
                if (c < 0)
                    continue;
                const float d2 = (graph.position.col(u) - barycenter.col(c)).squaredNorm();
                if (d2 < nearest[c].d2)
                    nearest[c] = {d2, u};
            }
            nearests[part] = std::move(nearest);
        });
        for (std::size_t c = 0; c < k; ++c) {
            Nearest best;
            for (const std::vector<Nearest> &nearest : nearests)
                if (nearest[c].d2 < best.d2)
                    best = nearest[c];
            center[c] = {best.node, graph.position.col(best.node)};
            if (!extent.empty())
                center[c].position = barycenter.col(c);
        }
    }

    /// New centres that split patches: the farthest node of every patch that reaches beyond \p D.
    std::vector<Center> Splits(double D) const {
        std::vector<Center> added;
        for (std::size_t p = 0; p < center.size(); ++p)
            if (radius[p] > D && farthest[p] != center[p].node)
                added.push_back({farthest[p], graph.position.col(farthest[p])});
        return added;
    }

    /// Grows patches, splits them and moves the centres, until the cost stops falling and no patch reaches beyond D.
    /// \param history in, out: all iterations so far, which count towards maxIterations \return whether it converged
    bool Iterate(const PatchParam &param, std::vector<SamplingStep> &history, const Progress &progress) {
        double previous = std::numeric_limits<double>::infinity();
        bool converged = false;
        while (!converged && int(history.size()) < param.maxIterations) {
            const Stopwatch watch;
            const int iterations = int(history.size());
            // Most runs end after 10 to 30 iterations, so progress does not go by the maximum.
            const double from = Done(iterations, param), to = Done(iterations + 1, param);
            grower.Grow(center, param.targetRadius / 128, progress.Slice(from, to));
            Measure();
            history.push_back({Index(center.size()), 0});
            const bool settled = std::isfinite(previous) && previous - cost <= param.tolerance * previous;
            previous = cost;
            std::vector<Center> added = Splits(param.targetRadius);
            UpdateCenters();
            if (added.empty() && settled) {
                Measure();
                added = Splits(param.targetRadius);
                converged = added.empty();
            }
            // Add no centres after the last growth, nor one that the patch's own centre has moved to.
            if (int(history.size()) < param.maxIterations)
                for (const Center &c : added)
                    if (center[grower.patchOf[c.node]].node != c.node)
                        center.push_back(c);
            history.back().seconds = watch.Seconds();
        }
        return converged;
    }

    static double Done(int iterations, const PatchParam &param) {
        return 1 - detail::Exponential(-8.0 * iterations / param.maxIterations);
    }

  private:
    /// The nodes are visited in this many parts, so that sums do not depend on the number of threads: one part if
    /// patches have so few nodes that the parts' lists of patches would be long.
    std::size_t Parts() const {
        return std::max<std::size_t>(1, std::min<std::size_t>(16, graph.Size() / (64 * center.size() + 1)));
    }
    template <class Body>
    void ForEachPart(const Body &body) const {
        const std::size_t parts = Parts();
        ParallelFor(threads, parts, 1, [&](std::size_t part, std::size_t) {
            body(part, Index(std::uint64_t(graph.Size()) * part / parts),
                 Index(std::uint64_t(graph.Size()) * (part + 1) / parts));
        });
    }
};

} // namespace detail
} // namespace vcg::fcd

#endif
