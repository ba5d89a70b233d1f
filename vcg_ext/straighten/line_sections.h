// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_SECTIONS_H
#define VCG_FCD_LINE_SECTIONS_H

#include <vcg_ext/region_deformer.h>
#include <vcg_ext/line/line_motion.h>

/// \file
/// Measures the cross-sections of a surface along a line.

namespace vcg::fcd::detail {

/// The line through the middles of the cross-sections along \p line, for its whole length. \param world mesh units to
/// the world \param line world units; on the surface, in it or beside it \return points, 3 x n, world units
/// \throw BadInput there are too few cross-sections \throw Cancelled
Eigen::Matrix3Xd MiddleOf(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                          const Progress &progress = {});

/// The rms distance of the surface from a line, over its area, world units; 0 if no surface is beside the line.
double ThicknessAlong(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                      const Progress &progress = {});

/// How much a surface is stretched along a line that becomes straight: the mean square of the logarithm of the stretch,
/// over its area. It is least for a line through the middle of a bent body; lines that wiggle or lie to one side
/// stretch more.
double StretchAlong(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                    const Progress &progress = {});

/// The twist that undoes that of a surface about a line: it turns the longest axis of each cross-section to that in the
/// middle. \throw BadInput the cross-sections are too round
LineMotion::TwistAt TwistOf(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line);

} // namespace vcg::fcd::detail

#endif
