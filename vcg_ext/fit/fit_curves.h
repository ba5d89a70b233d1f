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

/// Of the diagonal: a line on a surface is no farther from its vertices than its edges are long, and one on a copy of
/// it, thinned or posed a little, hardly; in other units, or of another layer, it is.
constexpr double farFromAll = 0.1;

/// A curve of the target, and the vertices of the source that lie on it, wherever along it.
struct Curve {
    std::vector<std::size_t> vertex;     ///< slots of free vertices, in any order
    std::vector<Eigen::Vector3d> target; ///< two corners at least of a polyline; closed where the last is the first
    /// Of each vertex, from it to the place of the source, at rest, that lies on the curve and goes with it; empty: the
    /// vertices themselves. World units.
    std::vector<Eigen::Vector3d> offset;
};

/// Of curves, what draws samples of a surface to them.
class FitCurves {
  public:
    /// Adds samples for the vertices of each curve, one at a node.
    /// \param curves with places in the frame \param nodeOf of each vertex slot, -1 where it has none
    /// \throw BadInput a vertex that is none or not free, less than two corners, all at one place, one that is not
    /// finite, or offsets that are not one for each vertex
    FitCurves(const std::vector<Curve> &curves, const std::vector<Index> &nodeOf, const RegionDeformer &deformer,
              const RegionPose &pose, FitSamples &samples);

    /// What draws the samples that were added, each across its curve to the nearest place there. Along the curve it is
    /// free, except the end of an open one, which none leaves. (Drawn along as matches are, they would hold each other
    /// where they are.) \param pull out: of all samples
    void Find(const FitSamples &samples, const GraphPose &pose, std::vector<FitSystem::Pull> &pull) const;

    /// The largest distance of such a sample from its curve, frame units; 0 without any.
    double Farthest(const FitSamples &samples, const GraphPose &pose) const;

  private:
    const std::vector<Curve> &curves;
    std::vector<std::vector<Eigen::AlignedBox3d>> boxes; ///< of each curve, of some segments each
    std::size_t first;                                   ///< sample
    std::vector<std::size_t> curveOf;                    ///< of each sample from there on
};

} // namespace vcg::fcd

#endif
