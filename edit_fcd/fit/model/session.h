// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_SESSION_H
#define FCD_FIT_SESSION_H

#include "edit_fcd/shape/layer_shape.h" // these before Qt
#include "edit_fcd/fit/model/pairs.h"
#include "edit_fcd/kit/history.h"

#include <layer_fcd/layer_fitter.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Weights for a fit, one per vertex slot, [0, 1]; empty: 1 everywhere, or not painted.
using FitWeights = std::vector<float>;

/// Painted weights of layers, by number. Other layers were not painted.
using PaintedLayers = std::map<int, std::shared_ptr<const FitWeights>>;

/// What is undone and redone.
struct FitState {
    std::vector<FitPair> pairs;
    FitOptions options;
    std::shared_ptr<const FitLines> lines; ///< curves for the pull; null: none
    PaintedLayers painted;
    FitShape shape = FitShape::Rest;
    std::size_t applies = 0; ///< number of applies in place since the session began

    bool operator==(const FitState &o) const {
        return pairs == o.pairs && options == o.options && lines == o.lines && painted == o.painted &&
               shape == o.shape && applies == o.applies;
    }
};

/// A layer while it is fitted to another one: its rest shape, the pairs of landmarks, and the shape by landmarks or by
/// the target, which the layer shows until restore(). It knows neither mouse nor screen.
class FitSession {
  public:
    /// The present shape becomes the rest shape. \throw vcg::fcd::Error invalid tags, or a matrix without an inverse
    FitSession(MeshDocument &document, MeshModel &layer);
    FitSession(const FitSession &) = delete;
    FitSession &operator=(const FitSession &) = delete;

    /// Whether the layer has the matrix, positions and normals that it got here.
    bool isUpToDate() const { return rest.isAsKnown(); }
    const FitState &state() const { return now; }
    FitState &edit() { return now; } ///< change pairs with the functions of pairs.h, weights with those below
    /// Takes over the state of an earlier session of the layer; only its pairs if that had another rest shape. Then
    /// takes what else was stored with the layer: pairs, options, curves, and the shown fit. Undo first takes back the
    /// fit, then the others. \param before may be null \return why the file of curves is left out; or empty
    std::string goOn(const FitSession *before);
    /// Stores pairs, options and curves with the layer, for later sessions and files; after leave() also the fit.
    /// \param target the shown one, or null
    void keep(const MeshModel *target);
    std::string targetName; ///< of the target layer, as the user chose it; empty: the first other layer
    const RestGuard &restShape() const { return rest; }
    Eigen::Vector3d positionOf(std::size_t slot) const; ///< of a vertex, as shown; world

    // --- changes; each begins with change(), which undo() takes back ---

    void change() { history.begin(now); }
    bool undo(); ///< \return whether something was undone
    bool redo();

    // --- painted weights; a stroke is one change ---

    /// Weights of this layer's vertices, or the target's, in a pull; empty: 1. \throw vcg::fcd::Error it lacks them
    FitWeights weightsOf(const MeshModel &of) const;
    /// Begins a stroke, from the present weights.
    void beginStroke(MeshModel &on);
    /// Sets weights on the stroke's layer. \param weight 0: carried along, 1: counts
    void paint(const std::vector<std::size_t> &vertices, float weight);
    /// Ends the stroke: its layer has these weights, and the options use them. \return whether any weight has changed
    bool endStroke();

    // --- the shape ---

    /// The work that prepares follow(), for the background; then call finishPreparing(). Null if follow() needs none.
    std::shared_ptr<const LayerFit> beginPreparing() const;
    void finishPreparing(std::shared_ptr<const LayerFit> fit, std::shared_ptr<const vcg::fcd::Fitter> fitter);
    /// Shows the surface as it follows the landmarks; without any, at rest. \pre it is prepared \param full with
    /// normals of faces and the bounding box \throw vcg::fcd::Error
    void follow(bool full);

    /// The work that pulls the layer onto \p target, for the background; then call finishPull(). \throw vcg::fcd::Error
    std::shared_ptr<LayerFit> beginPull(const MeshModel &target);
    void finishPull(const MeshModel &target, std::shared_ptr<const FittedSurface> fitted);
    /// The last pull, if it is of the present state; else null.
    const FittedSurface *pulled(const MeshModel &target) const;
    void showPulled();

    /// Restores the rest shape, to the bit.
    void restore();

    // --- keeping the fit ---

    /// Leaves the layer in the shown shape. It stays a pose of the rest shape, which FCD: Reset Pose restores, and the
    /// session continues if the layer isUpToDate(). \return false: it was at rest, or was left in this shape before
    bool leave();
    /// Whether the layer has the shape of leave(), in this session or before.
    bool isAsLeft() const { return isLeft; }
    /// \throw vcg::fcd::Error no fit is shown that could be applied
    void expectFitted(const MeshModel &target) const;
    /// Makes the shown shape the layer's rest shape. \return the filter call that makes the same in a new layer
    /// \throw vcg::fcd::Error nothing is fitted
    std::string applyInPlace(const MeshModel &target);
    /// Resets the layer, and adds layers with the shape; one of them becomes the current layer. \return the filter call
    std::string applyToNewLayer(const MeshModel &target, bool graphLayers, const Remark &remark);

  private:
    /// A stroke of the brush.
    struct Stroke {
        int layer;          ///< number
        FitWeights before;  ///< as painted before
        FitWeights weights; ///< now
        bool isPainted;     ///< whether any weight has changed
    };

    void keepRest();
    void setPairs(std::vector<FitPair> pairs);
    vcg::fcd::FitStart start(bool byLandmarksOnly) const;
    std::vector<vcg::fcd::Landmark> landmarks() const;
    FitMeshParam paramFor(const MeshModel &target, bool landmarksOnly) const;
    std::shared_ptr<const FittedSurface> fittedNow(const MeshModel &target);
    FitWeights weightsFor(const MeshModel &target) const;
    bool hasPulledWeights(const MeshModel &target) const;
    void showPainted(const FitState &from);
    std::string filterCall(const MeshModel &target, bool graphLayers) const;
    void know(FitShape shape, bool full = false);
    std::string takeStored(const FitToolState &stored);

    MeshDocument &document;
    MeshModel &layer;
    RestGuard rest;
    std::uint64_t shapeAtRest = 0;   ///< shapeOf the layer at rest
    bool isLeft = false;             ///< the layer has the shape of leave()
    FitShape shown = FitShape::Rest; ///< the shape that the layer shows
    bool isFree = true;              ///< nothing is fixed, and there is no handle
    bool hasDirections = false;      ///< for FitParam::linear

    FitState now;
    std::optional<Stroke> stroke;
    std::shared_ptr<const FitToolState> kept; ///< as stored with the layer, or taken from it
    History<FitState> history{64};            // each state may have its own weights
    std::vector<std::uint64_t> applied;       ///< the rest shape before each apply

    std::shared_ptr<const LayerFit> followFit; ///< which followFitter needs
    std::shared_ptr<const vcg::fcd::Fitter> followFitter;
    vcg::fcd::FitStart followStart = vcg::fcd::FitStart::AsItLies;

    std::shared_ptr<const FittedSurface> lastPull, shownPull; ///< null: none; the layer shows none
    FitState pulledFrom;
    FitWeights pulledWeights; ///< weightsFor() the last pull
    int pulledOnto = -1;      ///< number of its target layer
};

#endif
