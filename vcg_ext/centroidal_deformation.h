// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CENTROIDAL_DEFORMATION_H
#define VCG_FCD_CENTROIDAL_DEFORMATION_H

#include <vcg_ext/deformer.h>
#include <vcg_ext/surface/read_surface.h>

#include <vcg/complex/complex.h>

/// \file
/// Fast centroidal deformation of a VCG mesh, of any type, in one call. After A. Morsucci, M. Centin, A. Signoroni:
/// Fast centroidal deformation for large mesh models, STAG 2018. For plain arrays, or many poses, see deformer.h.

namespace vcg::tri {

/// The normals of a mesh's vertices; empty if it has none. \param m must outlive the result
template <class MeshType>
fcd::NormalOf NormalsOf(const MeshType &m) {
    if (!vcg::tri::HasPerVertexNormal(m))
        return {};
    return [&m](std::size_t slot) {
        const auto &n = m.vert[slot].cN();
        return Eigen::Vector3d(n[0], n[1], n[2]);
    };
}

/// fcd::BuildCentroidalGraph (deformer.h) of a VCG mesh. \throw fcd::BadInput, fcd::Cancelled as that
template <class MeshType>
fcd::CentroidalGraph BuildCentroidalGraph(const MeshType &m, const fcd::GraphParam &param,
                                          const fcd::Progress &progress = {},
                                          const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity()) {
    param.Validate();
    const fcd::SurfaceArrays arrays = ReadSurface(m, progress.Slice(0, 0));
    return fcd::BuildCentroidalGraph(arrays.View(), NormalsOf(m), param, progress, metric);
}

/// fcd::DeformSurface (deformer.h) of a VCG mesh, which is not changed: the deformed positions are result.position,
/// mesh units. \throw fcd::BadInput, fcd::Unsolvable, fcd::Cancelled as that
template <class MeshType>
fcd::DeformationResult DeformCentroidal(const MeshType &m, const fcd::Handles &handles,
                                        const fcd::DeformationParam &param, const fcd::Progress &progress = {}) {
    param.Validate();
    const fcd::SurfaceArrays arrays = ReadSurface(m, progress.Slice(0, 0));
    return fcd::DeformSurface(arrays.View(), NormalsOf(m), handles, param, progress);
}

} // namespace vcg::tri

#endif
