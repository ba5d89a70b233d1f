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

/// A layer that has been fitted, before any layer shows it.
struct FittedSurface {
    vcg::fcd::DeformationResult result;
    vcg::fcd::FitReport report;
    double diagonal = 0;         ///< of what bends, world units
    std::size_t landmarks = 0;   ///< how many there are
    vcg::fcd::CurveLead curves;  ///< that vertices slide along
    bool landmarksOnly = false;  ///< nothing else of the target counted
    std::vector<double> check;   ///< how far pairs that were kept back are off, world units
    std::vector<double> leftOut; ///< where FitMeshParam asks for it: so does each landmark without itself
    std::vector<float> distance; ///< from the target, one per vertex slot, world units; empty unless measured
    std::vector<char> matched;   ///< whether a vertex has a counterpart there; as well
    std::shared_ptr<const vcg::fcd::Fitter> fitter; ///< where FitMeshParam asks for graph layers; or null
};

/// A layer that is fitted to another one, by the filter or by the tool. What is needed of both is read when it is
/// made: solve() may run beside the window.
class LayerFit {
  public:
    /// \param rest, normal of each vertex slot, which must outlive this, where the layer has other ones, and
    /// param.fit.linear says whether it has directions; or null
    /// \param remark may be empty \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled
    LayerFit(MeshDocument &document, MeshModel &layer, const FitMeshParam &param, const Remark &remark,
             const vcg::fcd::Progress &progress, const Point3m *rest = nullptr, const Point3m *normal = nullptr);
    LayerFit(const LayerFit &) = delete;
    LayerFit &operator=(const LayerFit &) = delete;

    /// Uses up what has been read of the target; what the fitter of the result refers to stays until this goes.
    /// \param measure also the distances \throw vcg::fcd::Error \throw vcg::fcd::Cancelled
    FittedSurface solve(bool measure, const vcg::fcd::Progress &progress) &&;

    /// The first part of that. \throw as solve
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
    std::vector<float> weight, targetWeight; ///< by slot; empty: all counts
    vcg::fcd::FitGoal goal;
};

/// What FCD: Fit to Layer did.
struct FittedLayers : FittedSurface {
    double seconds = 0;
};

/// FCD: Fit to Layer: lays \p layer onto another one; the result is in new layers. \param remark may be empty
/// \throw vcg::fcd::Error each message says what to do \throw vcg::fcd::Cancelled; the document is then as it was
FittedLayers fitLayer(MeshDocument &document, MeshModel &layer, const FitMeshParam &param, const Remark &remark,
                      const vcg::fcd::Progress &progress);

/// What the layers with the graph of a fit keep; null without a \p fitter.
std::shared_ptr<Prepared> preparedOf(const std::shared_ptr<const vcg::fcd::Fitter> &fitter,
                                     const vcg::fcd::TagCount &tags);

/// Adds the layers of a fit, with graph layers where these are asked for; the fitted one is the current one then.
/// \pre \p layer has the shape that was fitted \throw vcg::fcd::Cancelled; the document is then as it was
void addFitted(MeshDocument &document, MeshModel &layer, const FittedSurface &fitted, const FitMeshParam &param,
               const Remark &remark, const vcg::fcd::Progress &progress);

/// Gives \p layer a shape; the one that it has becomes its rest shape. \param positionAt of each vertex slot
/// \param normalAt of each vertex slot, from that at rest, where the layer has normals of its own
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

/// Gives \p layer the shape of a fit, to the bit that of the layer that addFitted adds; the one that it has becomes its
/// rest shape. \pre it has the shape that was fitted
void poseFitted(const MeshDocument &document, MeshModel &layer, const FittedSurface &fitted);

#endif
