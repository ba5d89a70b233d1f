// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/patches/surface_patches.h>

#include <algorithm>
#include <cmath>

namespace vcg::fcd {

void GraphParam::Validate() const {
    if (!(targetRadius >= 0) || std::isinf(targetRadius))
        throw BadInput("The target radius must be 0 (automatic) or a positive, finite length.");
    if (initialPatches < 0)
        throw BadInput("The number of initial patches must be at least 1, or 0 for as many as are needed.");
    if (maxIterations < 1)
        throw BadInput("The maximum number of iterations must be at least 1.");
    if (!(tolerance >= 0 && tolerance < 1))
        throw BadInput("The tolerance of the patches must be at least 0 and below 1.");
}

double TargetRadius(const SurfaceGraph &surface, const GraphParam &param, double patchRadius) {
    if (param.targetRadius > 0) { // no patch reaches farther than the surface is large
        const Eigen::Matrix3Xf &at = surface.graph.position;
        const double all = at.cols() > 1 ? double((at.rowwise().maxCoeff() - at.rowwise().minCoeff()).norm()) : 0;
        const double asked = param.targetRadius / surface.frame.scale;
        return all > 0 ? std::min(asked, all) : asked;
    }
    const double automatic = patchRadius * std::sqrt(surface.area / param.Patches());
    return automatic > 0 ? automatic : surface.averageEdge > 0 ? surface.averageEdge : 1; // no surface
}

Patches SampleSurface(const SurfaceGraph &surface, const std::vector<Index> &tag, const GraphParam &param, double D,
                      const Progress &progress, bool rough, KeptClusters *kept) {
    PatchParam p;
    p.targetRadius = D;
    p.initialPatches = param.Patches();
    p.maxIterations = param.maxIterations;
    p.tolerance = param.tolerance;
    p.randomSeed = param.randomSeed;
    p.rough = rough;
    static const std::vector<float> none;
    return SamplePatches(surface.graph, tag, param.measure == PatchMeasure::Area ? surface.nodeArea : none, p, progress,
                         kept);
}

} // namespace vcg::fcd
