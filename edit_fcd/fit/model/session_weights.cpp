// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/model/session.h"

#include <layer_fcd/weight_sources.h>

#include <algorithm>
#include <utility>

// The weights of a pull.

/// The weights of the layer, then those of the target. They may depend on quality or selection.
FitWeights FitSession::weightsFor(const MeshModel &target) const {
    FitWeights all = weightsOf(layer);
    const FitWeights its = weightsOf(target);
    all.insert(all.end(), its.begin(), its.end());
    return all;
}

bool FitSession::hasPulledWeights(const MeshModel &target) const {
    try {
        return pulledWeights == weightsFor(target);
    } catch (const vcg::fcd::Error &) { // the weights are gone
        return false;
    }
}

/// Gives layers the painted weights of the present state, if those of \p from differ.
void FitSession::showPainted(const FitState &from) {
    for (const auto &[number, weights] : now.painted) {
        const auto before = from.painted.find(number);
        MeshModel *its = document.getMesh(number);
        if (its && (before == from.painted.end() || before->second != weights) &&
            (weights->empty() || weights->size() == its->cm.vert.size()))
            paintWeights(*its, *weights);
    }
}

FitWeights FitSession::weightsOf(const MeshModel &of) const {
    if (stroke && stroke->layer == of.id())
        return stroke->weights;
    const bool isOwn = &of == &layer;
    return readWeights(of, isOwn ? now.options.weights : now.options.targetWeights, FitMeshParam::paintedAttribute);
}

void FitSession::beginStroke(MeshModel &on) {
    FitMeshParam::Weights &source = &on == &layer ? now.options.weights : now.options.targetWeights;
    const bool isThere = vcg::tri::HasPerVertexAttribute(on.cm, FitMeshParam::paintedAttribute);
    FitWeights before =
        isThere ? readWeights(on, FitMeshParam::WeightsAttribute, FitMeshParam::paintedAttribute) : FitWeights();
    FitWeights weights = source == FitMeshParam::WeightsAttribute ? before : weightsOf(on);
    weights.resize(on.cm.vert.size(), 1);
    for (float &each : weights)
        each = each >= 0 ? std::min(each, 1.f) : 0; // a quality may be out of range
    stroke = Stroke{on.id(), std::move(before), std::move(weights), false};
}

void FitSession::paint(const std::vector<std::size_t> &vertices, float weight) {
    if (!stroke)
        return;
    for (const std::size_t i : vertices) {
        stroke->isPainted = stroke->isPainted || stroke->weights[i] != weight;
        stroke->weights[i] = weight;
    }
}

bool FitSession::endStroke() {
    if (!stroke)
        return false;
    const Stroke painted = std::move(*stroke);
    stroke.reset();
    MeshModel *on = document.getMesh(painted.layer);
    if (!painted.isPainted || !on || on->cm.vert.size() != painted.weights.size())
        return false;
    now.painted.emplace(painted.layer, std::make_shared<const FitWeights>(painted.before));
    change();
    now.painted[painted.layer] = std::make_shared<const FitWeights>(painted.weights);
    (on == &layer ? now.options.weights : now.options.targetWeights) = FitMeshParam::WeightsAttribute;
    paintWeights(*on, painted.weights);
    return true;
}
