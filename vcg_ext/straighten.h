// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_STRAIGHTEN_H
#define VCG_FCD_STRAIGHTEN_H

#include <vcg_ext/deformer.h>
#include <vcg_ext/line/line_motion.h>

#include <Eigen/Geometry>
#include <string>
#include <utility>
#include <vector>

/// \file
/// Straightens a surface along a line, or bends it along another line. The nodes of its deformation graph move with
/// their cross-sections of the line. Where that would fold or tear the surface, it follows as rigidly as possible.

namespace vcg::fcd {

/// How a surface is straightened: all of it is free, and bends.
struct StraightenParam : DeformationParam {
    StraightenParam();
};

/// How a surface was straightened.
struct StraightenReport {
    double length = 0, newLength = 0; ///< of the line, before and after, world units
    double jitter = 0;       ///< jitter of the line's points that was removed: rms in each direction, world units
    bool isMiddle = false;   ///< the line through the middles of the cross-sections was used
    bool leftMiddle = false; ///< it was asked for, and not used, since it stretches the surface more
    /// By what share cross-sections get longer or shorter along the line than the line itself, rms: 0 for a line
    /// through their middles.
    double lengthening = 0;
    /// It is more than 0.03, and would be less along the line through their middles, which was not asked for.
    bool isBeside = false;
    double twist = 0;                  ///< of the surface about the line, from end to end, degrees; 0 if not measured
    Index following = 0, released = 0; ///< nodes that move with the line; nodes that would fold or tear, and do not
    std::vector<std::pair<double, double>> releasedAt; ///< where the latter are along the line: from, to, world units
    double rms = 0, largest = 0; ///< distance of the surface from where its cross-sections move, world units

    /// Warnings about the line for users, a sentence or two each.
    std::vector<std::string> Warnings() const;
    /// What to do against folds, a sentence.
    std::string Remedy() const;
};

/// Handles with all vertices free.
Handles AllFree(std::size_t slots, const Eigen::Affine3d &world);

/// The line along which a surface is straightened, from \p goal. Jitter of its points that would stretch the surface is
/// removed, unless smoothing is asked for. With goal.middle, the line is moved into the middles of the cross-sections,
/// unless that stretches the surface more.
/// \param deformer of a surface that is all free, prepared with bendsUnheld \param world the matrix of its layer
/// \param report if given, out: jitter, isMiddle and leftMiddle \return its points, 3 x n, world units
/// \throw BadInput as FramedLine; less than half of the line lies in the box of the surface; too few cross-sections to
/// find their middles \throw Cancelled
Eigen::Matrix3Xd LineOf(const LineGoal &goal, const Deformer &deformer, const Eigen::Affine3d &world,
                        const Progress &progress = {}, StraightenReport *report = nullptr);

/// The motion from a line to the target of \p goal. \param deformer, world as in LineOf \param report out: length,
/// newLength, jitter, isMiddle, leftMiddle, twist
/// \throw BadInput as LineOf and MotionTo of a LineGoal; cross-sections too round to measure a twist \throw Cancelled
LineMotion MotionTo(LineGoal goal, const Deformer &deformer, const Eigen::Affine3d &world, StraightenReport &report,
                    const Progress &progress = {});

/// The pose that moves with a line. \param deformer, world as in LineOf \param motion world units
/// \throw Unsolvable the graph cannot be factorised \throw Cancelled
Deformer::Pose Straighten(const Deformer &deformer, const Eigen::Affine3d &world, const LineMotion &motion,
                          const DeformationParam &param, StraightenReport &report, const Progress &progress = {});

/// The position of each vertex slot along a line, world units: 0 at its beginning, negative before it, above its length
/// beyond its end. \param deformer as in LineOf \param line world units
std::vector<float> PlacesOfVertices(const SurfaceView &mesh, const Deformer &deformer, const Eigen::Affine3d &world,
                                    const FramedLine &line, const Progress &progress = {});

} // namespace vcg::fcd

#endif
