// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_PATCHES_H
#define VCG_FCD_SURFACE_PATCHES_H

#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/surface/surface_graph.h>

namespace vcg::fcd {

/// What the patches have equal shares of.
enum class PatchMeasure {
    Area,    ///< the area of the surface, whatever its sampling
    Vertices ///< the number of vertices (paper, Eq. 1)
};

/// How the deformation graph is built.
struct GraphParam {
    double targetRadius = 0; ///< D, world units, >= 0; 0 = 0.75 sqrt(area / Patches()), of the area that can bend
    int initialPatches = 0;  ///< k0, >= 1; 0 = Patches(), and automatic in a Deformer (PatchesFor)
    int maxIterations = 100; ///< >= 1
    double tolerance = 1e-3; ///< as in PatchParam, [0, 1)
    unsigned randomSeed = 1;
    PatchMeasure measure = PatchMeasure::Area;

    /// The number of seeds: the given number, or else 300.
    int Patches() const { return initialPatches > 0 ? initialPatches : 300; }

    /// \throw BadInput naming the value that is out of range
    void Validate() const;
};

/// D, frame units. \param patchRadius as in ShapeConstants
double TargetRadius(const SurfaceGraph &surface, const GraphParam &param, double patchRadius);

/// SamplePatches of the nodes of tag 1 (without tags: all). \param D frame units, > 0 \param rough as in PatchParam
/// \param kept as in SamplePatches
Patches SampleSurface(const SurfaceGraph &surface, const std::vector<Index> &tag, const GraphParam &param, double D,
                      const Progress &progress, bool rough = false, KeptClusters *kept = nullptr);

} // namespace vcg::fcd

#endif
