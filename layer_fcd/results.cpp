// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_contents.h"
#include "layer_normals.h"
#include "layer_state.h"
#include "results.h"

namespace {

bool isAsMade(const MeshModel &layer, const ResultState &result) {
    return contentsOf(layer) == result.contents && (result.ownNormals || !hasOwnNormals(layer));
}

} // namespace

void showLast(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results) {
    if (!host::inWindow() || results.empty())
        return;
    for (MeshModel *result : results)
        host::setVisible(*result, result == results.back());
    host::setVisible(source, false);
    host::showChanges(document);
}

void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results) {
    for (MeshModel *result : results)
        LayerState::made(document, *result).result = {source.id(), contentsOf(*result), hasOwnNormals(*result),
                                                      result->label()};
    showLast(document, source, results);
}

MeshModel &sourceOf(MeshDocument &document, MeshModel &layer) {
    const std::optional<ResultState> &result = LayerState::known(layer).result;
    MeshModel *source = result && isAsMade(layer, *result) ? document.getMesh(result->source) : nullptr;
    if (source && source->cm.vn > 0)
        return *source;
    return layer;
}

std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source) {
    std::vector<MeshModel *> results;
    for (const MeshModel *layer : host::layers(document)) {
        const std::optional<ResultState> &result = LayerState::known(*layer).result;
        if (result && result->source == source.id() && layer->label() == result->label && isAsMade(*layer, *result))
            results.push_back(const_cast<MeshModel *>(layer));
    }
    return results;
}
