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

/// The rest shape of a layer that is posed in place: positions and normals at rest, and the position that the last pose
/// gave to each vertex. The layer's state keeps them; they move with the vertices in memory. A vertex belongs to the
/// rest shape as long as it is, to the bit, at a position that it was given. If something else has moved all vertices
/// by one affine map, the rest shapes are moved by it, too.
///
/// If a pose becomes the rest shape, the old one is kept as an earlier one.
class RestShape {
  public:
    /// The most earlier rest shapes that are kept, besides the first. Each takes 24 bytes a vertex in single precision;
    /// few users go back farther, except to the first.
    static constexpr std::size_t mostEarlier = 8;

    static bool exists(const MeshModel &layer);
    /// Whether there is a rest shape; a copy first inherits those of its original.
    static bool inherit(const MeshDocument &document, MeshModel &layer);
    /// Makes the present shape of \p layer its rest shape. The old one becomes an earlier one, unless something else
    /// has moved or made vertices: then old shapes no longer fit the mesh, and none is kept.
    static void keep(const MeshDocument &document, MeshModel &layer);

    /// \pre the layer has a rest shape
    explicit RestShape(MeshModel &layer);

    const Point3m *positions() const { return state.position.data(); } ///< per vertex slot
    const Point3m *normals() const { return state.normal.data(); }     ///< per vertex slot
    /// Whether the normals are others than the faces'.
    bool hasOwnNormals() const { return state.ownNormals; }

    std::uint64_t shape() const; ///< shapeOf the layer at rest

    /// shapeOf the earlier rest shapes, and last of the present one; the first is that of the loaded layer.
    std::vector<std::uint64_t> shapes() const;
    /// Makes shapes()[place] the rest shape and drops those after it.
    void backTo(std::size_t place);

    /// Call it before a pose. If something else has moved the layer as a whole, moves its rest shapes alike, with a
    /// remark. \param remedy what to do, for the error \throw vcg::fcd::Error something has moved or made some vertices
    void checkVertices(const std::string &remedy, const Remark &remark);
    /// Call it after a pose: the present normals are those of the pose.
    void knowNormals();
    /// Whether vertices and faces are those of the last pose, even if they were moved.
    bool isSameMesh() const;
    /// Flips the normals of vertices whose faces something else has flipped. \return facesOf the mesh
    std::uint64_t followFaces();
    /// Gives a vertex a position, and remembers it.
    void place(std::size_t slot, const Point3m &p) {
        state.vertex[slot].now = {p[0], p[1], p[2]};
        mesh.vert[slot].P() = p;
    }

    /// Prefetches what place() needs.
    void prefetch(std::size_t slot) const {
        vcg::fcd::Prefetch(&state.position[slot]);
        vcg::fcd::Prefetch(&state.vertex[slot]);
        vcg::fcd::Prefetch(&mesh.vert[slot]);
    }

    /// Gives the layer its rest shape, to the bit; normals of faces are computed.
    void restore();

    /// A number for a position; not 0.
    static std::uint64_t placeOf(const Point3m &position);
    /// Whether a vertex at \p p is where it was put. \param here placeOf(p)
    static bool isAtHome(const RestState &state, std::size_t slot, const Point3m &p, std::uint64_t here) {
        const PosedVertex &known = state.vertex[slot];
        return here == known.before || (known.isKnown() && (known.isAt(p) || p == state.position[slot]));
    }

  private:
    std::uint64_t countStrangers(); ///< number of vertices that are not at home
    bool followMove();
    /// Whether a vertex is at a position that it was given; remembers it as the one before a pose.
    bool isAtHome(std::size_t slot);

    MeshModel &layer;
    CMeshO &mesh;
    RestState &state;
};

/// Puts positions and normals of a posed layer at rest while this object exists. \pre checkVertices
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
