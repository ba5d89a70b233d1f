// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PATCH_SAMPLING_H
#define VCG_FCD_PATCH_SAMPLING_H

#include "graph.h"
#include "morton.h"
#include "progress.h"

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <string>

namespace vcg {
namespace fcd {

/// How the patches are chosen (paper, sec. 2.1).
struct PatchParam {
    double targetRadius = 0;  ///< D, units of the graph's positions, > 0: no patch reaches farther from its centre
    int initialPatches = 300; ///< k0, seeds to begin with, >= 1
    int maxIterations = 100;  ///< >= 1
    double tolerance = 1e-3;  ///< converged when an iteration lowers the cost (Eq. 1) by less than this fraction of it
    unsigned randomSeed = 1;  ///< of the first seeds
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

namespace detail {

/// Where a patch grows from, and what distances are measured to.
struct Center {
    Index node;
    Eigen::Vector3f position;
};

/// Grows patches from centres along the connectivity, nearest node first (Euclidean distance to the patch's centre),
/// over nodes of tag 1 (no tags: over all). Keeps its buffers between calls.
class PatchGrower {
  public:
    PatchGrower(const Graph &graph, const std::vector<Index> &tag) : graph(graph), tag(tag) {}

    std::vector<Index> patchOf; ///< result of Grow; -1 for nodes of other tags

    bool TakesPart(Index u) const { return tag.empty() || tag[u] == 1; }

    /// Assigns every node that takes part to a patch. Where no centre leads, a node becomes one: \p center grows.
    /// \param step width of a distance class; the order within a class is left open
    void Grow(std::vector<Center> &center, double step, const Progress &progress = {}) {
        AssignLarge(patchOf, graph.Size(), Index(-1));
        Start(step, progress.threads);
        for (Index c = 0; c < Index(center.size()); ++c)
            Offer(center[c].node, c, 0, 0);
        Finish(center, progress);
    }

    /// The same where patchOf is given already for some nodes, which must be connected to the centre of their patch
    /// through such nodes; the others are -1. \param front those of them with a neighbour that is not assigned, or more
    void GrowFrom(const std::vector<Index> &front, std::vector<Center> &center, double step, const Progress &progress) {
        Start(step, progress.threads);
        for (Index c = 0; c < Index(center.size()); ++c)
            if (patchOf[center[c].node] < 0)
                Offer(center[c].node, c, 0, 0);
        for (Index u : front)
            OfferNeighbours(u, patchOf[u], center[patchOf[u]].position, 0);
        Finish(center, progress);
    }

  private:
    struct Offered {
        Index node, patch;
    };
    struct State { // what an offer reads and writes, together in memory
        float x, y, z;
        float best; ///< squared distance of the best offer; negative once assigned
    };

    void Start(double step, unsigned threads) {
        inverseStep = float(std::min(1 / step, 1e30)); // finite: 0 times it is 0
        bucket.resize(4096);
        assigned = 0;
        if (!state)
            state = LargeArray<State>(graph.Size());
        ParallelFor(threads, graph.Size(), 1 << 16, [&](std::size_t first, std::size_t last) {
            for (std::size_t u = first; u < last; ++u)
                state[u] = {graph.position(0, u), graph.position(1, u), graph.position(2, u),
                            patchOf[u] < 0 && TakesPart(Index(u)) ? std::numeric_limits<float>::infinity() : -1};
        });
    }

    void Offer(Index node, Index patch, float d2, std::size_t current) {
        state[node].best = d2;
        const float b = std::min(std::sqrt(d2) * inverseStep, float(bucket.size() - 1));
        const std::size_t at = std::max(std::size_t(b), current);
        bucket[at].push_back({node, patch});
        last = std::max(last, at);
    }

    void OfferNeighbours(Index u, Index patch, const Eigen::Vector3f &c, std::size_t current) {
        for (Index v : graph.adjacency[u]) {
            const State &s = state[v];
            if (s.best < 0)
                continue;
            const float d2 = (Eigen::Vector3f(s.x, s.y, s.z) - c).squaredNorm();
            if (d2 < s.best)
                Offer(v, patch, d2, current);
        }
    }

