// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_SECTIONS_H
#define VCG_FCD_LINE_SECTIONS_H

#include <vcg_ext/region_deformer.h>
#include <vcg_ext/line/line_motion.h>

/// \file
/// What the cross-sections of a surface along a line tell.

namespace vcg::fcd::detail {

/// Points of the line through the middles of the cross-sections along \p line, as long as it. \param world the matrix
/// of the layer \param line in the world, on the surface, in it or beside it
/// \return 3 x n, in the world \throw BadInput where there is hardly a cross-section \throw Cancelled
Eigen::Matrix3Xd MiddleOf(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                          const Progress &progress = {});

/// How far the surface is from a line, root mean square over its area, in the world. 0 where none is beside the line.
double ThicknessAlong(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                      const Progress &progress = {});

/// How much a surface is stretched along a line when that becomes straight: the mean square of the logarithm, over its
/// area. Least for a line through the middle of what was bent; a line that wiggles, or lies to one side, stretches
/// more.
double StretchAlong(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                    const Progress &progress = {});

/// What takes the twist of a surface about a line out: the longest axes of the cross-sections turn to where that in the
/// middle is. \throw BadInput where the cross-sections are so round that they have none
LineMotion::TwistAt TwistOf(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line);

} // namespace vcg::fcd::detail

#endif
