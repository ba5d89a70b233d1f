// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_SAMPLES_H
#define VCG_FCD_FIT_SAMPLES_H

#include <vcg_ext/deformer.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace vcg::fcd {

/// Where in a pose some nodes of a surface are, and how that depends on the nodes of its deformation graph, in the
/// frame: x = fixed + sum_k weight_k (R_k lever_k + c'_k). It is the mapping of GraphMapping, in which R(p) is a sum,
/// too.
struct FitSamples {
    struct Term {
        Index node; ///< of the deformation graph
        double weight;
        Eigen::Vector3d lever;
    };
    std::vector<Index> surfaceNode;
    std::vector<std::uint32_t> begin{0}; ///< of the terms of each
    std::vector<Term> term;
    std::vector<Eigen::Vector3d> fixed;  ///< what held regions nearby give
    std::vector<Eigen::Vector3d> normal; ///< at rest, of length 1; 0 where it is not known
    std::vector<double> weight;          ///< how much its match counts, (0, 1]
    bool isAffine = false;               ///< the nodes' maps stretch, too

    std::size_t Size() const { return surfaceNode.size(); }
    /// Leaves the first \p size of them.
    void Shrink(std::size_t size);
    /// Those from number \p first on.
    FitSamples From(std::size_t first) const;

    /// \param pose gives the motions of what is held \param offset at rest, frame units: of a place that goes with the
    /// surface at the node
    void Add(const RegionDeformer &deformer, const RegionPose &pose, Index node,
             const Eigen::Vector3d &offset = Eigen::Vector3d::Zero());
    Eigen::Vector3d At(std::size_t s, const GraphPose &pose) const;
    /// Those of the first \p count.
    std::vector<Eigen::Vector3d> Places(std::size_t count, const GraphPose &pose) const;
    /// The normal in a pose, of length 1; 0 where it is not known.
    Eigen::Vector3d NormalAt(std::size_t s, const GraphPose &pose) const;
};

/// How much the match of a vertex slot counts: 0 is carried and not matched, 1 counts fully.
using WeightOf = std::function<double(std::size_t slot)>;

/// That of a vertex. \param what has it, in words \throw BadInput a number outside 0 to 1
float CheckedWeight(const WeightOf &weight, std::size_t slot, const char *what);

/// Of each node of the surface, the least of its vertices. \throw BadInput a number outside 0 to 1
std::vector<float> WeightsAtNodes(const SurfaceView &mesh, const WeightOf &weight, const Deformer &deformer);

/// \throw BadInput fewer than 100 places of a surface, or more than a million, to be matched
void ValidateSamples(int samples);

/// Free nodes of a surface that stand for the same area each. \param wanted how many, about
/// \param weight of each node of the surface: only of those above 0; empty: of all
std::vector<Index> EvenSample(const RegionDeformer &deformer, std::size_t wanted,
                              const std::vector<float> &weight = {});

/// The normals of the surface at nodes, from the faces, or where there are none, from \p normal; in the frame.
std::vector<Eigen::Vector3d> NormalsAtNodes(const SurfaceView &mesh, const NormalOf &normal, const Deformer &deformer,
                                            const std::vector<Index> &node, const Progress &progress = {});

} // namespace vcg::fcd

#endif