    void Empty(const std::vector<Center> &center, const Progress &progress) {
        for (std::size_t b = 0; b <= last; ++b) {
            // A bucket may grow while it is emptied.
            for (std::size_t i = 0; i < bucket[b].size(); ++i) {
#ifdef __GNUC__
                // Offers that follow each other are far apart in memory: begin to read what the next ones need. (A
                // function of its own would be optimised away, as one without an effect.)
                const std::vector<Offered> &offers = bucket[b];
                if (i + 16 < offers.size())
                    __builtin_prefetch(&graph.adjacency.begin[offers[i + 16].node]);
                if (i + 8 < offers.size())
                    __builtin_prefetch(graph.adjacency[offers[i + 8].node].first);
                if (i + 4 < offers.size())
                    for (Index v : graph.adjacency[offers[i + 4].node])
                        __builtin_prefetch(&state[v]);
#endif
                const Offered o = bucket[b][i];
                if (state[o.node].best < 0)
                    continue;
                state[o.node].best = -1;
                patchOf[o.node] = o.patch;
                if ((++assigned & 0xffff) == 0)
                    progress(double(assigned) / graph.Size(), "Growing patches");
                OfferNeighbours(o.node, o.patch, center[o.patch].position, b);
            }
            bucket[b].clear();
        }
        last = 0;
    }

    void Finish(std::vector<Center> &center, const Progress &progress) {
        Empty(center, progress);
        for (Index u = 0; u < graph.Size(); ++u)
            if (patchOf[u] < 0 && TakesPart(u)) {
                center.push_back({u, graph.position.col(u)});
                Offer(u, Index(center.size()) - 1, 0, 0);
                Empty(center, progress);
            }
    }

