// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_GRAPH_H
#define VCG_FCD_DEFORMATION_GRAPH_H

#include "patch_sampling.h"

#include <Eigen/Geometry>
#include <vcg/space/color4.h>

namespace vcg {
namespace fcd {

/// Weights w_ij of the deformation graph's edges.
enum class GraphWeights {
    Border, ///< length of the common border of the two patches over the distance of their centres, mean 1: what the
            ///< Laplacian of a Voronoi partition has
    Uniform ///< 1 for every edge (paper, Eqs. 3 and 4)
};

/// The deformation graph: the dual graph of the patches, a node at each patch's centre (paper, sec. 2.1).
struct DeformationGraph {
    Graph graph;               ///< k nodes
    std::vector<float> weight; ///< w_ij of each adjacency item, symmetric, > 0
    std::vector<float> radius; ///< k, d_j: radius of the patch
    Eigen::Matrix3Xf edge;     ///< 3 x adjacency items, e_ij: from neighbour j to i. Between a held and a free patch it
                               ///< spans the free one only: a held patch is rigid up to its border

    Index Size() const { return graph.Size(); }
};

namespace detail {

/// The edges of \p d between the centres of the patches, but those between a held and a free patch (tag 1), which end
/// at the mean of the held nodes where the two touch.
inline void MakeEdges(const Graph &surface, const Patches &patches, DeformationGraph &d, const Progress &progress) {
    const Csr &adjacency = d.graph.adjacency;
    const Index k = d.Size();
    d.edge.resize(3, adjacency.item.size());
    for (Index i = 0; i < k; ++i)
        for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e)
            d.edge.col(e) = d.graph.position.col(i) - d.graph.position.col(adjacency.item[e]);
    auto free = [&](Index j) { return patches.tag[j] == 1; };
    if (std::all_of(patches.tag.begin(), patches.tag.end(), [](Index tag) { return tag == 1; }))
        return;

    auto itemOf = [&](Index i, Index j) { // of neighbour j in the row of i
        const auto first = adjacency.item.begin();
        return std::lower_bound(first + adjacency.begin[i], first + adjacency.begin[i + 1], j) - first;
    };
    const std::vector<Index> held =
        CollectInOrder(progress, "Building the graph", surface.Size(), [&](Index u, std::vector<Index> &found) {
            if (free(patches.patchOf[u]))
                return;
            for (Index v : surface.adjacency[u])
                if (free(patches.patchOf[v])) {
                    found.push_back(u);
                    return;
                }
        });
    std::vector<Eigen::Vector4d> border(adjacency.item.size(), Eigen::Vector4d::Zero()); // sum and count
    for (Index u : held)
        for (Index v : surface.adjacency[u])
            if (free(patches.patchOf[v]))
                border[itemOf(patches.patchOf[u], patches.patchOf[v])] +=
                    surface.position.col(u).cast<double>().homogeneous();
    for (Index i = 0; i < k; ++i)
        for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e)
            if (border[e][3] > 0) {
                const Index j = adjacency.item[e];
                d.edge.col(e) = (border[e].head<3>() / border[e][3]).cast<float>() - d.graph.position.col(j);
                d.edge.col(itemOf(j, i)) = -d.edge.col(e);
            }
}

} // namespace detail

/// \param averageEdge mean edge length of \p surface
inline DeformationGraph MakeDeformationGraph(const Graph &surface, const Patches &patches, double averageEdge,
                                             GraphWeights weights, const Progress &progress = {}) {
    DeformationGraph d;
    const Index k = patches.Size();
    Quotient dual = QuotientGraph(surface.adjacency, patches.patchOf, k, progress);
    d.graph.adjacency = std::move(dual.adjacency);
    d.graph.position.resize(3, k);
    for (Index j = 0; j < k; ++j)
        d.graph.position.col(j) = surface.position.col(patches.center[j]);
    d.radius = patches.radius;
    detail::MakeEdges(surface, patches, d, progress);
    d.weight.assign(d.graph.adjacency.item.size(), 1);
    if (weights == GraphWeights::Uniform || d.weight.empty())
        return d;
    double sum = 0;
    for (Index i = 0; i < k; ++i)
        for (std::uint32_t e = d.graph.adjacency.begin[i]; e < d.graph.adjacency.begin[i + 1]; ++e) {
            const Index j = d.graph.adjacency.item[e];
            const float least = 0.1f * std::min(d.radius[i], d.radius[j]); // a centre may lie at the border
            d.weight[e] = float(dual.crossings[e] * averageEdge / 2) / std::max({d.edge.col(e).norm(), least, 1e-6f});
            sum += d.weight[e];
        }
    const float scale = float(double(d.weight.size()) / sum);
    for (float &w : d.weight)
        w *= scale;
    return d;
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
