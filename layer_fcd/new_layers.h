// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_NEW_LAYERS_H
#define FCD_NEW_LAYERS_H

#include "parameters.h"
#include "prepared_layers.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

/// Adds layers to a document, all or none: without keep(), the destructor removes them, and restores the current layer.
class NewLayers {
  public:
    /// \param base gives the new layers their names (labelOf) and its matrix
    /// \param replaced deleted by keep(); new layers may have their names
    NewLayers(MeshDocument &document, const MeshModel &base, const Remark &remark,
              std::vector<MeshModel *> replaced = {});
    NewLayers(const NewLayers &) = delete;
    NewLayers &operator=(const NewLayers &) = delete;
    ~NewLayers();

    /// "NAME what" with a vertex for each node of \p graph (quality = patch radius, colour = patch colour, attribute
    /// "energy" if there is any) and its edges. Its state says that it is the base's graph.
    MeshModel &addGraph(const QString &what, const vcg::fcd::GraphGeometry &graph, bool isDeformed);

    /// "NAME what" with \p points, 3 x n, world units, and edges from each to the next.
    MeshModel &addLine(const QString &what, const Eigen::Matrix3Xd &points);

    /// "NAME what": \p graph as a surface, for formats without edges: a ball for each node, a tube for each edge.
    MeshModel &addGraphSurface(const QString &what, const vcg::fcd::GraphGeometry &graph);

    /// "NAME what": the base with vertices and faces coloured by patch, quality = patch number, without textures.
    /// \param patchOf per vertex slot of the base \param color per patch
    MeshModel &addPatches(const QString &what, const std::vector<vcg::fcd::Index> &patchOf,
                          const std::vector<vcg::Color4b> &color);

    /// "NAME what" with \p vertices, 3 x n, mesh units of the base, and \p faces.
    MeshModel &addSurface(const QString &what, const Eigen::Matrix3Xd &vertices,
                          const std::vector<std::array<std::size_t, 3>> &faces);

    /// "NAME what": a copy of the base with other positions. \param position 3 x vertex slots of the base
    /// \param linear per slot, maps normals of its own and principal directions; empty: there are none
    /// \param quality per slot; empty: the base's
    MeshModel &addDeformed(const QString &what, const Eigen::Matrix3Xd &position,
                           const std::vector<Eigen::Matrix3f> &linear, const std::vector<float> &quality);

    /// Gives \p layer, made by addDeformed with \p position, the vector attribute "fcd_displacement" per vertex: from
    /// the base's position to its own, mesh units. It replaces an attribute of that name.
    void addDisplacement(MeshModel &layer, const Eigen::Matrix3Xd &position) const;

    /// The layers of a deformation: "NAME graph" at rest and "NAME deformed graph", which keeps the deformation, unless
    /// \p graphOf, the deformer, is null; last "NAME what", as in addDeformed.
    std::vector<MeshModel *> addResult(const QString &what, const vcg::fcd::DeformationResult &result,
                                       const std::vector<float> &quality,
                                       const std::shared_ptr<const Prepared> &graphOf);

    /// Keeps the layers; \p current becomes the current one. First reports that all is done (the last chance to
    /// cancel), then calls \p before, which may still fail. \throw vcg::fcd::Cancelled, and what \p before throws
    void keep(const MeshModel &current, const vcg::fcd::Progress &progress, const std::function<void()> &before = {});

    /// The same for results of \p source: the last becomes the current layer, and, in the window, the only visible one.
    void keepResults(MeshModel &source, const std::vector<MeshModel *> &results, const vcg::fcd::Progress &progress);

    /// The same for several, all or none.
    static void keep(const std::vector<std::unique_ptr<NewLayers>> &several, const MeshModel &current,
                     const vcg::fcd::Progress &progress);

  private:
    void keepNow(const MeshModel &current);
    MeshModel &add(const QString &what);
    MeshModel &addPoints(const QString &what, const Eigen::Matrix3Xd &points,
                         const std::vector<std::array<vcg::fcd::Index, 2>> &edges);
    MeshModel &addCopy(const QString &what, int withoutElements, const Eigen::Matrix3Xd *position = nullptr);

    MeshDocument &document;
    const MeshModel &base;
    Remark remark;
    std::vector<MeshModel *> added, replaced;
    std::vector<QString> labels; ///< of the added layers
    bool kept = false;
};

// --- results of filters in the window (host::inWindow), and their sources, so that one try replaces another ---

/// Shows the last of \p results, if there are any, and hides the others and their \p source. Only in the window.
void showLast(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The same, and remembers the source, so that another try replaces the results.
void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results);

/// The source of \p layer, if it still exists and \p layer has not changed since; else \p layer.
MeshModel &sourceOf(MeshDocument &document, MeshModel &layer);

/// The earlier results of \p source that have the same bits still: not moved, painted, tagged, deleted or renamed.
std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source);

/// The vertices of \p graph in the coordinates of \p layer, 3 x k.
/// \throw vcg::fcd::Error \p graph is null, is \p layer itself or has no vertex
Eigen::Matrix3Xd readNodes(const MeshModel &layer, const MeshModel *graph);

/// FCD: Build Deformation Graph: adds layers with the graph of \p layer, first its nodes, then those of \p param.
/// \throw vcg::fcd::Error \throw vcg::fcd::Cancelled; the document is then as it was
vcg::fcd::CentroidalGraph addGraphLayers(MeshDocument &document, MeshModel &layer, const BuildGraphParam &param,
                                         const Remark &remark, const vcg::fcd::Progress &progress);

#endif
