// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SECTION_TWIST_H
#define VCG_FCD_SECTION_TWIST_H

#include <vcg_ext/deformer.h>
#include <vcg_ext/line/line_motion.h>

namespace vcg {
namespace fcd {

/// What takes the twist of a surface about a line out: the longest axes of the cross-sections turn to where that in the
/// middle is. \param world the matrix of the layer \param line in the world
/// \throw BadInput where the cross-sections are so round that they have none
LineMotion::TwistAt TwistOf(const Deformer &deformer, const Eigen::Affine3d &world, const FramedLine &line);

} // namespace fcd
} // namespace vcg

#endif
