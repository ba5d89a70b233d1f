// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/memory.h> // before Qt

#include "mesh_copy.h"

#include <vcg/complex/allocate.h>

#include <algorithm>
#include <set>
#include <string>

namespace {

/// Makes room for n elements, in large pages.
template <class Elements>
void reserve(Elements &elements, int n) {
    elements.reserve(std::size_t(n));
    vcg::fcd::PreferLargePages(elements.data(), std::size_t(n) * sizeof elements[0]);
}

void copyAttributes(const std::set<vcg::PointerToAttribute> &to, const std::set<vcg::PointerToAttribute> &from,
                    const Packing &packing) {
    for (const vcg::PointerToAttribute &attribute : to)
        if (const auto its = from.find(attribute); !attribute._name.empty() && its != from.end())
            packing.forEach([&](std::size_t i, std::size_t j) { attribute._handle->CopyValue(j, i, its->_handle); });
}

} // namespace

void copyElements(CMeshO &to, const CMeshO &from) {
    using Allocator = vcg::tri::Allocator<CMeshO>;
    const Packing vertices(from.vert, from.vn), edges(from.edge, from.en), faces(from.face, from.fn);
    reserve(to.vert, from.vn);
    reserve(to.face, from.fn);
    Allocator::AddVertices(to, std::size_t(from.vn));
    Allocator::AddEdges(to, std::size_t(from.en));
    Allocator::AddFaces(to, std::size_t(from.fn));

    std::vector<short> texture; // of each of from
    for (const std::string &name : from.textures) {
        const auto at = std::find(to.textures.begin(), to.textures.end(), name) - to.textures.begin();
        if (at == std::ptrdiff_t(to.textures.size()))
            to.textures.push_back(name);
        texture.push_back(short(at));
    }
    const auto rename = [&](auto &place) { // where there is no such texture, the number is all there is
        if (std::size_t(place.n()) < texture.size())
            place.n() = texture[std::size_t(place.n())];
    };
    const auto moved = [&](const CVertexO *vertex) { return &to.vert[vertices(vcg::tri::Index(from, vertex))]; };
    const bool isVertexTextured = vcg::tri::HasPerVertexTexCoord(to) && vcg::tri::HasPerVertexTexCoord(from),
               isWedgeTextured = vcg::tri::HasPerWedgeTexCoord(to) && vcg::tri::HasPerWedgeTexCoord(from);
    vertices.forEach([&](std::size_t i, std::size_t j) {
        to.vert[j].ImportData(from.vert[i]);
        if (isVertexTextured)
            rename(to.vert[j].T());
    });
    edges.forEach([&](std::size_t i, std::size_t j) {
        to.edge[j].ImportData(from.edge[i]);
        for (int k = 0; k < 2; ++k)
            to.edge[j].V(k) = moved(from.edge[i].cV(k));
    });
    faces.forEach([&](std::size_t i, std::size_t j) {
        to.face[j].ImportData(from.face[i]);
        for (int k = 0; k < 3; ++k) {
            to.face[j].V(k) = moved(from.face[i].cV(k));
            if (isWedgeTextured)
                rename(to.face[j].WT(k));
        }
    });
    copyAttributes(to.vert_attr, from.vert_attr, vertices);
    copyAttributes(to.edge_attr, from.edge_attr, edges);
    copyAttributes(to.face_attr, from.face_attr, faces);
}
