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

/// New layers that stay in the document all or none: those that were added are removed again, and the current layer is
/// the one it was, unless keep() is reached.
class NewLayers {
  public:
    /// \p base names the layers ("NAME what"; "NAME what 2" where it is itself "NAME deformed", and so on) and gives
    /// them its matrix. \p replaced go when the new ones are kept, which may have their names.
    NewLayers(MeshDocument &document, const MeshModel &base, const Remark &remark,
              std::vector<MeshModel *> replaced = {});
    NewLayers(const NewLayers &) = delete;
    NewLayers &operator=(const NewLayers &) = delete;
    ~NewLayers();

    /// "NAME what" with a vertex for each node of \p graph (quality = patch radius, colour = patch colour, attribute
    /// "energy" if there is any) and its edges. The layer knows that it is that of the base.
    MeshModel &addGraph(const QString &what, const vcg::fcd::GraphGeometry &graph, bool isDeformed);

    /// "NAME what" with \p points, 3 x n in the world, and edges from each to the next.
    MeshModel &addLine(const QString &what, const Eigen::Matrix3Xd &points);

    /// "NAME what": \p graph as a surface, which every format keeps: a ball for each node, a tube for each edge.
    MeshModel &addGraphSurface(const QString &what, const vcg::fcd::GraphGeometry &graph);

    /// "NAME what": the base coloured by patch, vertices and faces, quality = patch number. \p patchOf per slot of the
    /// base's vertices, \p color per patch. Textures, which would hide the colours, are left out.
    MeshModel &addPatches(const QString &what, const std::vector<vcg::fcd::Index> &patchOf,
                          const std::vector<vcg::Color4b> &color);

    /// "NAME what": \p vertices, 3 x n, mesh units of the base, and \p faces of them.
    MeshModel &addSurface(const QString &what, const Eigen::Matrix3Xd &vertices,
                          const std::vector<std::array<std::size_t, 3>> &faces);

    /// "NAME what": the base with all that it carries at other positions, 3 x slots of the base's vertices. \p linear
    /// per slot turns normals that are not those of the faces, and principal directions; empty: there are none.
    /// \p quality per slot is that of the new layer; empty: the base's.
    MeshModel &addDeformed(const QString &what, const Eigen::Matrix3Xd &position,
                           const std::vector<Eigen::Matrix3f> &linear, const std::vector<float> &quality);

    /// Gives \p layer, which addDeformed made at \p position, the vector attribute "fcd_displacement" per vertex: the
    /// way from the base's position to its own, in their coordinates, in the place of one that the base has.
    void addDisplacement(MeshModel &layer, const Eigen::Matrix3Xd &position) const;

    /// The layers of a deformation: where \p graphOf, what it was solved with, is not null, "NAME graph" at rest and
    /// "NAME deformed graph", which keeps the deformation; last, as addDeformed, "NAME what".
    std::vector<MeshModel *> addResult(const QString &what, const vcg::fcd::DeformationResult &result,
                                       const std::vector<float> &quality,
                                       const std::shared_ptr<const Prepared> &graphOf);

    /// Reports that all is done, the last time that it can be cancelled, then calls \p before, which may still fail,
    /// and keeps the layers; \p current becomes the current one. \throw vcg::fcd::Cancelled, and what \p before does
    void keep(const MeshModel &current, const vcg::fcd::Progress &progress, const std::function<void()> &before = {});

    /// The same of what was made of \p source: the last of \p results becomes the current layer, and in the window the
    /// one that is seen.
    void keepResults(MeshModel &source, const std::vector<MeshModel *> &results, const vcg::fcd::Progress &progress);

    /// The same of several, all or none.
    static void keep(const std::vector<std::unique_ptr<NewLayers>> &several, const MeshModel &current,
                     const vcg::fcd::Progress &progress);

  private:
    static void reportDone(const vcg::fcd::Progress &progress) { progress(1, "Done"); }
    void keepNow(const MeshModel &current);
    MeshModel &add(const QString &what);
    MeshModel &addCopy(const QString &what, int withoutElements, const Eigen::Matrix3Xd *position = nullptr);

    MeshDocument &document;
    const MeshModel &base;
    Remark remark;
    std::vector<MeshModel *> added, replaced;
    std::vector<QString> labels; ///< of those that are added
    bool kept = false;
};

#endif