    const Graph &graph;
    const std::vector<Index> &tag;
    std::unique_ptr<State[]> state;
    std::vector<std::vector<Offered>> bucket;
    float inverseStep = 1;
    std::size_t last = 0;
    Index assigned = 0;
};

/// What each node counts: \p mass over the mean of it, or 1; 0 for a node that does not take part.
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

/// A random node of each of \p count stretches of equal mass: different nodes with a mass, ascending. In Morton order,
/// stretches are parts of the surface, of equal area where that is the mass, so that no part of it is left without a
/// seed. Fewer than \p count where stretches are shorter than a node.
/// \param mass n values
inline std::vector<Index> RandomSample(const std::vector<float> &mass, Index count, unsigned seed) {
    // The standard's distributions differ between libraries, the engine's numbers do not.
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

/// Lloyd's iteration with splits. A node may stand for several spread over a ball around it (extent), and distances are
/// measured to the barycentres then; no extents: a centre is where its node is.
struct Lloyd {
    const Graph &graph;
    const std::vector<Index> &tag;
    const std::vector<float> &mass;
    unsigned threads;
    std::vector<float> extent;

    PatchGrower grower{graph, tag};
    std::vector<Center> center;  ///< of the patches
    std::vector<Index> farthest; ///< of each patch, from its centre
    std::vector<float> radius;   ///< distance of the farthest node, its extent included
    double cost = 0;             ///< Eq. 1

    Lloyd(const Graph &graph, const std::vector<Index> &tag, const std::vector<float> &mass, unsigned threads)
        : graph(graph), tag(tag), mass(mass), threads(threads) {}

    /// Radius, farthest node and cost for the present patches and centres.
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
                const float m = std::max(mass[u], 1e-30f); // a patch of nodes without mass has a barycentre, too
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

    /// The farthest node of every patch that reaches beyond \p D: new centres, one split a patch.
    std::vector<Center> Splits(double D) const {
        std::vector<Center> added;
        for (std::size_t p = 0; p < center.size(); ++p)
            if (radius[p] > D && farthest[p] != center[p].node)
                added.push_back({farthest[p], graph.position.col(farthest[p])});
        return added;
    }

    /// Grows, splits and moves the centres until the cost stops falling and no patch reaches beyond D.
    /// \param history of this iteration and of those before it, which count towards maxIterations
    bool Iterate(const PatchParam &param, std::vector<SamplingStep> &history, const Progress &progress) {
        double previous = std::numeric_limits<double>::infinity();
        bool converged = false;
        while (!converged && int(history.size()) < param.maxIterations) {
            const Stopwatch watch;
            const int iterations = int(history.size());
            // Most runs end after 10 to 30 iterations, whatever the maximum.
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
            // Centres that no growth would follow are left out, and so is one that the patch's own centre has moved to.
            if (int(history.size()) < param.maxIterations)
                for (const Center &c : added)
                    if (center[grower.patchOf[c.node]].node != c.node)
                        center.push_back(c);
            history.back().seconds = watch.Seconds();
        }
        return converged;
    }

    static double Done(int iterations, const PatchParam &param) {
        return 1 - std::exp(-8.0 * iterations / param.maxIterations);
    }

  private:
    /// The nodes are visited in this many parts, so that sums do not depend on the number of threads; one where a patch
    /// has so few nodes that the parts' lists of patches would be long.
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

/// Nodes of \p graph that take part joined into small connected clusters: the components of the cells of a regular
/// grid.
struct Clusters {
    Graph graph;                  ///< a node per cluster, at its barycentre; edges where clusters touch
    std::vector<Index> clusterOf; ///< of each node, -1 for one that does not take part
    std::vector<float> mass;      ///< of the nodes of each cluster
    std::vector<float> extent;    ///< distance from the barycentre to the farthest node
};

/// \param bits the cells' side is 2^-bits; the nodes must be in Morton order
inline Clusters MakeClusters(const Lloyd &nodes, int bits, const Progress &progress) {
    const Graph &graph = nodes.graph;
    const auto takesPart = [&](Index u) { return nodes.grower.TakesPart(u); };
    const char *stage = "Sampling patches";
    const Index n = graph.Size();
    const int shift = 30 - 3 * bits;
    auto code = [&](Index u) {
        return MortonCode(graph.position(0, u), graph.position(1, u), graph.position(2, u)) >> shift;
    };
    std::vector<Index> cellBegin = CollectInOrder(progress.Slice(0, 0.1), stage, n, [&](Index u, auto &begins) {
        if (u == 0 || code(u) != code(u - 1))
            begins.push_back(u);
    });
    const Index cells = Index(cellBegin.size());
    cellBegin.push_back(n);

    Clusters c;
    AssignLarge(c.clusterOf, n, Index(0));
    std::vector<Index> clusterBegin(std::size_t(cells) + 1, 0);
    ParallelFor(progress.Slice(0.1, 0.4), stage, cells, 256, [&](std::size_t first, std::size_t last) {
        std::vector<Index> parent; // of each node of a cell, towards the first node of its component
        for (std::size_t cell = first; cell < last; ++cell) {
            const Index lo = cellBegin[cell], hi = cellBegin[cell + 1];
            auto root = [&](Index i) {
                while (parent[i] != i)
                    i = parent[i] = parent[parent[i]];
                return i;
            };
            parent.resize(hi - lo);
            for (Index u = lo; u < hi; ++u) {
                Index top = parent[u - lo] = u - lo;
                if (!takesPart(u))
                    continue;
                for (Index v : graph.adjacency[u]) {
                    if (v >= u) // neighbours are ascending
                        break;
                    if (v < lo || !takesPart(v))
                        continue;
                    const Index other = root(v - lo);
                    parent[std::max(top, other)] = std::min(top, other);
                    top = std::min(top, other);
                }
            }
            Index found = 0;
            for (Index u = lo; u < hi; ++u) // ascending: the parent's number is known
                c.clusterOf[u] = !takesPart(u)              ? -1
                                 : parent[u - lo] == u - lo ? found++
                                                            : c.clusterOf[lo + parent[u - lo]];
            clusterBegin[cell + 1] = found;
        }
    });
    for (Index cell = 0; cell < cells; ++cell)
        clusterBegin[cell + 1] += clusterBegin[cell];
    const Index clusters = clusterBegin[cells];
    c.graph.position = Eigen::Matrix3Xf::Zero(3, clusters);
    c.mass.assign(clusters, 0);
    c.extent.assign(clusters, 0);
    ParallelFor(progress.Slice(0.4, 0.5), stage, cells, 256, [&](std::size_t first, std::size_t last) {
        for (Index u = cellBegin[first]; u < cellBegin[last]; ++u) {
            while (u >= cellBegin[first + 1])
                ++first;
            if (c.clusterOf[u] >= 0)
                c.clusterOf[u] += clusterBegin[first];
        }
    });
    ParallelFor(progress.Slice(0.5, 0.7), stage, cells, 256, [&](std::size_t first, std::size_t last) {
        for (Index u = cellBegin[first]; u < cellBegin[last]; ++u) {
            if (c.clusterOf[u] < 0)
                continue;
            const float mass = std::max(nodes.mass[u], 1e-30f); // a cluster of nodes without mass has a place, too
            c.graph.position.col(c.clusterOf[u]) += mass * graph.position.col(u);
            c.mass[c.clusterOf[u]] += mass;
        }
        for (Index i = clusterBegin[first]; i < clusterBegin[last]; ++i)
            c.graph.position.col(i) /= c.mass[i];
        for (Index u = cellBegin[first]; u < cellBegin[last]; ++u) {
            if (c.clusterOf[u] < 0)
                continue;
            float &e = c.extent[c.clusterOf[u]];
            e = std::max(e, (graph.position.col(u) - c.graph.position.col(c.clusterOf[u])).norm() +
                                (nodes.extent.empty() ? 0 : nodes.extent[u]));
        }
    });
    c.graph.adjacency = QuotientGraph(graph.adjacency, c.clusterOf, clusters, progress.Slice(0.7, 1), stage);
    return c;
}

/// Lloyd's iteration on clusters of the nodes instead of the nodes: close to the patches wanted, at a fraction of the
/// cost. It is itself begun on coarser clusters. Leaves \p lloyd with grown patches and centres. Does nothing (and
/// leaves no centres) where there are not enough nodes to a cluster or clusters to a patch.
/// \param bits the finest cells tried have a side of 2^-bits, the coarsest of 2^-leastBits
/// \return the bits of the finest cells used where the iteration has converged, else 0
inline int SampleClusters(Lloyd &lloyd, const std::vector<Index> &seed, const PatchParam &param, int bits,
                          int leastBits, std::vector<SamplingStep> &history, const Progress &progress) {
    if (bits < leastBits)
        return 0;
    const Graph &graph = lloyd.graph;
    const Clusters clusters = MakeClusters(lloyd, bits, progress.Slice(0, 0.3));
    const Index count = clusters.graph.Size();
    if (count == 0 || count < 8 * Index(seed.size()))
        return 0;
    if (count > graph.Size() / 3)
        return SampleClusters(lloyd, seed, param, bits - 1, leastBits, history, progress.Slice(0.3, 1));
    progress(0.3, "Sampling patches");
    std::vector<Index> clusterSeed;
    const std::vector<Index> allTakePart;
    Lloyd coarse(clusters.graph, allTakePart, clusters.mass, progress.threads);
    coarse.extent = clusters.extent;
    for (float &e : coarse.extent)
        e *= 0.8f; // few nodes lie straight behind their cluster's barycentre
    std::vector<bool> taken(count, false);
    for (Index s : seed)
        if (!taken[clusters.clusterOf[s]]) {
            taken[clusters.clusterOf[s]] = true;
            clusterSeed.push_back(clusters.clusterOf[s]);
        }
    SampleClusters(coarse, clusterSeed, param, bits - 1, leastBits, history, progress.Slice(0.3, 0.5));
    if (coarse.center.empty())
        for (Index s : clusterSeed)
            coarse.center.push_back({s, clusters.graph.position.col(s)});
    const bool converged = coarse.Iterate(param, history, progress.Slice(0.5, 0.6));

    // On to the nodes: the one nearest each patch's barycentre.
    std::vector<Index> &patchOf = lloyd.grower.patchOf;
    patchOf.resize(graph.Size());
    ParallelFor(progress.Slice(0.6, 0.65), "Sampling patches", patchOf.size(), 1 << 16,
                [&](std::size_t first, std::size_t last) {
                    for (std::size_t u = first; u < last; ++u)
                        patchOf[u] = clusters.clusterOf[u] < 0 ? -1 : coarse.grower.patchOf[clusters.clusterOf[u]];
                });
    // The last step of the iteration may have added centres; they come with the nodes' own iteration.
    const Index patches = 1 + *std::max_element(coarse.grower.patchOf.begin(), coarse.grower.patchOf.end());
    lloyd.center.resize(patches);
    lloyd.UpdateCenters();

    // Only the border clusters of each patch are grown anew. The others keep their patch if they hang together with its
    // centre.
    std::vector<char> inner(count), kept(count, 0), front(count, 0);
    for (Index c = 0; c < count; ++c) {
        inner[c] = 1;
        for (Index n : clusters.graph.adjacency[c])
            inner[c] &= coarse.grower.patchOf[n] == coarse.grower.patchOf[c];
    }
    std::vector<Index> stack;
    for (Index p = 0; p < patches; ++p) {
        stack.assign(1, clusters.clusterOf[lloyd.center[p].node]);
        while (!stack.empty()) {
            const Index c = stack.back();
            stack.pop_back();
            if (!inner[c] || kept[c])
                continue;
            kept[c] = 1;
            for (Index n : clusters.graph.adjacency[c])
                stack.push_back(n);
        }
    }
    for (Index c = 0; c < count; ++c)
        for (Index n : clusters.graph.adjacency[c])
            front[c] |= kept[c] && !kept[n];
    const std::vector<Index> frontNodes =
        CollectInOrder(progress.Slice(0.65, 0.7), "Sampling patches", graph.Size(), [&](Index u, auto &nodes) {
            const Index c = clusters.clusterOf[u];
            if (c < 0)
                return;
            if (!kept[c])
                patchOf[u] = -1;
            else if (front[c])
                nodes.push_back(u);
        });
    lloyd.grower.GrowFrom(frontNodes, lloyd.center, param.targetRadius / 128, progress.Slice(0.7, 1));
    progress(1, "Sampling patches");
    lloyd.UpdateCenters();
    return converged ? bits : 0;
}

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
