// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_STRAIGHTEN_H
#define VCG_FCD_STRAIGHTEN_H

#include <vcg_ext/deformer.h>
#include <vcg_ext/line/line_motion.h>

#include <Eigen/Geometry>
#include <utility>
#include <vector>

/// \file
/// Straightens a surface along a line, or bends it along another one. The nodes of its deformation graph go with
/// their cross-sections of the line. Where these would fold it or tear it apart, it follows as rigidly as possible.

namespace vcg::fcd {

/// How a surface is straightened: all of it is free, and bends.
struct StraightenParam : DeformationParam {
    StraightenParam();
};

/// What straightening did.
struct StraightenReport {
    double length = 0, newLength = 0; ///< of the line, before and after, world units
    double jitter = 0;       ///< of the points across the line, removed: root mean square a direction, world units
    bool leftMiddle = false; ///< the line was not moved into the middle as asked: that stretches the surface more
    double twist = 0;        ///< of the surface about the line, from end to end, degrees; 0 if not measured
    Index following = 0, released = 0; ///< nodes that go with the line, and that do not, as it would fold or tear there
    std::vector<std::pair<double, double>> releasedAt; ///< where these are along the line: from, to, world units
    double rms = 0, largest = 0; ///< distance of the surface from where its cross-sections go, world units
};

/// Tags that make all vertices free.
Handles AllFree(std::size_t slots, const Eigen::Affine3d &world);

/// The line along which a surface is straightened: that of \p goal. Jitter of its points that would stretch the surface
/// is removed, unless smoothing is asked for. With goal.middle the line is moved into the middles of the
/// cross-sections, unless that stretches the surface more. \param deformer of a surface that is all free, prepared with
/// bendsUnheld \param world the matrix of its layer \param report if given: jitter and leftMiddle \return 3 x n, its
/// points, in the world \throw BadInput as FramedLine; a line less than half of which lies in the box of the surface;
/// too few cross-sections to find their middles \throw Cancelled
Eigen::Matrix3Xd LineOf(const LineGoal &goal, const Deformer &deformer, const Eigen::Affine3d &world,
                        const Progress &progress = {}, StraightenReport *report = nullptr);

/// The motion from one line to another one; length and twist are those of the surface. \param deformer, world as of
/// LineOf \throw BadInput as LineOf, and as MotionTo; too round cross-sections to tell a twist \throw Cancelled
LineMotion MotionTo(LineGoal goal, const Deformer &deformer, const Eigen::Affine3d &world, StraightenReport &report,
                    const Progress &progress = {});

/// The pose that goes with a line. \param deformer, world as of LineOf \param motion in the world
/// \throw Unsolvable \throw Cancelled
Deformer::Pose Straighten(const Deformer &deformer, const Eigen::Affine3d &world, const LineMotion &motion,
                          const DeformationParam &param, StraightenReport &report, const Progress &progress = {});

/// How far along a line of the world each vertex slot lies, world units: 0 at its beginning, less before it, more than
/// its length beyond its end. \param deformer as of LineOf
std::vector<float> PlacesOfVertices(const SurfaceView &mesh, const Deformer &deformer, const Eigen::Affine3d &world,
                                    const FramedLine &line, const Progress &progress = {});

} // namespace vcg::fcd

#endif
