// SPDX-License-Identifier: GPL-3.0-or-later
#include "rest_shape.h" // which includes others before Qt

#include "layer_contents.h"
#include "kept_tool.h"
#include "measured_quality.h"

#include <algorithm>

#include <xxhash.h>

namespace {

/// A number for the quality of a vertex; not 0.
std::uint32_t qualityOf(const CVertexO &vertex) {
    const auto quality = vertex.cQ();
    return std::uint32_t(XXH3_64bits(&quality, sizeof quality)) | 1;
}

/// A number for its place and quality; not 0. The lower half is qualityOf.
std::uint64_t numberOf(const CVertexO &vertex) { return RestShape::placeOf(vertex.cP()) << 32 | qualityOf(vertex); }

/// The numbers of the vertices, per slot; 0 for deleted ones.
std::vector<std::uint64_t> numbersOf(const CMeshO &mesh) {
    std::vector<std::uint64_t> number(mesh.vert.size(), 0);
    forVertices(mesh, [&](std::size_t i) { number[i] = numberOf(mesh.vert[i]); });
    return number;
}

/// The numbers that the vertices of \p layer have in common with \p sorted; none if another one has a quality.
std::vector<std::uint64_t> inherited(const MeshModel &layer, const std::vector<std::uint64_t> &sorted) {
    const CMeshO &mesh = layer.cm;
    std::vector<std::uint64_t> number = numbersOf(mesh);
    const std::uint64_t others = sumOfVertices(mesh, [&](std::size_t i) {
        if (std::binary_search(sorted.begin(), sorted.end(), number[i]))
            return 0;
        number[i] = 0;
        return mesh.vert[i].cQ() == 0 ? 0 : 1;
    });
    if (others > 0)
        number.clear();
    return number;
}

bool mayInherit(const MeshModel &layer) {
    return !LayerState::known(layer).measured && !hasTags(layer) && hasQuality(layer);
}

void inherit(const MeshDocument &document, MeshModel &layer, std::vector<std::uint64_t> known) {
    if (known.empty())
        return;
    std::sort(known.begin(), known.end());
    if (std::vector<std::uint64_t> number = inherited(layer, known); !number.empty())
        LayerState::made(document, layer).measured = {false, std::move(number), {}};
}

/// Whether the vertices have the qualities of \p measured in their order, as in a copy of what was moved since.
bool hasQualities(const CMeshO &mesh, const MeasuredState &measured) {
    auto next = measured.number.begin();
    const auto isNext = [&] {
        next = std::find_if(next, measured.number.end(), [](std::uint64_t number) { return number != 0; });
        return next != measured.number.end();
    };
    for (const CVertexO &vertex : mesh.vert)
        if (!vertex.IsD() && (!isNext() || std::uint32_t(*next++) != qualityOf(vertex)))
            return false;
    return !isNext();
}

void append(std::vector<std::uint64_t> &all, const std::vector<std::uint64_t> &some) {
    all.insert(all.end(), some.begin(), some.end());
}

} // namespace

void keepMeasured(const MeshDocument &document, MeshModel &layer, bool areTags) {
    LayerState::made(document, layer).measured = {areTags, numbersOf(layer.cm), {}};
}

bool isMeasured(const MeshModel &layer) {
    const std::optional<MeasuredState> &measured = LayerState::known(layer).measured;
    bool isAny = false;
    for (std::size_t i = 0;
         measured && !measured->areTags && i < std::min(measured->number.size(), layer.cm.vert.size()); ++i)
        if (const CVertexO &vertex = layer.cm.vert[i]; !vertex.IsD() && measured->number[i] != 0) {
            isAny = true;
            if (std::uint32_t(measured->number[i]) != qualityOf(vertex))
                return false;
        }
    return isAny;
}

void inheritMeasured(const MeshDocument &document, MeshModel &layer) {
    if (!mayInherit(layer))
        return;
    std::vector<std::uint64_t> known; // as they were when measured, and as they are now
    for (const MeshModel *other : host::layers(document))
        if (const std::optional<MeasuredState> &measured = LayerState::known(*other).measured;
            measured && !measured->areTags) {
            if (hasQualities(layer.cm, *measured))
                return keepMeasured(document, layer);
            append(known, measured->number);
            append(known, measured->gone);
            if (isMeasured(*other))
                append(known, numbersOf(other->cm));
        }
    inherit(document, layer, std::move(known));
}

void handDownMeasured(const MeshDocument &document, const LayerState &state) {
    for (const MeshModel *layer : host::layers(document))
        if (state.measured && !state.measured->areTags && mayInherit(*layer)) {
            if (hasQualities(layer->cm, *state.measured)) {
                keepMeasured(document, const_cast<MeshModel &>(*layer));
                continue;
            }
            std::vector<std::uint64_t> known = state.measured->number;
            append(known, state.measured->gone);
            inherit(document, const_cast<MeshModel &>(*layer), std::move(known));
        }
}
