// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SYMMETRIZE_H
#define VCG_FCD_SYMMETRIZE_H

#include <vcg_ext/fit.h>
#include <vcg_ext/symmetry/mirror_plane.h>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

/// \file
/// Restores the symmetry of what was sheared, bent or pressed: fits the surface onto its own mirror image and goes half
/// of the way (retrodeformation). What has no counterpart on the other side is carried along.

namespace vcg::fcd {

/// A landmark: a place, and the vertex that is nearest to it and stands for it.
struct SymmetryMark {
    std::size_t vertex;
    Eigen::Vector3d place; ///< in the world; that of the vertex where that is the landmark
};

/// What is known of a surface's symmetry.
struct SymmetryGoal {
    std::optional<MirrorPlane> plane;               ///< in the world; else that of the landmarks, else the best one
    std::vector<std::array<SymmetryMark, 2>> pairs; ///< the two of each are mirror images of each other
    std::vector<SymmetryMark> midline;              ///< that belong on the plane
};

/// How asymmetric the surface was, and what was done. Lengths are in world units.
struct SymmetryReport {
    FitReport fit; ///< of the surface onto its mirror image; its landmarks are the pairs, each from both ends, then the
                   ///< midline
    MirrorPlane plane;               ///< in the world
    bool isGiven = false;            ///< the plane was given
    bool isOfLandmarks = false;      ///< the plane is that of the landmarks
    bool isSure = true;              ///< false: another plane is nearly as good
    double way = 0, wayMost = 0;     ///< distance of places from the mirror images of their counterparts: rms, most
    double moved = 0, movedMost = 0; ///< how far these places were moved: root mean square, most
    double landmarks = 0; ///< largest distance of a landmark from its partner's mirror image, before PutPartners
    std::vector<std::size_t>
        contradicted; ///< numbers of pairs, then midline points, from 0, that the others contradict
};

/// A surface that has become symmetric.
struct SymmetricPose {
    Deformer::Pose half;   ///< symmetric
    Deformer::Pose mirror; ///< each place is where the mirror image of its counterpart is
    Deformer::Pose fitted; ///< for Fitter::Compare with the target: what lies on it has a counterpart
    std::shared_ptr<const FitTarget> target;
};

/// Symmetrizes the surface that \p fitter is of, all of which is free.
/// \param source, normal, world, weight as \p fitter was made with
/// \throw BadInput landmarks that are no vertices, or named twice; a plane without a direction \throw Unsolvable
/// \throw Cancelled
SymmetricPose Symmetrize(const Fitter &fitter, const SurfaceView &source, const NormalOf &normal,
                         const Eigen::Affine3d &world, const SymmetryGoal &goal, SymmetryReport &report,
                         const Progress &progress = {}, const WeightOf &weight = {});

/// How far a surface is from its mirror image, root mean square over the nearest nine tenths of it, world units.
/// \param position 3 x vertex slots, mesh units \throw Cancelled
double DistanceFromMirror(const Fitter &fitter, const SurfaceView &source, const NormalOf &normal,
                          const Eigen::Affine3d &world, const MirrorPlane &plane, const PositionsRef &position,
                          const Progress &progress = {}, const WeightOf &weight = {});

/// Puts landmarks that are vertices exactly where each is the mirror image of its partner.
/// \param position 3 x vertex slots, mesh units: that of the pose
void PutPartners(const Fitter &fitter, const SurfaceView &source, const Eigen::Affine3d &world,
                 const SymmetryGoal &goal, const SymmetryReport &report, Eigen::Ref<Eigen::Matrix3Xd> position);

} // namespace vcg::fcd

#endif
