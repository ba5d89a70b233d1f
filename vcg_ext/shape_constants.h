// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SHAPE_CONSTANTS_H
#define VCG_FCD_SHAPE_CONSTANTS_H

namespace vcg::fcd {

/// The constants that shape the result, beside the parameters that users set, each with its reason.
/// `tests/quality.sh --sensitivity` halves and doubles each of them.
struct ShapeConstants {
    /// Automatic D over the square root of the area per initial patch. Hexagons of that area have a circumradius of
    /// 0.62; patches of equal area that are not yet even reach a fifth farther.
    double patchRadius = 0.75;
    /// Square of the depth to which a held region's rotation gives way, over alpha A. Inside the region, Eq. 2 is the
    /// integral of 2 c |w|^2 + 2 alpha A |w'|^2 for a turn w against it, with c = 1 about the two axes in the surface
    /// and 2 about the normal: w falls to 1/e over the square root of alpha A / c. The mean of c is 4/3.
    double heldDepth = 0.75;
    /// Least weight of an edge, over the mean weight: patches that touch stay joined, and the system positive definite.
    double leastWeight = 0.01;
    /// Ridge of the fit in MatchTensors, over the mean response to the weights: decides what few edges, or edges in one
    /// plane, leave open. Responses that the edges decide are two to four times the mean.
    double tensorRidge = 0.1;
    /// The largest factor by which MatchTensors changes a weight, so that it stays positive and the system well
    /// conditioned. Bricks, the worst case, ask for 2 across and 0 along them.
    double mostTensorChange = 10;
    /// A held part that reaches no farther than this fraction of D from its middle is put into a patch of the free
    /// surface around it (OpenSmallParts). Beside a larger part, that surface is a patch by itself.
    double smallHeldPart = 0.5;
    /// Free surface surrounds a small held part if the flux into the part is below this fraction of its border:
    /// half-way between surrounded (0) and the end of a strip (1).
    double surrounded = 0.5;
    /// Width over which the blend runs over into held regions, over D. Below 2 the border shows as a crease, since the
    /// rotation of half a patch is made up in less than a patch; above 3 the free surface lags behind.
    double blendWidth = 2.5;
    /// The same around held vertices in a free patch, whose motion is that of the patch; over the radius of the patch.
    double smallBlendWidth = 1.5;
    /// Weight of a node's rotation in the fit of its linear map (FitLinear), over that of its edges: decides only what
    /// the edges leave open, across the surface.
    double openness = 0.1;
    /// A node keeps all of its weight up to this ratio of the distance along the surface to the straight distance:
    /// half-way round a cylinder it is pi / 2, and distances over the graph are somewhat longer ...
    double detour = 1.7;
    /// ... and has no weight from this ratio on: across a fold.
    double longDetour = 2.9;
    /// The least distance in that ratio, patch radii, so that the share of the weight changes over some patches.
    double nearby = 2.5;
    /// Radius of the balls that carry the shares from patches to vertices, patch radii: the least at which they
    /// overlap.
    double shareBall = 1.25;
};

} // namespace vcg::fcd

#endif
