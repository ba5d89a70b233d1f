// SPDX-License-Identifier: GPL-3.0-or-later
#include "rest_shape.h" // which includes others before Qt

#include "kept_tool.h"

#include <utility>

void keepTool(const MeshDocument &document, MeshModel &layer, std::string text, bool isPosed) {
    if (!text.empty())
        LayerState::made(document, layer).tool =
            std::make_shared<const ToolState>(ToolState{std::move(text), isPosed, shapeOf(layer.cm), layer.cm.Tr});
    else if (LayerState *state = LayerState::of(layer))
        state->tool.reset();
}

std::shared_ptr<const ToolState> toolOf(const MeshModel &layer) {
    const LayerState &state = LayerState::known(layer);
    const bool isIts = state.tool && state.tool->matrix == layer.cm.Tr && (!state.tool->isPosed || state.rest) &&
                       state.tool->shape == shapeOf(layer.cm);
    return isIts ? state.tool : nullptr;
}

FitShape fitShownBy(const MeshModel &layer) {
    const LayerState &state = LayerState::known(layer);
    const bool isIts = state.rest && state.fit && state.fit->shown != FitShape::Rest &&
                       state.fit->matrix == layer.cm.Tr && state.fit->shape == shapeOf(layer.cm);
    return isIts ? state.fit->shown : FitShape::Rest;
}
