// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SYMMETRIZE_H
#define VCG_FCD_SYMMETRIZE_H

#include <vcg_ext/fit.h>
#include <vcg_ext/symmetry/mirror_plane.h>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// \file
/// Restores the symmetry of a surface that was sheared, bent or pressed (retrodeformation): fits it onto its own mirror
/// image, and moves it half-way there. Parts without a counterpart on the other side are carried along.

namespace vcg::fcd {

/// A landmark: a point, and the vertex nearest to it.
struct SymmetryMark {
    std::size_t vertex;
    Eigen::Vector3d place; ///< world units; if the landmark is a vertex, its position
};

/// What is known of a surface's symmetry.
struct SymmetryGoal {
    std::optional<MirrorPlane> plane;               ///< world units; none: that of the landmarks, or the best one
    std::vector<std::array<SymmetryMark, 2>> pairs; ///< two landmarks that are mirror images of each other
    std::vector<SymmetryMark> midline;              ///< landmarks on the plane
};

/// How asymmetric the surface was, and how it was made symmetric. Lengths are in world units.
struct SymmetryReport {
    FitReport fit; ///< of the surface onto its mirror image; its landmarks are the pairs, each from both ends, then the
                   ///< midline, without those left out
    MirrorPlane plane;               ///< world units
    bool isGiven = false;            ///< the plane was given
    bool isOfLandmarks = false;      ///< the plane is that of the landmarks
    bool isSure = true;              ///< false: another plane is at least half as good
    double asymmetry = 0;            ///< distance of points from the mirror images of their counterparts: rms
    double asymmetryMost = 0;        ///< the largest one
    double moved = 0, movedMost = 0; ///< how far these points were moved: rms, largest
    double landmarks = 0; ///< largest distance of a landmark from its partner's mirror image, before PutPartners
    std::vector<std::size_t> contradicted; ///< pairs, then midline points, numbered from 0, that the others contradict
    bool leftOut = false; ///< these were not followed, since there is a tolerance; they count nowhere else

    /// Names the landmarks that the others contradict, and says what to do; empty if there are none. \param pairs of
    /// the goal: their number
    std::string Contradiction(std::size_t pairs) const;
};

/// The poses of a symmetrized surface.
struct SymmetricPose {
    Deformer::Pose half;   ///< the symmetric one
    Deformer::Pose mirror; ///< the surface on its mirror image: each point at the mirror image of its counterpart
    Deformer::Pose fitted; ///< the fit to target, for Fitter::Compare: points that lie on target have a counterpart
    std::shared_ptr<const FitTarget> target;
};

/// Makes the surface of \p fitter, all of which is free, symmetric.
/// \param source, normal, world, weight as \p fitter was made with
/// \throw BadInput landmarks that are no vertices, or named twice; a plane without a direction; no plane is given, and
/// none is better than any other \throw Unsolvable the fit cannot be solved \throw Cancelled
SymmetricPose Symmetrize(const Fitter &fitter, const SurfaceView &source, const NormalOf &normal,
                         const Eigen::Affine3d &world, const SymmetryGoal &goal, SymmetryReport &report,
                         const Progress &progress = {}, const WeightOf &weight = {});

/// The distance of a surface from its mirror image, root mean square over the nearest nine tenths of what has a
/// counterpart, world units; 0 if nothing has. \param matched flags of vertex slots: those that have a counterpart
/// \param position 3 x vertex slots, mesh units \throw Cancelled
double DistanceFromMirror(const Fitter &fitter, const SurfaceView &source, const NormalOf &normal,
                          const Eigen::Affine3d &world, const MirrorPlane &plane, const std::vector<char> &matched,
                          const PositionsRef &position, const Progress &progress = {}, const WeightOf &weight = {});

/// Moves landmarks that are vertices, by rounding only, so that each is exactly the mirror image of its partner.
/// \param position in, out: 3 x vertex slots, mesh units: of SymmetricPose::half
void PutPartners(const Fitter &fitter, const SurfaceView &source, const Eigen::Affine3d &world,
                 const SymmetryGoal &goal, const SymmetryReport &report, Eigen::Ref<Eigen::Matrix3Xd> position);

} // namespace vcg::fcd

#endif
