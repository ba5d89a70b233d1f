// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_FITTER_H
#define FCD_LAYER_FITTER_H

#include <vcg_ext/fit.h> // before Qt

#include "inherited.h"
#include "layer_contents.h"
#include "layer_normals.h"
#include "parameters.h"
#include "rest_shape.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

struct Prepared;

/// The result of a fit, before it is a layer.
struct FittedSurface {
    vcg::fcd::DeformationResult result;
    vcg::fcd::FitReport report;
    double diagonal = 0;         ///< of the surface that bends, world units
    std::size_t landmarks = 0;   ///< number of landmarks
    vcg::fcd::CurveLead curves;  ///< curves that vertices slide along
    bool landmarksOnly = false;  ///< nothing was matched
    std::vector<double> check;   ///< errors of landmarks that were not given to the fit, world units
    std::vector<double> leftOut; ///< with FitMeshParam::leaveOneOut: error of each landmark in a fit without it
    std::vector<float> distance; ///< from the target, one per vertex slot, world units; empty: not measured
    std::vector<char> matched;   ///< whether each vertex lies on the target; empty: not measured
    std::shared_ptr<const vcg::fcd::Fitter> fitter; ///< with FitMeshParam::graphLayers; else null
};

/// Fits a layer to another one, for the filter and the tool. The constructor reads all that is needed of both, so
/// solve() may run in another thread than the window's.
class LayerFit {
  public:
    /// \param rest, normal of each vertex slot, instead of the layer's own; they must outlive this, and
    /// param.fit.linear must say whether the layer has directions; or null \param remark may be empty \throw
    /// vcg::fcd::Error, vcg::fcd::Cancelled
    LayerFit(MeshDocument &document, MeshModel &layer, const FitMeshParam &param, const Remark &remark,
             const vcg::fcd::Progress &progress, const Point3m *rest = nullptr, const Point3m *normal = nullptr);
    LayerFit(const LayerFit &) = delete;
    LayerFit &operator=(const LayerFit &) = delete;

    /// Fits; may be called once. The fitter of the result refers to this object.
    /// \param measure also measures distances \throw vcg::fcd::Error, vcg::fcd::Cancelled
    FittedSurface solve(bool measure, const vcg::fcd::Progress &progress) &&;

    /// The first part of solve. \throw as solve
    std::shared_ptr<const vcg::fcd::Fitter> prepare(const vcg::fcd::Progress &progress) const;

  private:
    const FitMeshParam param;
    std::string name, targetName; ///< of the layers, in quotation marks
    vcg::fcd::Handles handles;
    std::vector<vcg::fcd::Landmark> landmarks, checks;
    std::vector<vcg::fcd::CurvePair> curves;
    vcg::fcd::SurfaceArrays surface;
    vcg::fcd::SurfaceArrays targetSurface; ///< until it is prepared
    vcg::fcd::NormalOf normal;
    std::vector<Eigen::Vector3d> targetNormal;
    std::vector<float> weight, targetWeight; ///< by slot; empty: 1
    vcg::fcd::FitGoal goal;
};

/// The result of FCD: Fit to Layer.
struct FittedLayers : FittedSurface {
    double seconds = 0;
};

/// FCD: Fit to Layer: adds layers with \p layer fitted to another one. \param remark may be empty
/// \throw vcg::fcd::Error, vcg::fcd::Cancelled; the document is then as it was
FittedLayers fitLayer(MeshDocument &document, MeshModel &layer, const FitMeshParam &param, const Remark &remark,
                      const vcg::fcd::Progress &progress);

/// The deformer of a fit, for its graph layers to keep; null without a \p fitter.
std::shared_ptr<Prepared> preparedOf(const std::shared_ptr<const vcg::fcd::Fitter> &fitter,
                                     const vcg::fcd::TagCount &tags);

/// Adds the layers of a fit, with graph layers if asked for; the fitted one becomes the current layer.
/// \pre \p layer has the shape that was fitted \throw vcg::fcd::Cancelled; the document is then as it was
void addFitted(MeshDocument &document, MeshModel &layer, const FittedSurface &fitted, const FitMeshParam &param,
               const Remark &remark, const vcg::fcd::Progress &progress);

/// Gives \p layer a shape; its present one becomes the rest shape. \param positionAt positionAt(slot)
/// \param normalAt normalAt(slot, normal at rest), called if the layer has normals of its own
template <class PositionAt, class NormalAt>
void poseAs(const MeshDocument &document, MeshModel &layer, const PositionAt &positionAt, const NormalAt &normalAt) {
    CMeshO &mesh = layer.cm;
    handDownRest(document, layer);
    if (!RestShape::exists(layer) || RestShape(layer).shape() != shapeOf(mesh))
        RestShape::keep(document, layer);
    RestShape rest(layer);
    forVertices(mesh, [&](std::size_t i) { rest.place(i, positionAt(i)); });
    computeBoxAndNormals(mesh);
    if (rest.hasOwnNormals())
        forVertices(mesh, [&](std::size_t i) { mesh.vert[i].N() = normalAt(i, rest.normals()[i]); });
    rest.knowNormals();
}

/// Gives \p layer a fit's shape, with the bits of addFitted; its present one, which was fitted, becomes the rest shape.
void poseFitted(const MeshDocument &document, MeshModel &layer, const FittedSurface &fitted);

#endif
