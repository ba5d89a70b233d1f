// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_contents.h"
#include "layer_matrix.h"
#include "line_surface.h"

#include <cstring>

using vcg::fcd::SurfaceView;

LineSurface::LineSurface(const MeshModel &layer, const vcg::fcd::Progress &progress)
    : world(invertibleMatrixOf(layer)), arrays(vcg::tri::ReadSurface(layer.cm, progress)), normal(layer.cm.vert.size()),
      hasDirections(::hasDirections(layer)), handles(vcg::fcd::AllFree(arrays.Slots(), world)) {
    forVertices(layer.cm, [&](std::size_t i) { normal[i] = layer.cm.vert[i].cN(); });
}

bool LineSurface::isSame(const LineSurface &other) const {
    const auto isEqual = [](const auto *a, const auto *b, std::size_t count) {
        return !a == !b && (!a || count == 0 || std::memcmp(a, b, count * sizeof *a) == 0);
    };
    const SurfaceView a = arrays.View(), b = other.arrays.View();
    return world.matrix() == other.world.matrix() && a.vertexSlots == b.vertexSlots && a.faces == b.faces &&
           a.edges == b.edges && isEqual(a.position, b.position, 3 * a.vertexSlots) &&
           isEqual(a.deleted, b.deleted, a.vertexSlots) && isEqual(a.corner, b.corner, 3 * a.faces) &&
           isEqual(a.end, b.end, 2 * a.edges);
}

void LineSurface::prepare(const vcg::fcd::StraightenParam &param, const vcg::fcd::Progress &progress) {
    const SurfaceView view = arrays.View();
    const auto made = std::make_shared<Prepared>();
    made->tags = vcg::fcd::CountTags(handles.tag, view.deleted);
    made->deformer = vcg::fcd::PrepareDeformer(view, handles, param, progress);
    prepared = made;
}
