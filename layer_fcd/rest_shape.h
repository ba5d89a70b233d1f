// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_REST_SHAPE_H
#define FCD_REST_SHAPE_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/base/memory.h>
#include <vcg_ext/surface/surface_arrays.h>

#include "layer_state.h"
#include "parameters.h" // Remark

#include <cstdint>
#include <string>
#include <vector>

/// The rest shape of a layer that is posed in place: positions and normals of its vertices, which its state keeps, and
/// where the last pose left each of them. These go with their vertices wherever the host moves them in memory, so that
/// each is known by itself: it belongs to the rest shape as long as it is, to the bit, at a place that it was given.
/// Where something else has moved all of them by one affine map, the rest shapes follow by that.
///
/// When a pose is applied, so that the next begins from it, the old rest shape is kept as an earlier one.
class RestShape {
  public:
    /// How many earlier rest shapes are kept, beside the first. Each takes 24 bytes a vertex in single precision; few
    /// people go back farther, except to the first.
    static constexpr std::size_t mostEarlier = 8;

    static bool exists(const MeshModel &layer);
    /// Whether there is one. A copy takes over the rest shapes of its original.
    static bool inherit(const MeshDocument &document, MeshModel &layer);
    /// Where the last pose left each vertex slot. \pre the layer has a rest shape
    static const PosedVertex *lastPlaces(const MeshModel &layer);
    /// Makes the present shape of \p layer its rest shape. The old one becomes an earlier one. If something else has
    /// moved or made vertices, old shapes no longer fit the mesh, and none is kept.
    static void keep(const MeshDocument &document, MeshModel &layer);
    /// Forgets all rest shapes.
    static void drop(const MeshModel &layer);

    /// \pre the layer has a rest shape
    explicit RestShape(MeshModel &layer);

    const Point3m *positions() const { return state.position.data(); } ///< per vertex slot
    const Point3m *normals() const { return state.normal.data(); }     ///< per vertex slot
    /// Whether the normals are others than the faces'.
    bool hasOwnNormals() const { return state.ownNormals; }

    std::uint64_t shape() const; ///< at rest, as shapeOf tells it

    /// The earlier rest shapes and last the present one, as shapeOf tells them; the first is that of the layer as it
    /// was loaded.
    std::vector<std::uint64_t> shapes() const;
    /// Makes shapes()[place] the rest shape and drops those after it.
    void backTo(std::size_t place);

    /// Before a pose. Where something else has moved the layer as a whole, its rest shapes are moved alike, and a
    /// remark says so. \throw vcg::fcd::Error when it has moved or made some vertices; \p remedy says what to do
    void checkVertices(const std::string &remedy, const Remark &remark);
    /// Remembers that a pose gave the layer its present normals.
    void knowNormals();
    /// Whether vertices and faces are those of the last pose, wherever something else may have moved them.
    bool isSameMesh() const;
    /// Flips the normals of vertices whose faces something else has flipped. \return facesOf the mesh
    std::uint64_t followFaces();
    /// Gives a vertex a position, and remembers it.
    void place(std::size_t slot, const Point3m &p) {
        state.vertex[slot].now = {p[0], p[1], p[2]};
        mesh.vert[slot].P() = p;
    }

    /// Begins to read what is needed to place a vertex.
    void prefetch(std::size_t slot) const {
        vcg::fcd::Prefetch(&state.position[slot]);
        vcg::fcd::Prefetch(&state.vertex[slot]);
        vcg::fcd::Prefetch(&mesh.vert[slot]);
    }

    /// Gives the layer its rest shape back, to the bit; normals of faces are computed.
    void restore();

    /// A number for a position; not 0.
    static std::uint64_t placeOf(const Point3m &position);

  private:
    std::uint64_t countStrangers(); ///< vertices that are not where they were put
    bool followMove();
    /// Whether a vertex is where it was put; that place is then the one that it has before a pose.
    bool isAtHome(std::size_t slot);

    MeshModel &layer;
    CMeshO &mesh;
    RestState &state;
};

/// Puts a posed layer at rest for as long as this lives: positions and normals. \pre checkVertices
class AtRest {
  public:
    explicit AtRest(MeshModel &layer);
    AtRest(const AtRest &) = delete;
    AtRest &operator=(const AtRest &) = delete;
    ~AtRest();

  private:
    CMeshO &mesh;
    Shape other;
};

/// A number for the positions of all vertices.
std::uint64_t shapeOf(const CMeshO &mesh);

#endif
