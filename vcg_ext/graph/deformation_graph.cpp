// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/graph/border_weights.h>
#include <vcg_ext/graph/deformation_graph.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>

namespace vcg::fcd {

namespace detail {

void WeighBorders(const Quotient<Flux> &dual, GraphWeights weights, const ShapeConstants &shape, DeformationGraph &d) {
    const Index k = dual.adjacency.Size();
    d.graph.adjacency = dual.adjacency;
    const std::size_t items = d.graph.adjacency.item.size();
    d.edge.resize(3, items);
    d.weight.resize(items);
    for (Index i = 0; i < k; ++i)
        for (std::uint32_t e = d.graph.adjacency.begin[i]; e < d.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = d.graph.adjacency.item[e];
            const Flux &flux = dual.value[e];
            Eigen::Vector3d from = d.graph.position.col(i).cast<double>(), to = d.graph.position.col(j).cast<double>();
            if (flux.held[3] > 0 && BeyondPaper(weights).borders)
                (d.held[i] ? from : to) = flux.held.head<3>() / flux.held[3];
            const Eigen::Vector3d offset = from - to;
            d.edge.col(e) = offset.cast<float>();
            const double along = (i < j ? -1 : 1) * flux.flow.dot(offset);
            d.weight[e] = along > 0 ? float(along / offset.squaredNorm()) : 0.f;
        }
    if (weights != GraphWeights::Border) {
        d.weight.assign(items, 1);
        return;
    }
    MatchTensors(d.graph, d.edge, d.held, dual.value, shape, d.weight);
    const double total = std::accumulate(d.weight.begin(), d.weight.end(), 0.0);
    for (float &w : d.weight)
        w = total > 0 ? std::max(w, float(shape.leastWeight * total / double(items))) : 1;
}

} // namespace detail

DeformationGraph MakeDeformationGraph(const Graph &surface, const std::vector<Index> &tag,
                                      const std::vector<float> &area, const Patches &patches, GraphWeights weights,
                                      const Progress &progress, const ShapeConstants &shape) {
    using detail::Flux;
    const BeyondPaper beyond(weights);
    DeformationGraph d;
    const Index k = patches.Size();
    for (Index j = 0; j < k; ++j)
        d.held.push_back(patches.tag[j] != 1);
    const auto dual = QuotientGraph<Flux>(
        surface.adjacency, patches.patchOf, k,
        [&](Index u, Index v, Flux &flux) {
            const bool heldU = d.held[patches.patchOf[u]], heldV = d.held[patches.patchOf[v]];
            if (heldU && heldV)
                return false;
            flux.Add(detail::CotangentWeight(surface, u, v), surface.position.col(u).cast<double>(),
                     surface.position.col(v).cast<double>(), heldU, heldV);
            return true;
        },
        progress);
    d.radius = patches.radius;

    // A fixed number of parts, so that the sums do not depend on the number of threads.
    const std::size_t n = std::size_t(surface.Size()), parts = std::clamp<std::size_t>(n / (64 * k + 1), 1, 16);
    std::vector<Eigen::Matrix4Xd> sums(parts);
    ParallelFor(progress.threads, parts, 1, [&](std::size_t part, std::size_t) {
        Eigen::Matrix4Xd each = Eigen::Matrix4Xd::Zero(4, k);
        for (auto u = Index(n * part / parts); u < Index(n * (part + 1) / parts); ++u)
            if (patches.patchOf[u] >= 0)
                each.col(patches.patchOf[u]) += double(area[u]) * surface.position.col(u).cast<double>().homogeneous();
        sums[part] = std::move(each);
    });
    Eigen::Matrix4Xd sum = sums[0];
    for (std::size_t part = 1; part < parts; ++part)
        sum += sums[part];
    d.area.assign(std::size_t(k), 0);
    for (Index j = 0; j < k; ++j)
        d.area[j] = sum(3, j);
    d.graph.position.resize(3, k);
    for (Index j = 0; j < k; ++j) {
        const bool isPlaced = !beyond.barycenters || (!tag.empty() && tag[patches.center[j]] != 1) || !(sum(3, j) > 0);
        d.graph.position.col(j) = isPlaced ? Eigen::Vector3f(surface.position.col(patches.center[j]))
                                           : Eigen::Vector3f((sum.col(j).head<3>() / sum(3, j)).cast<float>());
    }

    detail::WeighBorders(dual, weights, shape, d);
    return d;
}

void AddHeldPatches(const Graph &surface, const std::vector<Index> &tag, Patches &patches, const Progress &progress) {
    if (tag.empty())
        return;
    const Index k = patches.Size();
    std::vector<Index> count(k, 0);
    for (Index p : patches.patchOf)
        if (p >= 0)
            ++count[p];
    const std::vector<Index> held = NumbersThat(progress, "Building the graph", surface.Size(), [&](Index u) {
        const auto isOfPatch = [&](Index v) { return patches.patchOf[v] >= 0; };
        const Csr::Row beside = surface.adjacency[u];
        return !isOfPatch(u) && std::any_of(beside.begin(), beside.end(), isOfPatch);
    });
    struct Member {
        Index patch, tag, alone, node;
        bool operator<(const Member &o) const {
            return std::tie(patch, tag, alone, node) < std::tie(o.patch, o.tag, o.alone, o.node);
        }
        bool SamePatch(const Member &o) const { return patch == o.patch && tag == o.tag && alone == o.alone; }
    };
    std::vector<Member> member;
    for (Index u : held) {
        Index nearest = -1;
        float least = std::numeric_limits<float>::infinity();
        for (Index v : surface.adjacency[u]) {
            const float d2 = (surface.position.col(v) - surface.position.col(u)).squaredNorm();
            if (patches.patchOf[v] >= 0 && d2 < least) {
                least = d2;
                nearest = patches.patchOf[v];
            }
        }
        if (nearest >= 0)
            member.push_back({nearest, tag[u], count[nearest] == 1 ? u : -1, u});
    }
    std::sort(member.begin(), member.end());
    for (std::size_t a = 0, b; a < member.size(); a = b) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (b = a; b < member.size() && member[b].SamePatch(member[a]); ++b)
            mean += surface.position.col(member[b].node).cast<double>();
        mean /= double(b - a);
        std::size_t center = a;
        const auto distance = [&](std::size_t i, const Eigen::Vector3d &x) {
            return (surface.position.col(member[i].node).cast<double>() - x).norm();
        };
        for (std::size_t i = a; i < b; ++i)
            if (distance(i, mean) < distance(center, mean))
                center = i;
        float radius = 0;
        for (std::size_t i = a; i < b; ++i) {
            patches.patchOf[member[i].node] = patches.Size();
            radius = std::max(radius, float(distance(i, surface.position.col(member[center].node).cast<double>())));
        }
        patches.center.push_back(member[center].node);
        patches.radius.push_back(radius);
        patches.tag.push_back(member[a].tag);
    }
}

} // namespace vcg::fcd
