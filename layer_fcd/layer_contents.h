// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_CONTENTS_H
#define FCD_LAYER_CONTENTS_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/surface/surface_arrays.h>

#include "meshlab_host.h"

#include <vcg_ext/base/parallel.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <optional>
#include <type_traits>
#include <vector>

/// \file
/// The contents of a layer. "A number for ..." is a hash.

/// Calls body(i) for each i below n, by all threads.
template <class Body>
void forEach(std::size_t n, const Body &body) {
    vcg::fcd::ParallelForEach(0, n, 1 << 14, body);
}

/// The same for each live vertex.
template <class Body>
void forVertices(const CMeshO &mesh, const Body &body) {
    forEach(mesh.vert.size(), [&](std::size_t i) {
        if (!mesh.vert[i].IsD())
            body(i);
    });
}

/// The sum of range(first, last) over the ranges of n items, by all threads.
template <class Range>
std::uint64_t sumOf(std::size_t n, const Range &range) {
    const std::size_t grain = 1 << 14;
    std::vector<std::uint64_t> sums((n + grain - 1) / grain, 0);
    vcg::fcd::ParallelFor(0, n, grain,
                          [&](std::size_t first, std::size_t last) { sums[first / grain] = range(first, last); });
    return std::accumulate(sums.begin(), sums.end(), std::uint64_t(0));
}

/// The sum of term(slot) over the live vertices.
template <class Term>
std::uint64_t sumOfVertices(const CMeshO &mesh, const Term &term) {
    return sumOf(mesh.vert.size(), [&](std::size_t first, std::size_t last) {
        std::uint64_t sum = 0;
        for (std::size_t i = first; i < last; ++i)
            if (!mesh.vert[i].IsD())
                sum += term(i);
        return sum;
    });
}

/// The least value of items, and the first item that has it.
struct Least {
    double value = std::numeric_limits<double>::infinity();
    std::size_t item = 0;
};

/// The least value(i) of n items, by all threads; none if all are infinite.
template <class Value>
std::optional<Least> leastOf(std::size_t n, const Value &value) {
    const std::size_t grain = 1 << 14;
    std::vector<Least> found((n + grain - 1) / grain);
    vcg::fcd::ParallelFor(0, n, grain, [&](std::size_t first, std::size_t last) {
        Least here;
        for (std::size_t i = first; i < last; ++i)
            if (const double own = value(i); own < here.value)
                here = {own, i};
        found[first / grain] = here;
    });
    Least all;
    for (const Least &each : found)
        all = each.value < all.value ? each : all;
    return std::isfinite(all.value) ? std::optional(all) : std::nullopt;
}

/// The bytes of plain numbers, one after the other.
class NumberBytes {
  public:
    template <class... Numbers>
    void add(const Numbers &...numbers) {
        (addOne(numbers), ...);
    }
    const unsigned char *data() const { return bytes.data(); }
    std::size_t size() const { return bytes.size(); }

  private:
    template <class Number>
    void addOne(const Number &number) {
        static_assert(std::is_arithmetic<Number>::value || std::is_enum<Number>::value, "no gaps");
        const std::size_t at = bytes.size();
        bytes.resize(at + sizeof(Number));
        std::memcpy(&bytes[at], &number, sizeof(Number));
    }

    std::vector<unsigned char> bytes;
};

/// The rounding error of a coordinate that a host moved, over the numbers that it is the sum of: a host multiplies and
/// adds four numbers, and a user may turn a layer several times.
constexpr double layerRounding = 32. * std::numeric_limits<Scalarm>::epsilon();

/// The slots of the vertices that are not deleted, ascending.
std::vector<std::size_t> liveSlots(const CMeshO &mesh);

/// The positions of the vertices of \p layer, 3 x slots.
Eigen::Matrix3Xd positionsOf(const MeshModel &layer);

/// A number for faces, each with the slots of its corners in their order.
std::uint64_t facesOf(const CMeshO &mesh);
std::uint64_t facesOf(const vcg::fcd::SurfaceView &surface);

/// The largest size of a file with at most \p each bytes a vertex of \p layer, and comments.
std::size_t mostBytes(const MeshModel &layer, std::size_t each);

/// Whether each slot of the layer's vertex vector belongs to a selected face.
std::vector<char> onSelectedFaces(const MeshModel &layer);

/// Whether \p layer has a quality that is not 0 everywhere.
bool hasQuality(const MeshModel &layer);
/// A number for the normals of all vertices.
std::uint64_t normalsOf(const CMeshO &mesh);

/// A number for all that a user can see or change in \p layer: matrix, elements and their positions, corners, colours,
/// quality and texture coordinates, normals of a cloud, names of textures, attributes with their values. (Not the
/// normals of a mesh, which a host computes again; see hasOwnNormals.)
std::uint64_t contentsOf(const MeshModel &layer);

/// Whether \p layer has normals of its own (hasOwnNormals), or principal directions, which turn with the surface.
bool hasDirections(const MeshModel &layer);

#endif
