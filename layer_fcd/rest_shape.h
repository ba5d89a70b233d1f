// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_REST_SHAPE_H
#define FCD_REST_SHAPE_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/base/memory.h>
#include <vcg_ext/surface/surface_arrays.h>

#include "meshlab_host.h"
#include "parameters.h" // Remark

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/// What the state of a layer knows of a vertex: plain data, zero for a vertex that something else makes. Who changes it
/// changes the number in its name.
struct PosedVertex {
    Eigen::Vector3d place() const { return Eigen::Vector3d(double(now[0]), double(now[1]), double(now[2])); }
    bool isKnown() const { return before != 0; }
    bool isAt(const Point3m &p) const { return p[0] == now[0] && p[1] == now[1] && p[2] == now[2]; }

    std::array<Scalarm, 3> now; ///< the position that the last pose gave it
    std::uint64_t
        before; ///< that which it had then, as placeOf tells it: a preview begins with it each time; 0: unknown
};

/// What it knows of the layer: plain data as well.
struct Posed {
    /// Of earlier rest shapes that are kept: each takes as much memory as the rest shape, 24 bytes a vertex in single
    /// precision. Few people go back farther than this, but to the first.
    static constexpr std::uint32_t mostEarlier = 8;

    std::uint64_t faces = 0;       ///< facesOf the mesh
    std::uint64_t vertexSlots = 0; ///< of the mesh
    bool ownNormals = false;       ///< as hasOwnNormals tells it
    std::uint32_t made = 0;        ///< of earlier rest shapes, in all
    std::uint32_t count = 0;       ///< of those that there are
    std::array<std::uint32_t, mostEarlier> earlier =
        {}; ///< the numbers in the names of their attributes, the first first
};

/// The rest shape of a layer that is posed in place: positions and normals of its vertices, which the layer keeps as
/// attributes, and where the last pose left each of them. Attributes go with their vertices wherever these are moved
/// in memory, so that each is known by itself: it belongs to the rest shape as long as it is, to the bit, at a place
/// that it was given. Where something else has moved all of them by one affine map, the rest shapes follow by that.
///
/// Each time that a pose is applied, and the next begins from it, the rest shape of before is kept, too.
class RestShape {
  public:
    static bool exists(const MeshModel &layer);
    /// Where the last pose left each vertex slot. \pre the layer has a rest shape
    static const PosedVertex *lastPlaces(const CMeshO &mesh);
    /// Makes the present shape of \p layer its rest shape. The one of before becomes an earlier one, unless something
    /// else has moved or made vertices: none of before is one of the present mesh then, and none is kept.
    static void keep(MeshModel &layer);
    /// Forgets what keep began.
    static void drop(MeshModel &layer);

    /// \pre the layer has a rest shape
    explicit RestShape(MeshModel &layer);

    const Point3m *positions() const { return position; } ///< per vertex slot
    const Point3m *normals() const { return normal; }     ///< per vertex slot
    /// Whether the normals are others than the faces'.
    bool hasOwnNormals() const { return posed->ownNormals; }

    std::uint64_t shape() const; ///< at rest, as shapeOf tells it

    /// The earlier rest shapes and last the present one, as shapeOf tells them; the first is that of the layer as it
    /// was loaded.
    std::vector<std::uint64_t> shapes() const;
    /// The rest shape is that of shapes() at \p place from now on; what came after it is dropped.
    void backTo(std::size_t place);

    /// Before a pose. Where something else has moved the layer as a whole, its rest shapes are moved alike, and a
    /// remark says so. \throw vcg::fcd::Error when it has moved or made some vertices; \p remedy says what to do
    void checkVertices(const std::string &remedy, const Remark &remark);
    /// Whether vertices and faces are those of the last pose, wherever something else may have moved them.
    bool isSameMesh() const;
    /// Turns the normals of vertices whose faces something else has turned over. \return facesOf the mesh
    std::uint64_t followFaces();
    /// Gives a vertex a position, and remembers it.
    void place(std::size_t slot, const Point3m &p) {
        vertices[slot].now = {p[0], p[1], p[2]};
        mesh.vert[slot].P() = p;
    }

    /// Begins to read what is needed to place a vertex.
    void prefetch(std::size_t slot) const {
        vcg::fcd::Prefetch(&position[slot]);
        vcg::fcd::Prefetch(&vertices[slot]);
        vcg::fcd::Prefetch(&mesh.vert[slot]);
    }

    /// Gives the layer its rest shape back, to the bit; normals of faces are computed.
    void restore();

    /// A number for a position; not 0.
    static std::uint64_t placeOf(const Point3m &position);

  private:
    std::uint64_t countStrangers(); ///< vertices that are not where they were put
    bool followMove();
    Point3m *earlierPositions(std::uint32_t place) const;
    Point3m *earlierNormals(std::uint32_t place) const;
    void dropEarlier(std::uint32_t place);
    /// Whether a vertex is where it was put; that place is then the one that it has before a pose.
    bool isAtHome(std::size_t slot);

    MeshModel &layer;
    CMeshO &mesh;
    Point3m *position, *normal;
    PosedVertex *vertices;
    Posed *posed;
};

/// Whether a vertex attribute is one of a rest shape.
bool isOfRest(const std::string &attribute);

/// A number for the positions of all vertices: the sum of the terms of each of them.
std::uint64_t shapeOf(const CMeshO &mesh);
/// What a vertex at a slot adds to it.
std::uint64_t shapeTerm(std::size_t slot, const Point3m &position);

#endif
