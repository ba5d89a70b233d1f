// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_BEST_PLANE_H
#define VCG_FCD_BEST_PLANE_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/symmetry/mirror_plane.h>
#include <vcg_ext/warp/smooth_warp.h>

#include <functional>

namespace vcg::fcd {

/// The data of the warp that takes a surface onto its mirror image in a plane.
using WarpGoalIn = std::function<WarpGoal(const MirrorPlane &)>;

/// The plane in which a surface is its mirror image, up to a warp. Of several that are equally good, the first one.
/// \param isSure out: false if another plane, with other counterparts, is at least half as good
/// \throw BadInput nothing of the surface tells a plane \throw Cancelled
MirrorPlane BestPlane(const TriedPlanes &tried, const WarpGoalIn &goalIn, bool &isSure, const Progress &progress = {});

} // namespace vcg::fcd

#endif
