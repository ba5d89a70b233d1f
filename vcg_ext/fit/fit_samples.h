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

/// Nodes of a surface whose positions in a pose are linear in the nodes of its deformation graph, frame units:
/// x = fixed + sum_k weight_k (R_k lever_k + p'_k). This is the mapping of GraphMapping, with R(p) as a sum, too.
struct FitSamples {
    struct Term {
        Index node; ///< of the deformation graph
        double weight;
        Eigen::Vector3d lever;
    };
    std::vector<Index> surfaceNode;
    std::vector<std::uint32_t> begin{0}; ///< of the terms of each sample
    std::vector<Term> term;
    std::vector<Eigen::Vector3d> fixed;  ///< share of the held surface nearby
    std::vector<Eigen::Vector3d> normal; ///< at rest, of length 1; 0: unknown
    std::vector<double> weight;          ///< how much its match counts, (0, 1]
    bool isAffine = false;               ///< the nodes' maps are affine, not rotations

    std::size_t Size() const { return surfaceNode.size(); }
    /// Keeps the first \p size samples.
    void Shrink(std::size_t size);
    /// The samples from number \p first on.
    FitSamples From(std::size_t first) const;

    /// Adds a sample. \param pose with the motions of held surface \param offset from the node to the sample at rest,
    /// frame units
    void Add(const RegionDeformer &deformer, const RegionPose &pose, Index node,
             const Eigen::Vector3d &offset = Eigen::Vector3d::Zero());
    /// The position of sample \p s in a pose.
    Eigen::Vector3d At(std::size_t s, const GraphPose &pose) const;
    /// The positions of the first \p count samples.
    std::vector<Eigen::Vector3d> Places(std::size_t count, const GraphPose &pose) const;
    /// The normal of sample \p s in a pose, of length 1; 0: unknown.
    Eigen::Vector3d NormalAt(std::size_t s, const GraphPose &pose) const;
};

/// How much the match of a vertex slot counts: 0 is carried and not matched, 1 counts fully.
using WeightOf = std::function<double(std::size_t slot)>;

/// The weight of a vertex. \param what name of the surface, for messages \throw BadInput it is outside of [0, 1]
float CheckedWeight(const WeightOf &weight, std::size_t slot, const char *what);

/// Of each node of the surface, the least weight of its vertices. \throw BadInput a weight outside of [0, 1]
std::vector<float> WeightsAtNodes(const SurfaceView &mesh, const WeightOf &weight, const Deformer &deformer);

/// \throw BadInput \p samples is below 100 or above a million
void ValidateSamples(int samples);

/// About \p wanted free nodes of a surface that stand for the same area each.
/// \param weight of each node of the surface: only nodes above 0 are used; empty: all
std::vector<Index> EvenSample(const RegionDeformer &deformer, std::size_t wanted,
                              const std::vector<float> &weight = {});

/// The normals of the surface at some nodes: of the faces or, in a cloud, \p normal. Frame units, length 1, or 0.
std::vector<Eigen::Vector3d> NormalsAtNodes(const SurfaceView &mesh, const NormalOf &normal, const Deformer &deformer,
                                            const std::vector<Index> &node, const Progress &progress = {});

} // namespace vcg::fcd

#endif
