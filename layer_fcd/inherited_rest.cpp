// SPDX-License-Identifier: GPL-3.0-or-later
#include "inherited_rest.h"
#include "layer_contents.h"
#include "mesh_copy.h"
#include "rest_shape.h"

#include <utility>

namespace {

/// For each vertex slot of \p mesh, the slot in \p rest of the vertex that it is a copy of; empty unless all are
/// copies.
std::vector<std::size_t> copiedSlots(const CMeshO &mesh, const RestState &rest) {
    std::vector<std::size_t> from;
    std::size_t next = 0;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
        if (mesh.vert[i].IsD())
            continue;
        while (next < rest.vertex.size() && !(rest.vertex[next].isKnown() && rest.vertex[next].isAt(mesh.vert[i].cP())))
            ++next;
        if (next == rest.vertex.size())
            return {};
        from.resize(mesh.vert.size()); // not before one is: each pose asks this of all layers
        from[i] = next++;
    }
    return from;
}

/// What \p shape says of the vertices that copies were made of.
Shape copyOf(const Shape &shape, const std::vector<std::size_t> &from) {
    Shape copy;
    copy.position.reserve(from.size());
    copy.normal.reserve(from.size());
    for (const std::size_t slot : from) {
        copy.position.push_back(shape.position[slot]);
        copy.normal.push_back(shape.normal[slot]);
    }
    return copy;
}

} // namespace

std::optional<RestState> inheritedRest(const MeshModel &layer, const std::vector<const LayerState *> &others) {
    const CMeshO &mesh = layer.cm;
    for (const LayerState *other : others) {
        const RestState *their = other->rest ? &*other->rest : nullptr;
        if (!their)
            continue;
        const std::vector<std::size_t> from = copiedSlots(mesh, *their);
        if (from.empty())
            continue;
        RestState rest;
        static_cast<Shape &>(rest) = copyOf(*their, from);
        for (const Shape &earlier : their->earlier)
            rest.earlier.push_back(copyOf(earlier, from));
        rest.vertex.resize(from.size());
        bool isOther = !rest.earlier.empty();
        forVertices(mesh, [&](std::size_t i) {
            const Point3m &p = mesh.vert[i].cP();
            rest.vertex[i] = {{p[0], p[1], p[2]}, RestShape::placeOf(p)};
        });
        for (std::size_t i = 0; !isOther && i < from.size(); ++i)
            isOther = !mesh.vert[i].IsD() && mesh.vert[i].cP() != rest.position[i];
        if (!isOther)
            continue;
        rest.faces = facesOf(mesh);
        rest.vertexSlots = mesh.vert.size();
        rest.ownNormals = their->ownNormals;
        rest.normalsNow = rest.normalsBefore = rest.ownNormals ? normalsOf(mesh) : 0;
        return rest;
    }
    return {};
}

bool handDownRest(const MeshDocument &document, const LayerState &state) {
    bool isGiven = false;
    for (const MeshModel *layer : host::layers(document))
        if (state.rest && !LayerState::known(*layer).rest)
            if (std::optional<RestState> rest = inheritedRest(*layer, {&state})) {
                LayerState::made(document, const_cast<MeshModel &>(*layer)).rest = std::move(rest);
                isGiven = true;
            }
    return isGiven;
}
