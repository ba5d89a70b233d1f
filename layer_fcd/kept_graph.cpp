// SPDX-License-Identifier: GPL-3.0-or-later
#include "rest_shape.h" // which includes others before Qt

#include "inherited.h"
#include "kept_graph.h"

#include <algorithm>

#include <QRegularExpression>

std::optional<GraphState> graphOf(const MeshDocument &document, const MeshModel &layer) {
    if (const std::optional<GraphState> &own = LayerState::known(layer).graph)
        return own;
    std::optional<std::uint64_t> shape; // computed if needed
    for (const LayerState *other : LayerState::ofOthers(document, layer))
        if (other->graph && layer.cm.fn == 0) {
            shape = shape ? shape : shapeOf(layer.cm);
            if (*shape == other->graph->shape)
                return other->graph;
        }
    return {};
}

void handDownGraph(const MeshDocument &document, const LayerState &state) {
    handDown(document, state, &LayerState::graph, [&state](const MeshModel &layer) {
        return layer.cm.fn == 0 && shapeOf(layer.cm) == state.graph->shape ? state.graph : std::nullopt;
    });
}

const MeshModel *likelyGraph(const MeshDocument &document, bool isDeformed) {
    static const QRegularExpression deformed(" deformed graph[ 0-9()]*$"), any(" graph( \\d+)?(\\(\\d+\\))?$");
    const MeshModel *found = document.mm();
    int best = 0;
    for (const MeshModel *layer : host::layers(document)) {
        found = found ? found : layer;
        const std::optional<GraphState> graph = graphOf(document, *layer);
        const bool isDeformedGraph = graph ? graph->isDeformed : layer->label().contains(deformed);
        const bool isOfCurrent = graph && document.mm() && graph->source == document.mm()->id();
        // A deformed graph without a deformation is a copy, or was loaded.
        const int rank = 1 + 2 * isOfCurrent + (isDeformed && LayerState::known(*layer).deformation);
        if ((graph || layer->label().contains(any)) && isDeformedGraph == isDeformed && rank >= best) {
            found = layer;
            best = rank;
        }
    }
    return found;
}

bool isGraph(const MeshDocument &document, const MeshModel &layer) {
    if (graphOf(document, layer))
        return true;
    Scalarm least = 0, greatest = 0;
    for (const CVertexO &vertex : layer.cm.vert)
        if (!vertex.IsD()) {
            least = std::min(least, Scalarm(vertex.cQ()));
            greatest = std::max(greatest, Scalarm(vertex.cQ()));
        }
    return layer.cm.fn == 0 && least == 0 && greatest > 0;
}
