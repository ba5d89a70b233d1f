// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_PART_REMOVAL_H
#define VCG_FCD_PART_REMOVAL_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/surface_graph.h>

#include <vector>

namespace vcg {
namespace fcd {

/// Takes parts out of a surface that was read with them, in a fraction of the time in which what is left is read again,
/// and to the bits of that. \param mesh that it was read of, as ReadFreeSurface does
/// \param partOf as of LooseSurface: whole components that nothing holds
/// \return whether that is known to be so; else nothing is changed: where the frame of what is left is another one, and
/// where other vertices than those at one place count as one, or nearly do, as in clouds and on seams \throw Cancelled
bool RemoveParts(const SurfaceView &mesh, const std::vector<Index> &partOf, const Progress &progress,
                 SurfaceGraph &surface);

} // namespace fcd
} // namespace vcg

#endif
