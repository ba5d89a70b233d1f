// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FACE_NORMALS_H
#define VCG_FCD_FACE_NORMALS_H

#include <vcg_ext/surface/surface_arrays.h>

namespace vcg::fcd {

/// The normals of a surface, one per vertex slot: the sum of the normals of its faces times their angles at the vertex,
/// of length 1, or 0 without a face. The same bits for any number of threads.
/// \param position 3 numbers a vertex slot; the surface's own positions are not read
/// \param normal out, 3 numbers a vertex slot
void FaceNormals(const SurfaceView &surface, const double *position, double *normal, unsigned threads = 0);

} // namespace vcg::fcd

#endif
