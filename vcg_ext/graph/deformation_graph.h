// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMATION_GRAPH_H
#define VCG_FCD_DEFORMATION_GRAPH_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/graph/beyond_paper.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/shape_constants.h>

#include <Eigen/Core>
#include <vector>

namespace vcg::fcd {

/// The deformation graph: the dual graph of the patches, a node at each patch's centre (paper, sec. 2.1).
struct DeformationGraph {
    Graph graph;               ///< k nodes
    std::vector<float> weight; ///< w_ij of each adjacency item, symmetric, > 0
    std::vector<float> radius; ///< k, d_j: radius of the patch
    std::vector<double> area;  ///< k, of the patch, frame units^2; empty: not known
    Eigen::Matrix3Xf edge;  ///< 3 x adjacency items, e_ij: from neighbour j to i. Between a free and a held patch, it
                            ///< ends at their common border, since a held patch moves as one
    std::vector<char> held; ///< k flags of held patches; empty: none

    Index Size() const { return graph.Size(); }
    bool IsHeld(Index i) const { return !held.empty() && held[i]; }
};

/// The dual graph of \p patches over \p surface (n nodes), with its weights. A node is at the barycentre of its patch,
/// or at the central vertex if the patch is held or has no area, or with GraphWeights::Printed. There are no edges
/// between held patches (tag other than 1): nothing deforms between them.
/// \param tag n values: 1 free, others held; empty: all free
/// \param area n values, >= 0: of the surface around each node
DeformationGraph MakeDeformationGraph(const Graph &surface, const std::vector<Index> &tag,
                                      const std::vector<float> &area, const Patches &patches, GraphWeights weights,
                                      const Progress &progress = {}, const ShapeConstants &shape = {});

/// Adds patches of the held nodes (tag other than 1) that have a free neighbour. Held nodes form one patch if they have
/// one tag and their nearest free neighbours are in one free patch. Beside a patch of a single node, each held node is
/// a patch.
void AddHeldPatches(const Graph &surface, const std::vector<Index> &tag, Patches &patches,
                    const Progress &progress = {});

} // namespace vcg::fcd

#endif
