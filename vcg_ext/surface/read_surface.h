// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_READ_SURFACE_H
#define VCG_FCD_READ_SURFACE_H

#include <vcg_ext/handles/handles.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <cstdint>
#include <vector>

/// \file
/// Here alone, the method reads a VCG mesh, of any type.

namespace vcg::tri {

template <class VertexType>
Eigen::Vector3d PositionOf(const VertexType &v) {
    return Eigen::Vector3d(v.cP()[0], v.cP()[1], v.cP()[2]);
}

/// Slots of the corners of a face, or of the ends of an edge element; none where it is deleted.
template <class MeshType, class Element>
void ReadSlots(const MeshType &m, const Element &element, int corners, std::uint32_t *to) {
    for (int k = 0; k < corners; ++k)
        to[k] = element.IsD() ? fcd::SurfaceView::none : std::uint32_t(element.cV(k) - &m.vert[0]);
}

/// Reads positions, faces and edge elements of a mesh, and which of them are deleted.
/// \param rest if given, rest(slot) is read instead of the vertices' own positions
/// \throw fcd::BadInput more elements than indices can name \throw fcd::Cancelled
template <class MeshType, class Rest = std::nullptr_t>
fcd::SurfaceArrays ReadSurface(const MeshType &m, const fcd::Progress &progress = {}, const Rest &rest = nullptr) {
    constexpr std::size_t grain = 1 << 16;
    const bool isCompact = std::size_t(m.vn) == m.vert.size(); // no vertex is deleted
    fcd::SurfaceArrays arrays(m.vert.size(), m.face.size(), m.edge.size(), !isCompact);
    ParallelForEach(progress.Slice(0, 0.5), fcd::readingStage, m.vert.size(), grain, [&](std::size_t i) {
        double *to = arrays.Position(i);
        if (!isCompact)
            arrays.Deleted()[i] = m.vert[i].IsD();
        for (int d = 0; d < 3; ++d)
            if constexpr (std::is_same<Rest, std::nullptr_t>::value)
                to[d] = m.vert[i].cP()[d];
            else
                to[d] = rest(i)[d];
    });
    ParallelForEach(progress.Slice(0.5, 1), fcd::readingStage, m.face.size(), grain,
                    [&](std::size_t f) { ReadSlots(m, m.face[f], 3, arrays.Corner(f)); });
    for (std::size_t e = 0; e < m.edge.size(); ++e)
        ReadSlots(m, m.edge[e], 2, arrays.End(e));
    arrays.isCloud = m.fn == 0 && m.en == 0;
    return arrays;
}

/// Flags of deleted vertex slots; empty: none is deleted.
template <class MeshType>
std::vector<char> DeletedOf(const MeshType &m) {
    std::vector<char> deleted;
    if (std::size_t(m.vn) != m.vert.size()) {
        deleted.resize(m.vert.size());
        for (std::size_t i = 0; i < deleted.size(); ++i)
            deleted[i] = m.vert[i].IsD();
    }
    return deleted;
}

/// fcd::CountTags of a mesh. \param tag one per vertex slot \throw fcd::BadInput another number of tags
template <class MeshType>
fcd::TagCount CountTags(const MeshType &m, const std::vector<int> &tag) {
    fcd::ExpectTags(tag, m.vert.size());
    const std::vector<char> deleted = DeletedOf(m);
    return fcd::CountTags(tag, deleted.empty() ? nullptr : deleted.data());
}

} // namespace vcg::tri

#endif
