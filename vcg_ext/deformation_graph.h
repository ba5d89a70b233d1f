// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_GRAPH_H
#define VCG_FCD_DEFORMATION_GRAPH_H

#include "border_weights.h"
#include "graph.h"
#include "patch_sampling.h"
#include "progress.h"
#include "shape_constants.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numeric>
#include <tuple>
#include <vector>
#include <vcg/space/color4.h>

namespace vcg {
namespace fcd {

/// Weights w_ij of the deformation graph's edges.
enum class GraphWeights {
    Border,  ///< what flows over the common border of the two patches where a field rises by 1 from centre to centre
             ///< (its straight length over the centres' distance), so that around each node as much flows in every
             ///< direction as the surface carries. With a patch a vertex, the cotangent weights.
    Uniform, ///< 1 for every edge (paper, Eqs. 3 and 4)
    /// The same, with the nodes at the patches' central vertices and all edges from node to node (paper, sec. 2.1): a
    /// deformer with them keeps to what is printed in all else, too, to compare with it.
    Printed
};

/// The deformation graph: the dual graph of the patches, a node at each patch's centre (paper, sec. 2.1).
struct DeformationGraph {
    Graph graph;               ///< k nodes
    std::vector<float> weight; ///< w_ij of each adjacency item, symmetric, > 0
    std::vector<float> radius; ///< k, d_j: radius of the patch
    Eigen::Matrix3Xf edge;     ///< 3 x adjacency items, e_ij: from neighbour j to i. Between a held and a free patch it
                               ///< spans the free one only, to where the two touch: a held patch moves as one
    std::vector<char> held;    ///< k flags: of held patches; empty for none

    Index Size() const { return graph.Size(); }
    bool IsHeld(Index i) const { return !held.empty() && held[i]; }
};

/// The dual graph of \p patches over \p surface (n nodes) and its weights. A node is at the barycentre of its patch, or
/// at the patch's centre where that is held, the nodes have no area or the graph is as printed. Held patches (tag other
/// than 1) are not joined with each other: between them nothing deforms.
/// \param tag n values: 1 free, others held; empty: all free
/// \param area n values, >= 0: of the surface around each node
inline DeformationGraph MakeDeformationGraph(const Graph &surface, const std::vector<Index> &tag,
                                             const std::vector<float> &area, const Patches &patches,
                                             GraphWeights weights, const Progress &progress = {},
                                             const ShapeConstants &shape = {}) {
    using detail::Flux;
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
            const double w = detail::CotangentWeight(surface, u, v);
            const Eigen::Vector3d x = surface.position.col(u).cast<double>(),
                                  y = surface.position.col(v).cast<double>();
            flux.flow = w * (y - x);
            flux.moment = flux.flow * (heldU ? x : heldV ? y : Eigen::Vector3d(0.5 * (x + y))).transpose();
            if (heldU || heldV) // an edge that carries nothing, as across a square, still tells where the border is
                flux.held = std::max(1e-6, w) * (x - y).norm() * (heldU ? x : y).homogeneous();
            return true;
        },
        progress);
    d.graph.adjacency = dual.adjacency;
    d.radius = patches.radius;

    Eigen::Matrix4Xd sum = Eigen::Matrix4Xd::Zero(4, k);
    for (Index u = 0; u < surface.Size(); ++u)
        if (patches.patchOf[u] >= 0)
            sum.col(patches.patchOf[u]) += double(area[u]) * surface.position.col(u).cast<double>().homogeneous();
    d.graph.position.resize(3, k);
    for (Index j = 0; j < k; ++j) {
        const bool isPlaced =
            weights == GraphWeights::Printed || (!tag.empty() && tag[patches.center[j]] != 1) || !(sum(3, j) > 0);
        d.graph.position.col(j) = isPlaced ? Eigen::Vector3f(surface.position.col(patches.center[j]))
                                           : Eigen::Vector3f((sum.col(j).head<3>() / sum(3, j)).cast<float>());
    }

    const std::size_t items = d.graph.adjacency.item.size();
    d.edge.resize(3, items);
    d.weight.resize(items);
    for (Index i = 0; i < k; ++i)
        for (std::uint32_t e = d.graph.adjacency.begin[i]; e < d.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = d.graph.adjacency.item[e];
            const Flux &flux = dual.value[e];
            Eigen::Vector3d from = d.graph.position.col(i).cast<double>(), to = d.graph.position.col(j).cast<double>();
            if (flux.held[3] > 0 && weights != GraphWeights::Printed)
                (d.held[i] ? from : to) = flux.held.head<3>() / flux.held[3];
            const Eigen::Vector3d way = from - to;
            d.edge.col(e) = way.cast<float>();
            const double along = (i < j ? -1 : 1) * flux.flow.dot(way);
            d.weight[e] = along > 0 ? float(along / way.squaredNorm()) : 0.f;
        }
    if (weights != GraphWeights::Border) {
        d.weight.assign(items, 1);
        return d;
    }
    detail::MatchTensors(d.graph, d.edge, d.held, dual.value, shape, d.weight);
    const double total = std::accumulate(d.weight.begin(), d.weight.end(), 0.0);
    for (float &w : d.weight)
        w = total > 0 ? std::max(w, float(shape.leastWeight * total / double(items))) : 1;
    return d;
}

/// Makes patches of the held nodes (tag other than 1) with a free neighbour: each belongs to the patch of the nearest,
/// and those of one tag that do form one, so that it faces that patch. Beside a patch of one node, each is its own.
inline void AddHeldPatches(const Graph &surface, const std::vector<Index> &tag, Patches &patches,
                           const Progress &progress = {}) {
    if (tag.empty())
        return;
    const Index k = patches.Size();
    std::vector<Index> count(k, 0);
    for (Index p : patches.patchOf)
        if (p >= 0)
            ++count[p];
    const std::vector<Index> held =
        CollectInOrder(progress, "Building the graph", surface.Size(), [&](Index u, std::vector<Index> &found) {
            if (patches.patchOf[u] >= 0)
                return;
            for (Index v : surface.adjacency[u])
                if (patches.patchOf[v] >= 0) {
                    found.push_back(u);
                    return;
                }
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

/// A colour for each node, different from its neighbours' (as far as a node with more than eleven of them allows).
inline std::vector<vcg::Color4b> ContrastingColors(const Csr &adjacency) {
    // Twelve hues that stay apart from each other, the qualitative palette "Paired" of ColorBrewer in an order in which
    // consecutive entries differ clearly.
    static const unsigned char palette[12][3] = {{31, 120, 180},  {253, 191, 111}, {51, 160, 44},   {251, 154, 153},
                                                 {106, 61, 154},  {255, 255, 153}, {166, 206, 227}, {227, 26, 28},
                                                 {178, 223, 138}, {177, 89, 40},   {202, 178, 214}, {255, 127, 0}};
    std::vector<int> chosen(adjacency.Size(), -1);
    std::vector<vcg::Color4b> color(adjacency.Size());
    for (Index i = 0; i < adjacency.Size(); ++i) {
        int used[12] = {};
        for (Index j : adjacency[i])
            if (chosen[j] >= 0)
                ++used[chosen[j]];
        const int start = int(i * 5u % 12); // a walk through the palette, so that all of it is used
        int best = start;
        for (int c = 0; c < 12; ++c)
            if (used[(start + c) % 12] < used[best])
                best = (start + c) % 12;
        chosen[i] = best;
        color[i] = vcg::Color4b(palette[best][0], palette[best][1], palette[best][2], 255);
    }
    return color;
}

} // namespace fcd
} // namespace vcg

#endif
