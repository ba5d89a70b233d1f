// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/fit_start.h> // before Qt

#include "edit_fcd/fit/model/session.h"

#include <layer_fcd/kept_tool.h>
#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_normals.h>
#include <layer_fcd/layer_deformer.h>
#include <layer_fcd/handle_sources.h>

#include <algorithm>

using vcg::fcd::Error;
using vcg::fcd::FitStart;

FitSession::FitSession(MeshDocument &document, MeshModel &layer)
    : document(document), layer(layer), rest(layer), hasDirections(::hasDirections(layer)) {
    keepRest();
    HandleParam param;
    param.source = HandleParam::Known;
    for (const int tag : readTags(layer, param))
        isFree = isFree && tag == 1;
}

void FitSession::keepRest() {
    rest.keep();
    know(FitShape::Rest);
    shapeAtRest = rest.known();
    followFitter.reset();
    followFit.reset();
    lastPull.reset();
    shownPull.reset();
}

std::string FitSession::goOn(const FitSession *before) {
    if (before && (shapeAtRest == before->shapeAtRest || shapeAtRest == before->rest.known())) {
        now = before->now;
        now.shape = FitShape::Rest;
        now.applies = 0;
    } else if (before) {
        setPairs(before->now.pairs);
    }
    const auto fit = LayerState::known(layer).fit;
    if (fit == kept)
        return "";
    kept = fit;
    const FitToolState stored = fit ? *fit : FitToolState();
    targetName = stored.target;
    const std::string wrong = takeStored(stored);
    if (const FitShape left = fitShownBy(layer); left != FitShape::Rest) {
        rest.keepPosed([this] { keepRest(); });
        change();
        now.shape = shown = left;
        isLeft = true;
    }
    return wrong;
}

std::string FitSession::takeStored(const FitToolState &stored) {
    const bool hasCurves = stored.curves == (now.lines ? now.lines->file : "");
    if (stored.pairs == now.pairs && stored.options == now.options && hasCurves)
        return "";
    change();
    setPairs(stored.pairs);
    now.options = stored.options;
    if (hasCurves)
        return "";
    now.lines = nullptr;
    try {
        if (!stored.curves.empty())
            now.lines = loadLines(layer, rest.positions().data(), stored.curves);
    } catch (const Error &e) {
        return e.what();
    }
    return "";
}

void FitSession::keep(const MeshModel *target) {
    FitToolState next;
    next.pairs = now.pairs;
    next.options = now.options;
    next.target = targetName;
    next.curves = now.lines ? now.lines->file : "";
    if (isLeft) {
        next.shown = shown;
        next.shape = rest.known();
        next.matrix = layer.cm.Tr;
    }
    const bool isAny = !next.pairs.empty() || next.isSet() || isLeft;
    if (isAny && next.target.empty() && target) // the name, since numbers differ in other documents
        next.target = target->label().toStdString();
    if (kept ? *kept == next : !isAny)
        return;
    if (isAny)
        LayerState::made(document, layer).fit = kept = std::make_shared<const FitToolState>(std::move(next));
    else if (LayerState *present = LayerState::of(layer))
        present->fit = kept = nullptr;
}

Eigen::Vector3d FitSession::positionOf(std::size_t slot) const {
    return rest.world() * toVector(layer.cm.vert[slot].cP());
}

// --- changes ---

bool FitSession::undo() {
    const FitState from = now;
    if (!history.undo(now) || now.applies == from.applies) {
        showPainted(from);
        return !(now == from);
    }
    // Undo of an apply: back to the rest shape before it, without a redo.
    restore();
    history.forgetUndone();
    if (!goBackTo(document, layer, applied[now.applies])) {
        now = from;
        history.forget([](const FitState &) { return true; });
        return false;
    }
    applied.resize(now.applies);
    showPainted(from);
    keepRest();
    return true;
}

bool FitSession::redo() {
    const FitState from = now;
    if (!history.redo(now))
        return false;
    showPainted(from);
    return true;
}

/// Sets the pairs, without ends at vertices that do not exist.
void FitSession::setPairs(std::vector<FitPair> pairs) {
    now.pairs = std::move(pairs);
    const auto &vertices = layer.cm.vert;
    for (FitPair &each : now.pairs)
        if (each.slot && (*each.slot >= vertices.size() || vertices[*each.slot].IsD()))
            each.slot.reset();
}

// --- the shape ---

std::vector<vcg::fcd::Landmark> FitSession::landmarks() const {
    std::vector<vcg::fcd::Landmark> landmarks;
    for (const FitPair &each : now.pairs)
        if (each.slot && each.place)
            landmarks.push_back({*each.slot, *each.place, rest.world().linear() * each.offset});
    return landmarks;
}

