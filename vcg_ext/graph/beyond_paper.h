// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_BEYOND_PAPER_H
#define VCG_FCD_BEYOND_PAPER_H

namespace vcg::fcd {

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

/// The steps that go beyond what the paper prints. Here alone it is decided that there are none in the mode that
/// compares with it; elsewhere each is asked for by its name.
struct BeyondPaper {
    bool barycenters;  ///< nodes at the barycentres of their patches, not at their central vertices (sec. 2.1)
    bool borders;      ///< edges to constrained patches end at the border, not at the node (sec. 2.1)
    bool surfaceBalls; ///< influence along the surface, if asked for, not in straight balls (Eq. 8)
    bool compliance;   ///< the rotation of what is constrained gives way, with the depth (Eq. 5)
    bool acceleration; ///< accelerated steps, if asked for (Eqs. 5 and 6)
    bool steps;        ///< a pose that turns far is reached in steps (sec. 2.2)
    bool refinement;   ///< more patches where few make another shape (sec. 2.1)
    bool linearMaps;   ///< nodes stretch as their edges do, and not only rotate (Eq. 7)
    bool
        smoothMapping; ///< a blend of second order with smooth weights, which runs into what is constrained (Eqs. 7, 8)

    explicit BeyondPaper(GraphWeights weights = GraphWeights::Border) {
        barycenters = borders = surfaceBalls = compliance = acceleration = steps = refinement = linearMaps =
            smoothMapping = weights != GraphWeights::Printed;
    }
};

} // namespace vcg::fcd

#endif
