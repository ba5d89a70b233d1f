// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_PATCHES_H
#define VCG_FCD_SURFACE_PATCHES_H

#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/surface/surface_graph.h>

namespace vcg::fcd {

/// By what the patches are balanced.
enum class PatchMeasure {
    Area,    ///< of the surface, however densely it is sampled
    Vertices ///< their number (paper, Eq. 1)
};

/// How the deformation graph is built.
struct GraphParam {
    double targetRadius = 0; ///< D, mesh units, >= 0; 0 = 0.75 sqrt(area / Patches()), of the area that can bend
    int initialPatches = 0;  ///< k0, >= 1; 0 = Patches(), and for a Deformer as many as the surface needs
    int maxIterations = 100; ///< >= 1
    double tolerance = 1e-3; ///< of the cost, [0, 1)
    unsigned randomSeed = 1;
    PatchMeasure measure = PatchMeasure::Area;

    /// How many to begin with: 300 where no number is given, and nothing asks for more or fewer.
    int Patches() const { return initialPatches > 0 ? initialPatches : 300; }

    /// \throw BadInput naming the value that is out of range
    void Validate() const;
};

/// D in frame units. \param patchRadius as in ShapeConstants
double TargetRadius(const SurfaceGraph &surface, const GraphParam &param, double patchRadius);

/// The patches of the nodes of tag 1 (no tags: of all). \param D frame units, > 0 \param rough as in PatchParam
/// \param kept as SamplePatches takes it
Patches SampleSurface(const SurfaceGraph &surface, const std::vector<Index> &tag, const GraphParam &param, double D,
                      const Progress &progress, bool rough = false, KeptClusters *kept = nullptr);

} // namespace vcg::fcd

#endif
