// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SHAPE_CONSTANTS_H
#define VCG_FCD_SHAPE_CONSTANTS_H

namespace vcg::fcd {

/// What shapes the result beside the parameters that users set, each with its reason. `tests/quality.sh --sensitivity`
/// halves and doubles each of them.
struct ShapeConstants {
    /// Automatic D over the side of a square of the surface's area per initial patch. Hexagons of that area have a
    /// circumradius of 0.62 sides; patches of equal area that are not yet even reach a fifth farther.
    double patchRadius = 0.75;
    /// Square of the depth to which a held region's rotation gives way, over alpha A. In it, Eq. 2 is the integral of
    /// 2 c |w|^2 + 2 alpha A |w'|^2 for a turn w against what is held, with c = 1 for turns about the two axes in the
    /// surface and 2 about the normal: w falls to 1/e over the square root of alpha A / c. The mean of c is 4 / 3.
    double heldDepth = 0.75;
    /// Weight of an edge whose border turns its back to the line between the centres, over the mean weight. Patches
    /// that touch stay joined, and the system stays positive definite.
    double leastWeight = 0.01;
    /// What is added to each of the six responses of a patch's tensor to its edges' weights, over their mean: it
    /// decides what the edges leave open, across the surface and where they are few; within it, responses are twice to
    /// four times the mean.
    double tensorRidge = 0.1;
    /// A weight changes by no more than this factor for the tensors' sake, so that it stays positive and the system
    /// well conditioned. Bricks, the worst, ask for 2 across and 0 along them.
    double mostTensorChange = 10;
    /// Held parts that reach no farther than this fraction of D from their middle lie in a patch of the free surface
    /// around them: of a larger one, the surface beside it would be a patch of its own.
    double smallHeldPart = 0.5;
    /// A small held part is surrounded by free surface where what flows into it over its border is less than this
    /// fraction of the border; half of the way between surrounded (0) and the end of a strip (1).
    double surrounded = 0.5;
    /// Width of the run-over into held regions, D. Below 2 the border shows as a crease (the rotation of half a patch
    /// is made up in less than a patch), above 3 what is free lags behind.
    double blendWidth = 2.5;
    /// The same around held vertices in a patch of free ones, radii of that patch: their motion is that of the patch.
    double smallBlendWidth = 1.5;
    /// Weight of a node's rotation beside its edges where its linear map is fitted: decides what the edges leave open,
    /// across the surface, and no more.
    double openness = 0.1;
    /// A node keeps all its weight where the way along the surface is at most this often the straight one: half-way
    /// round a cylinder it is pi / 2 times, and ways over the graph are somewhat longer ...
    double detour = 1.7;
    /// ... and none from here on: across a fold.
    double longDetour = 2.9;
    /// Places nearer than this count as so far apart in that comparison, patch radii, so that the share changes over
    /// some patches.
    double nearby = 2.5;
    /// Radius of the balls that carry the shares from patches to vertices, patch radii: the least that overlap.
    double shareBall = 1.25;
};

} // namespace vcg::fcd

#endif
