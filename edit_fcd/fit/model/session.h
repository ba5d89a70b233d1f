// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_SESSION_H
#define FCD_FIT_SESSION_H

#include "edit_fcd/shape/rest_guard.h" // these before Qt
#include "edit_fcd/fit/model/pairs.h"
#include "edit_fcd/kit/history.h"

#include <layer_fcd/layer_fitter.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Weights that a brush has painted, one per vertex slot; empty: none were.
using FitWeights = std::vector<float>;

/// Weights of layers, by the layer's number. A layer that is not in it is as it is.
using PaintedLayers = std::map<int, std::shared_ptr<const FitWeights>>;

/// What is undone and redone.
struct FitState {
    std::vector<FitPair> pairs;
    FitOptions options;
    std::shared_ptr<const FitLines> lines; ///< that lead it when it is pulled; null: none
    PaintedLayers painted;
    FitShape shape = FitShape::Rest;
    std::size_t applies = 0; ///< in place, since the session began: each made its shape the rest shape

    bool operator==(const FitState &other) const {
        return pairs == other.pairs && options == other.options && lines == other.lines && painted == other.painted &&
               shape == other.shape && applies == other.applies;
    }
};

/// A layer while it is fitted to another one: its rest shape, the pairs of landmarks, and the shape that they, or the
/// target, give it. Knows nothing of mouse and screen. The layer shows that shape while this is there; restore() ends
/// that.
class FitSession {
  public:
    /// The present shape of \p layer becomes the rest shape. \throw vcg::fcd::Error tags that make no sense, or a
    /// matrix without an inverse
    FitSession(MeshDocument &document, MeshModel &layer);
    FitSession(const FitSession &) = delete;
    FitSession &operator=(const FitSession &) = delete;

    /// Whether the layer is where this has left it, with the positions and normals that it got here.
    bool isUpToDate() const;
    const FitState &state() const { return now; }
    FitState &edit() { return now; } ///< the pairs with the functions of pairs.h; paint with those below
    /// Takes up the state of an earlier session of the layer, its pairs alone where that was of other shapes; and the
    /// pairs, options and curves that the layer keeps, and the fit that it shows, where they are not those that this
    /// has left with it: undo takes the fit back, and then the others. \param before may be null
    /// \return what is wrong with the file of the curves, which are left out then; or empty
    std::string goOn(const FitSession *before);
    /// The layer keeps these, for another session and for files; the fit once it is left.
    /// \param target that is shown, or null
    void keep(const MeshModel *target);
    std::string targetName; ///< of the layer that this one is fitted to, as a person chose it; empty: the first other
    const RestGuard &restShape() const { return rest; }
    Eigen::Vector3d positionOf(std::size_t slot) const; ///< of a vertex, as it is shown; world

    // --- changes; each begins with change(), which undo() takes back ---

    void change() { history.begin(now); }
    bool undo(); ///< \return whether there was something
    bool redo();

    // --- what counts, as a brush paints it; a stroke is one change ---

    /// How much each vertex of this layer, or of the target, counts when it is pulled; empty: all counts.
    /// \throw vcg::fcd::Error they have no such weights
    FitWeights weightsOf(const MeshModel &of) const;
    /// A stroke begins, from what counts so far.
    void beginStroke(MeshModel &on);
    /// Vertices of the layer of the stroke count as much from now on. \param weight 0 is carried along, 1 counts
    void paint(const std::vector<std::size_t> &vertices, float weight);
    /// The stroke is what its layer is painted with, and the options say so. \return whether it has painted anything
    bool endStroke();

    // --- the shape ---

    /// What prepares the layer to follow its landmarks, to be run beside the window; then finishPreparing(). Null where
    /// follow() needs no preparing.
    std::shared_ptr<const LayerFit> beginPreparing() const;
    void finishPreparing(std::shared_ptr<const LayerFit> fit, std::shared_ptr<const vcg::fcd::Fitter> fitter);
    /// Shows the surface as it follows its landmarks; at rest where there are none. \pre it is prepared
    /// \param full with the normals of faces and the bounding box \throw vcg::fcd::Error
    void follow(bool full);

    /// What pulls the layer onto \p target, to be run beside the window; then finishPull(). \throw vcg::fcd::Error
    std::shared_ptr<LayerFit> beginPull(const MeshModel &target);
    void finishPull(const MeshModel &target, std::shared_ptr<const FittedSurface> fitted);
    /// The last pull, if it is that of the present state; else null.
    const FittedSurface *pulled(const MeshModel &target) const;
    void showPulled();

    /// The rest shape, to the bit.
    void restore();

    // --- what stays ---

    /// The layer keeps the shape that it shows. It stays a pose of the rest shape, which FCD: Reset Pose gives back,
    /// and the session goes on if the layer isUpToDate(). \return false: it was at rest, or has kept the shape before
    bool leave();
    /// Whether the layer has the shape that leave(), here or before, has left it.
    bool isAsLeft() const { return isLeft; }
    /// \throw vcg::fcd::Error nothing is fitted that could be applied
    void expectFitted(const MeshModel &target) const;
    /// The layer keeps the shape that it shows, which is its rest shape from now on. \return the filter call that makes
    /// the same in a new layer \throw vcg::fcd::Error nothing is fitted
    std::string applyInPlace(const MeshModel &target);
    /// The layer is at rest, and new layers have the shape; one of them is the current layer. \return the filter call
    std::string applyToNewLayer(const MeshModel &target, bool graphLayers, const Remark &remark);

  private:
    /// What is being painted.
    struct Stroke {
        int layer;          ///< number
        FitWeights before;  ///< as they were painted then
        FitWeights weights; ///< by which the layer counts now
        bool isPainted;     ///< whether these are others than when it began
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
    void know(FitShape shape, bool full);
    void know(FitShape shape);
    std::string takeTold(const FitToolState &told);

    MeshDocument &document;
    MeshModel &layer;
    RestGuard rest;
    std::uint64_t shapeAtRest = 0;   ///< as shapeOf tells it
    bool isLeft = false;             ///< the layer has what leave() gave it
    FitShape shown = FitShape::Rest; ///< by the layer
    bool isFree = true;              ///< nothing is fixed, and there is no handle
    bool hasDirections = false;      ///< as FitParam::linear

    FitState now;
    std::optional<Stroke> stroke;
    std::shared_ptr<const FitToolState> kept; ///< that the layer got here, or that was taken from it
    History<FitState> history{64};            // each may hold weights of its own
    std::vector<std::uint64_t> applied;       ///< the rest shape before each apply

    std::shared_ptr<const LayerFit> followFit; ///< which followFitter needs
    std::shared_ptr<const vcg::fcd::Fitter> followFitter;
    vcg::fcd::FitStart followStart = vcg::fcd::FitStart::AsItLies;

    std::shared_ptr<const FittedSurface> lastPull, shownPull; ///< that the layer shows; null: it shows none
    FitState pulledFrom;
    FitWeights pulledWeights; ///< as weightsFor
    int pulledOnto = -1;      ///< number of the layer
};

#endif
