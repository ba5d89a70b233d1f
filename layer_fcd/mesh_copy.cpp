// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/memory.h> // before Qt

#include "parameters.h" // which includes others before Qt

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

/// Appends copies of the live elements of \p from, in order, in one pass. (VCG's own way takes three, in one thread.)
/// \pre reserve \param finish finish(i, copy of element i)
template <class Elements, class Finish>
void appendCopies(Elements &to, const Elements &from, const Finish &finish) {
    std::vector<typename Elements::value_type> &plain = to; // does not construct the optional components
    for (std::size_t i = 0; i < from.size(); ++i)
        if (!from[i].IsD()) {
            auto &copy = plain.emplace_back(from[i]);
            copy._ovp = &to;
            finish(i, copy);
        }
}

/// Whether elements have optional components, except adjacencies.
bool hasOptional(const decltype(CMeshO::vert) &v) {
    return v.IsQualityEnabled() || v.IsColorEnabled() || v.IsMarkEnabled() || v.IsNormalEnabled() ||
           v.IsCurvatureEnabled() || v.IsCurvatureDirEnabled() || v.IsRadiusEnabled() || v.IsTexCoordEnabled();
}
bool hasOptional(const decltype(CMeshO::face) &f) {
    return f.IsQualityEnabled() || f.IsColorEnabled() || f.IsMarkEnabled() || f.IsNormalEnabled() ||
           f.IsCurvatureDirEnabled() || f.IsWedgeTexCoordEnabled() || f.IsWedgeColorEnabled() ||
           f.IsWedgeNormalEnabled();
}

/// Makes room for the optional components and the attributes of elements that were appended.
template <class Elements>
void resizeOthers(Elements &elements, const std::set<vcg::PointerToAttribute> &attributes) {
    elements.resize(elements.size());
    for (const vcg::PointerToAttribute &attribute : attributes)
        attribute._handle->Resize(elements.size());
}

void copyAttributes(const std::set<vcg::PointerToAttribute> &to, const std::set<vcg::PointerToAttribute> &from,
                    const Packing &packing) {
    for (const vcg::PointerToAttribute &attribute : to)
        if (const auto source = from.find(attribute); !attribute._name.empty() && source != from.end())
            packing.forEach([&](std::size_t i, std::size_t j) { attribute._handle->CopyValue(j, i, source->_handle); });
}

} // namespace

void copyElements(CMeshO &to, const CMeshO &from, const Eigen::Matrix3Xd *position) {
    const Packing vertices(from.vert, from.vn), edges(from.edge, from.en), faces(from.face, from.fn);
    reserve(to.vert, from.vn);
    reserve(to.face, from.fn);
    const auto moved = [&](const CVertexO *vertex) { return to.vert.data() + vertices(vcg::tri::Index(from, vertex)); };
    const auto place = [&](std::size_t i, CVertexO &vertex) {
        if (position)
            vertex.P() = toPoint(position->col(Eigen::Index(i)));
    };
    vcg::Box3<Scalarm> box;
    // A vector is filled by one thread; vertices and faces, in parallel.
    vcg::fcd::ParallelFor(0, 2, 1, [&](std::size_t task, std::size_t) {
        if (task == 0)
            appendCopies(to.face, from.face, [&](std::size_t i, CFaceO &face) {
                for (int k = 0; k < 3; ++k)
                    face.V(k) = moved(from.face[i].cV(k));
            });
        else
            appendCopies(to.vert, from.vert, [&](std::size_t i, CVertexO &vertex) {
                place(i, vertex);
                if (position)
                    box.Add(vertex.cP());
            });
    });
    to.vn = from.vn;
    to.fn = from.fn;
    resizeOthers(to.vert, to.vert_attr);
    resizeOthers(to.face, to.face_attr);
    vcg::tri::Allocator<CMeshO>::AddEdges(to, std::size_t(from.en));
    if (position)
        to.bbox = box;

    std::vector<short> texture; // new number of each texture of from
    for (const std::string &name : from.textures) {
        const auto at = std::find(to.textures.begin(), to.textures.end(), name) - to.textures.begin();
        if (at == std::ptrdiff_t(to.textures.size()))
            to.textures.push_back(name);
        texture.push_back(short(at));
    }
    const auto rename = [&](auto &place) { // numbers without a texture stay
        if (std::size_t(place.n()) < texture.size())
            place.n() = texture[std::size_t(place.n())];
    };
    const bool isVertexTextured = vcg::tri::HasPerVertexTexCoord(to) && vcg::tri::HasPerVertexTexCoord(from),
               isWedgeTextured = vcg::tri::HasPerWedgeTexCoord(to) && vcg::tri::HasPerWedgeTexCoord(from);
    if (hasOptional(to.vert))
        vertices.forEach([&](std::size_t i, std::size_t j) {
            to.vert[j].ImportData(from.vert[i]);
            place(i, to.vert[j]);
            if (isVertexTextured)
                rename(to.vert[j].T());
        });
    edges.forEach([&](std::size_t i, std::size_t j) {
        to.edge[j].ImportData(from.edge[i]);
        for (int k = 0; k < 2; ++k)
            to.edge[j].V(k) = moved(from.edge[i].cV(k));
    });
    if (hasOptional(to.face))
        faces.forEach([&](std::size_t i, std::size_t j) {
            to.face[j].ImportData(from.face[i]);
            for (int k = 0; k < 3 && isWedgeTextured; ++k)
                rename(to.face[j].WT(k));
        });
    copyAttributes(to.vert_attr, from.vert_attr, vertices);
    copyAttributes(to.edge_attr, from.edge_attr, edges);
    copyAttributes(to.face_attr, from.face_attr, faces);
}
