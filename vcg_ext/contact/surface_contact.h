// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_CONTACT_H
#define VCG_FCD_SURFACE_CONTACT_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vcg::fcd {

/// Where a deformed surface passes through itself, and did not at rest.
struct SurfaceContact {
    /// Faces that pass through another one that they were apart from at rest, ascending. What met or touched there, as
    /// neighbours do, does not count.
    std::vector<std::uint32_t> face;
    std::int64_t pairs = 0; ///< of such faces
    /// How far the surface reaches through itself at most, world units: the largest of \ref depth.
    double largest = 0;
    /// Per vertex slot, world units: how far it has come through, which is 0 of most; empty where there is no contact.
    /// Where the faces that pass through others cut something off (of each connected part, all but the largest piece),
    /// this is the distance of its vertices from the surface that they came through; of other corners of those faces,
    /// how far the two reach through each other.
    std::vector<double> depth;

    std::string Text() const; ///< all of that in a sentence, empty where there is no contact
};

/// Faces of a surface in which contact is looked for without being asked: that takes a tenth of a second at most, which
/// nobody waits for. In two million it takes as long as all else of a deformation.
constexpr std::size_t contactUnasked = 250000;

/// Finds what of a surface passes through it after a deformation. A cloud passes through nothing. The same for any
/// number of threads; about a second for a million triangles that move, and nothing for those that do not.
/// \param mesh at rest \param position 3 x vertex slots, mesh units: where the vertices are now; a face with one that
/// is
///        not finite is left out
/// \param metric as of Frame \param apart faces no farther from each other at rest than this, as a fraction of the
///        diagonal of the box of those that are looked at, touch there: that of vertices that are as good as at one
///        place
/// \throw Cancelled
SurfaceContact FindContact(const SurfaceView &mesh, const PositionsRef &position, const Eigen::Matrix3d &metric,
                           double apart, const Progress &progress = {});

} // namespace vcg::fcd

#endif
