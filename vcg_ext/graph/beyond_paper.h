// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_BEYOND_PAPER_H
#define VCG_FCD_BEYOND_PAPER_H

namespace vcg::fcd {

/// How the weights w_ij of the deformation graph's edges are chosen.
enum class GraphWeights {
    Border,  ///< the flux, through the common border of the two patches, of a linear field that rises by 1 from centre
             ///< to centre; corrected so that each node's edges carry as much as the surface in every direction
             ///< (MatchTensors). With one vertex a patch, these are the cotangent weights.
    Uniform, ///< 1 for every edge (paper, Eqs. 3 and 4)
    /// As Uniform, for the paper to the letter: nodes at the patches' central vertices, edges from node to node (paper,
    /// sec. 2.1), and none of the steps in BeyondPaper.
    Printed
};

/// The steps beyond the paper. All are on, except with GraphWeights::Printed, where all are off. Ask for a step by its
/// name, not for the weights.
struct BeyondPaper {
    bool barycenters;   ///< nodes at the barycentres of their patches, not at their central vertices (sec. 2.1)
    bool borders;       ///< edges to held patches end at the border, not at the node (sec. 2.1)
    bool surfaceBalls;  ///< allows distances along the surface in the mapping's weights, not only straight ones (Eq. 8)
    bool compliance;    ///< constrained nodes may have free rotations, drawn to their region's rotation (Eq. 5)
    bool acceleration;  ///< allows accelerated steps (Eqs. 5 and 6)
    bool steps;         ///< a pose with large turns is reached in steps (sec. 2.2)
    bool refinement;    ///< allows an automatic number of patches, by the estimated error (sec. 2.1)
    bool linearMaps;    ///< nodes stretch as their edges do, they do not only rotate (Eq. 7)
    bool smoothMapping; ///< a blend of second order with smooth weights, which runs over into held surface (Eqs. 7, 8)

    explicit BeyondPaper(GraphWeights weights = GraphWeights::Border) {
        barycenters = borders = surfaceBalls = compliance = acceleration = steps = refinement = linearMaps =
            smoothMapping = weights != GraphWeights::Printed;
    }
};

} // namespace vcg::fcd

#endif
