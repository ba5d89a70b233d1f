// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/fit/model/session.h"
#include "edit_fcd/shape/script_call.h"

#include <layer_fcd/kept_tool.h>
#include <layer_fcd/handle_sources.h>
#include <layer_fcd/weight_sources.h>

#include <algorithm>
#include <utility>

// Leaving and applying a fit.

using vcg::fcd::Error;

void FitSession::expectFitted(const MeshModel &target) const {
    if (now.shape == FitShape::Rest)
        throw Error("Nothing is fitted yet: place pairs, or press 'Pull', then apply.");
    expectWhole(now.pairs);
    if (now.shape == FitShape::Pulled && !pulled(target))
        throw Error("The pull is not done yet: wait until it is, or press 'Pull'.");
}

std::shared_ptr<const FittedSurface> FitSession::fittedNow(const MeshModel &target) {
    expectFitted(target);
    if (now.shape == FitShape::Pulled)
        return lastPull;
    return std::make_shared<const FittedSurface>(
        LayerFit(document, layer, paramFor(target, true), Remark(), {}, rest.positions().data(), rest.normals().data())
            .solve(false, {}));
}

std::string FitSession::filterCall(const MeshModel &target, bool graphLayers) const {
    const FitMeshParam defaults, param = paramFor(target, now.shape == FitShape::Landmarks);
    const Scalarm stiffness = Scalarm(param.fit.stiffness), largest = Scalarm(param.fit.largestDistance);
    ScriptCall call("generate_fcd_fitted_mesh");
    call.with("target_layer", target.id());
    if (!now.pairs.empty())
        call.with("landmarks_file", std::string("pairs.csv")); // as 'Save pairs' writes them
    if (now.lines && !param.landmarksOnly)
        call.with("curves_file", now.lines->file);
    if (mayHaveTags(layer) && !hasTags(layer))
        call.with("handles", 4); // 4: none
    call.with("landmarks_only", param.landmarksOnly, false)
        .with("start", int(param.fit.start), int(defaults.fit.start))
        .with("stiffness", stiffness, Scalarm(defaults.fit.stiffness));
    if (!param.landmarksOnly && now.options.largestDistance > 0)
        call.with("largest_distance", largest);
    call.with("weights", int(param.weights), int(defaults.weights))
        .with("target_weights", int(param.targetWeights), int(defaults.targetWeights));
    return call.with("graph_layers", graphLayers, true).end() +
           (now.pairs.empty() ? "" : ", once 'Save pairs' has written pairs.csv");
}

bool FitSession::leave() {
    followFitter.reset();
    followFit.reset();
    now.shape = shown;
    if (!rest.isPosed() || isLeft)
        return false;
    const RestGuard::Shown vertices = rest.shown();
    const std::shared_ptr<const FittedSurface> pull = shownPull;
    restore();
    if (pull)
        poseFitted(document, layer, *pull);
    else
        poseAs(
            document, layer, [&](std::size_t i) { return vertices[i].first; },
            [&](std::size_t i, const Point3m &) { return vertices[i].second; });
    rest.leave();
    know(now.shape);
    shownPull = pull;
    isLeft = true;
    return true;
}

std::string FitSession::applyInPlace(const MeshModel &target) {
    const std::shared_ptr<const FittedSurface> fitted = fittedNow(target);
    const std::string call = filterCall(target, false);
    restore();
    applied.resize(now.applies);
    applied.push_back(shapeAtRest);
    poseFitted(document, layer, *fitted);
    ++now.applies;
    now.shape = FitShape::Rest;
    now.lines = nullptr; // they belong to the shape before
    keepRest();
    return call;
}

std::string FitSession::applyToNewLayer(const MeshModel &target, bool graphLayers, const Remark &remark) {
    const std::shared_ptr<const FittedSurface> fitted = fittedNow(target);
    const std::string call = filterCall(target, graphLayers);
    restore();
    FitMeshParam param = paramFor(target, now.shape == FitShape::Landmarks);
    param.graphLayers = graphLayers;
    now.shape = FitShape::Rest;
    addFitted(document, layer, *fitted, param, remark, {});
    return call;
}

// --- the weights of a pull ---

/// The weights of the layer, then those of the target. They may depend on quality or selection.
FitWeights FitSession::weightsFor(const MeshModel &target) const {
    FitWeights all = weightsOf(layer);
    const FitWeights targets = weightsOf(target);
    all.insert(all.end(), targets.begin(), targets.end());
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
        MeshModel *model = document.getMesh(number);
        if (model && (before == from.painted.end() || before->second != weights) &&
            (weights->empty() || weights->size() == model->cm.vert.size()))
            paintWeights(*model, *weights);
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
