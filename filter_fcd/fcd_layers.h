// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYERS_H
#define FCD_LAYERS_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/centroidal_deformation.h>

#include "fcd_parameters.h"
#include "meshlab_host.h"

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

/// Says something that is worth knowing but no error.
using Remark = std::function<void(const std::string &)>;

// --- layers -> vcg_ext ---

/// The matrix of \p layer, which leads from its coordinates to those of the world. \throw vcg::fcd::Error when it is
/// not finite, or not affine
Eigen::Affine3d matrixOf(const MeshModel &layer);
/// Whether \p layer has normals of its own (hasOwnNormals), or principal directions, which turn with the surface.
bool hasDirections(const MeshModel &layer);
/// The linear part of the matrix of \p layer, by which lengths are measured; the identity where it has no inverse.
Eigen::Matrix3d metricOf(const MeshModel &layer);

/// The same, for where the way back is needed. \throw vcg::fcd::Error also when it has no inverse
Eigen::Affine3d invertibleMatrixOf(const MeshModel &layer);

/// The positions of the vertices of \p layer, 3 x slots.
Eigen::Matrix3Xd positionsOf(const MeshModel &layer);

/// How many bytes a file may have that holds at most \p each for a vertex of \p layer, and comments.
std::size_t mostBytes(const MeshModel &layer, std::size_t each);

/// Whether each slot of the layer's vertex vector belongs to a selected face.
std::vector<char> onSelectedFaces(const MeshModel &layer);

/// Whether \p layer has a quality that is not 0 everywhere.
bool hasQuality(const MeshModel &layer);
/// Whether that may be tags: whole numbers.
bool mayHaveTags(const MeshModel &layer);

/// The tags of \p layer, one per slot of its vertex vector. With point handles, all is free where nothing is tagged.
/// \throw vcg::fcd::Error when they cannot be had
std::vector<int> readTags(const MeshModel &layer, const HandleParam &param);

/// Tags (per slot of the layer's vertex vector) and point handles of \p layer, without motions.
/// \throw vcg::fcd::Error when they cannot be had: each message says what to do
vcg::fcd::Handles readHandles(const MeshModel &layer, const HandleParam &param);

/// Adds to \p handles of \p layer their motions, in world coordinates. \param centers of the handles, in the layer's
/// \return whether any handle moves
/// \throw vcg::fcd::Error when the motions cannot be had: each message says what to do
bool readMotions(const MeshDocument &document, const MeshModel &layer, const HandleParam &param,
                 const std::map<vcg::fcd::Index, Eigen::Vector3d> &centers, const Remark &remark,
                 vcg::fcd::Handles &handles);

/// Whether \p layer looks like a graph that was built, not like points that were placed: its quality may be radii.
bool isGraph(const MeshModel &layer);

/// The vertices of \p graph in the coordinates of \p layer, 3 x k.
/// \throw vcg::fcd::Error when \p graph is null, is \p layer itself or has no vertex
Eigen::Matrix3Xd readNodes(const MeshModel &layer, const MeshModel *graph);

// --- vcg_ext -> layers ---

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
    /// "energy" if there is any) and its edges.
    MeshModel &addGraph(const QString &what, const vcg::fcd::GraphGeometry &graph);

    /// "NAME what": \p graph as a surface, which every format keeps: a ball for each node, a tube for each edge.
    MeshModel &addGraphSurface(const QString &what, const vcg::fcd::GraphGeometry &graph);

    /// "NAME what": the base coloured by patch, vertices and faces, quality = patch number. \p patchOf per slot of the
    /// base's vertices, \p color per patch. Textures, which would hide the colours, are left out.
    MeshModel &addPatches(const QString &what, const std::vector<vcg::fcd::Index> &patchOf,
                          const std::vector<vcg::Color4b> &color);

    /// "NAME what": the base with all that it carries at other positions, 3 x slots of the base's vertices. \p linear
    /// per slot turns normals that are not those of the faces, and principal directions; empty: there are none.
    /// \p quality per slot is that of the new layer; empty: the base's.
    MeshModel &addDeformed(const QString &what, const Eigen::Matrix3Xd &position,
                           const std::vector<Eigen::Matrix3f> &linear, const std::vector<float> &quality);

    /// Keeps the layers; \p current becomes the current one.
    void keep(const MeshModel &current);

  private:
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
