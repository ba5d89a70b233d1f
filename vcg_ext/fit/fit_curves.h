// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_CURVES_H
#define VCG_FCD_FIT_CURVES_H

#include <vcg_ext/fit/fit_samples.h>
#include <vcg_ext/fit/fit_system.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// A line lies elsewhere if it is farther than this (of the diagonal) from a surface. A line on the surface, or on a
/// thinned or slightly posed copy, is about an edge from its vertices; one in other units, or of another layer, is not.
constexpr double farFromAll = 0.1;

/// A curve of the target, and the vertices of the source that belong on it, wherever along it.
struct Curve {
    std::vector<std::size_t> vertex;     ///< slots of free vertices, in any order
    std::vector<Eigen::Vector3d> target; ///< corners of a polyline, at least two; closed if the last is the first
    /// Of each vertex: from it to the point beside it, at rest, that belongs on the curve; world units, and frame units
    /// in FitTarget, as target. Empty: the vertices themselves belong on it.
    std::vector<Eigen::Vector3d> offset;
};

/// Draws samples of a surface to curves.
class FitCurves {
  public:
    /// Adds samples for the vertices of each curve, one at a node.
    /// \param curves frame units; must outlive this \param nodeOf of each vertex slot, -1: none
    /// \throw BadInput a vertex that is none or not free, fewer than two corners, all at one position, one that is not
    /// finite, or another number of offsets than of vertices
    FitCurves(const std::vector<Curve> &curves, const std::vector<Index> &nodeOf, const RegionDeformer &deformer,
              const RegionPose &pose, FitSamples &samples);

    /// Sets the pulls of these samples: each to the nearest point of its curve, but not along the curve, so that it can
    /// slide. Beyond an end of an open curve, it is drawn to the end. (Drawn along, as matches are, samples would hold
    /// each other back.) \param pull out, of all samples; only those of curves are set
    void Find(const FitSamples &samples, const GraphPose &pose, std::vector<FitSystem::Pull> &pull) const;

    /// The largest distance of a sample from its curve, frame units; 0 without samples.
    double Farthest(const FitSamples &samples, const GraphPose &pose) const;

  private:
    const std::vector<Curve> &curves;
    std::vector<std::vector<Eigen::AlignedBox3d>> boxes; ///< of each curve, around some segments each
    std::size_t first;                                   ///< number of the first sample of a curve
    std::vector<std::size_t> curveOf;                    ///< the curve of each sample from the first on
};

} // namespace vcg::fcd

#endif
