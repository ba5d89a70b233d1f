// SPDX-License-Identifier: GPL-3.0-or-later
#include "marks.h"

#include <algorithm>

namespace {

/// Tags as LayerState::marks: 0 is free, as new vertices are.
std::vector<int> shifted(std::vector<int> tag, int by) {
    std::for_each(tag.begin(), tag.end(), [by](int &each) { each += by; });
    return tag;
}

} // namespace

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
