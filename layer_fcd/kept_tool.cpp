// SPDX-License-Identifier: GPL-3.0-or-later
#include "rest_shape.h" // which includes others before Qt
#include "kept_tool.h"

#include <algorithm>
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
    const bool isSame = state.tool && state.tool->matrix == layer.cm.Tr && (!state.tool->isPosed || state.rest) &&
                        state.tool->shape == shapeOf(layer.cm);
    return isSame ? state.tool : nullptr;
}

FitShape fitShownBy(const MeshModel &layer) {
    const LayerState &state = LayerState::known(layer);
    const bool isSame = state.rest && state.fit && state.fit->shown != FitShape::Rest &&
                        state.fit->matrix == layer.cm.Tr && state.fit->shape == shapeOf(layer.cm);
    return isSame ? state.fit->shown : FitShape::Rest;
}

/// Tags as LayerState::marks: 0 is free, as new vertices are.
static std::vector<int> shifted(std::vector<int> tag, int by) {
    std::for_each(tag.begin(), tag.end(), [by](int &each) { each += by; });
    return tag;
}

bool hasMarks(const MeshModel &layer) { return !LayerState::known(layer).marks.empty(); }

std::vector<int> marksOf(const MeshModel &layer) { return shifted(LayerState::known(layer).marks, 1); }

void setMarks(const MeshDocument &document, MeshModel &layer, const std::vector<int> &tag) {
    LayerState::made(document, layer).marks = shifted(tag, -1);
}

void dropMarks(const MeshModel &layer) {
    if (LayerState *state = LayerState::of(layer))
        state->marks.clear();
}

bool hasTags(const MeshModel &layer) {
    const std::optional<KeptScan> &scan = LayerState::known(layer).scan;
    return hasMarks(layer) || (scan && scan->quality);
}

const std::string &appliedTags(const MeshDocument &document, MeshModel &layer) {
    std::string &name = LayerState::made(document, layer).appliedName;
    if (name.empty())
        for (name = "fcd_applied"; vcg::tri::HasPerVertexAttribute(layer.cm, name);)
            name += '_';
    return name;
}
