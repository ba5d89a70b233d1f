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

/// Where a deformed surface passes through itself and did not at rest.
struct SurfaceContact {
    /// Faces that pass through another one, ascending. Pairs that met or touched at rest do not count.
    std::vector<std::uint32_t> face;
    std::int64_t pairs = 0; ///< number of pairs of such faces
    /// The largest of \ref depth, world units.
    double largest = 0;
    /// How far each vertex slot has come through the surface, world units; 0 for most, empty without contact. Corners
    /// of \ref face have the depth of their pair of faces. Those faces also cut the surface into pieces. In each
    /// connected part, all pieces but the largest are inside: their vertices have the distance from the surface that
    /// they passed. If a piece passes through itself, as both sides of a crease do, that is also the part of it that
    /// faces the other way. So in a motion, the depth grows and falls by about as much as the surface moves, unless a
    /// part is cut off that was not before.
    std::vector<double> depth;

    std::string Text() const; ///< a sentence about it; empty without contact
};

/// Surfaces of at most so many faces are checked for contact unasked. That takes a tenth of a second at most. For two
/// million faces, it takes as long as the rest of a deformation.
constexpr std::size_t contactUnasked = 250000;

/// Finds where a deformed surface passes through itself; a cloud never does. The result is the same for any number of
/// threads. It takes about a second for a million triangles that move, and nothing for others. \param mesh at rest
/// \param position 3 x vertex slots, mesh units: of the pose; faces with a corner that is not finite are left out
/// \param metric as in Frame \param apart the distance up to which faces touch at rest, over the diagonal of the posed
/// box of the faces that move \throw Cancelled
SurfaceContact FindContact(const SurfaceView &mesh, const PositionsRef &position, const Eigen::Matrix3d &metric,
                           double apart, const Progress &progress = {});

} // namespace vcg::fcd

#endif
