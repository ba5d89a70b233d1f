// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FACE_NORMALS_H
#define VCG_FCD_FACE_NORMALS_H

#include <vcg_ext/surface/surface_arrays.h>

namespace vcg::fcd {

/// The normals of a surface, one per vertex slot, of length 1: the sum of those of its faces, times their angles there;
/// 0 without a face. The same bits for any number of threads.
/// \param position 3 numbers a vertex slot, in the place of the surface's own \param normal out, 3 numbers a slot
void FaceNormals(const SurfaceView &surface, const double *position, double *normal, unsigned threads = 0);

} // namespace vcg::fcd

#endif