FitStart FitSession::start(bool byLandmarksOnly) const {
    const FitStart wanted = now.options.start;
    if (!isFree || (wanted == FitStart::TriedAxes && byLandmarksOnly))
        return FitStart::AsItLies;
    if (wanted == FitStart::Rigid || wanted == FitStart::Similar) {
        std::vector<Eigen::Vector3d> places;
        for (const vcg::fcd::Landmark &each : landmarks())
            places.emplace_back(rest.world() * rest.at(each.vertex));
        // If landmarks are nearly on a line, errors of clicks decide the turn about it. They are about a hundredth of
        // the length: six degrees at a tenth of the length across.
        const double leastAcross = 0.1;
        if (!(vcg::fcd::AcrossALine(places) > leastAcross))
            return FitStart::AsItLies;
    }
    return wanted;
}

FitMeshParam FitSession::paramFor(const MeshModel &target, bool landmarksOnly) const {
    FitMeshParam param;
    param.target = &target;
    param.handles.source = HandleParam::Known;
    param.landmarks = landmarks();
    param.landmarksOnly = landmarksOnly;
    param.fit.linear = hasDirections;
    param.fit.smoothness = asTyped(param.fit.smoothness); // in the precision that filters get
    param.fit.start = start(landmarksOnly);
    if (!landmarksOnly) {
        param.fit.stiffness = asTyped(now.options.stiffness);
        if (now.options.largestDistance > 0)
            param.fit.largestDistance = asTyped(now.options.largestDistance);
        param.weights = now.options.weights;
        param.targetWeights = now.options.targetWeights;
        if (now.lines)
            param.curves = now.lines->curves;
    }
    return param;
}

std::shared_ptr<const LayerFit> FitSession::beginPreparing() const {
    if (landmarks().empty() || (followFitter && followStart == start(true)))
        return nullptr;
    FitMeshParam param = paramFor(layer, true);
    param.target = nullptr;
    param.fit.judgesLandmarks = false; // takes too long for a drag
    return std::make_shared<const LayerFit>(document, layer, param, Remark(), vcg::fcd::Progress(),
                                            rest.positions().data(), rest.normals().data());
}

void FitSession::finishPreparing(std::shared_ptr<const LayerFit> fit, std::shared_ptr<const vcg::fcd::Fitter> fitter) {
    followFitter = std::move(fitter);
    followFit = std::move(fit);
    followStart = start(true);
}

void FitSession::follow(bool full) {
    const std::vector<vcg::fcd::Landmark> given = landmarks();
    if (given.empty()) {
        restore();
        return;
    }
    vcg::fcd::FitReport report;
    const vcg::fcd::Deformer::Pose pose = followFitter->Solve(*followFitter->TargetOf(given), given, report);
    rest.leave();
    shownPull.reset();
    writeMoving(layer.cm, rest.positions().data(), rest.normals().data(), *preparedOf(followFitter, {}), pose);
    know(FitShape::Landmarks, full);
}

std::shared_ptr<LayerFit> FitSession::beginPull(const MeshModel &target) {
    expectWhole(now.pairs);
    lastPull.reset();
    pulledWeights = weightsFor(target);
    return std::make_shared<LayerFit>(document, layer, paramFor(target, false), Remark(), vcg::fcd::Progress(),
                                      rest.positions().data(), rest.normals().data());
}

void FitSession::finishPull(const MeshModel &target, std::shared_ptr<const FittedSurface> fitted) {
    lastPull = std::move(fitted);
    pulledFrom = now;
    pulledOnto = target.id();
}

const FittedSurface *FitSession::pulled(const MeshModel &target) const {
    const bool isThat = lastPull && now.shape == FitShape::Pulled && pulledOnto == target.id() &&
                        pulledFrom.options == now.options && pulledFrom.lines == now.lines &&
                        pulledFrom.pairs.size() == now.pairs.size() && hasPulledWeights(target) &&
                        std::equal(now.pairs.begin(), now.pairs.end(), pulledFrom.pairs.begin(),
                                   [](const FitPair &a, const FitPair &b) {
                                       return a.slot == b.slot && a.place == b.place && a.offset == b.offset;
                                   });
    return isThat ? lastPull.get() : nullptr;
}

void FitSession::showPulled() {
    rest.leave();
    shownPull = lastPull;
    forVertices(layer.cm,
                [&](std::size_t i) { layer.cm.vert[i].P() = toPoint(lastPull->result.position.col(Eigen::Index(i))); });
    know(FitShape::Pulled, true);
}

/// Call after the layer has got a shape. \param full computes the box, and the normals of a mesh
void FitSession::know(FitShape shape, bool full) {
    if (full)
        computeBoxAndNormals(layer.cm);
    rest.know();
    shown = shape;
    isLeft = false;
}

void FitSession::restore() {
    rest.restore();
    shownPull.reset();
    know(FitShape::Rest);
}
