// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_VERTEX_FACES_H
#define FCD_BEND_VERTEX_FACES_H

#include <vcg_ext/surface/surface_arrays.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

/// The faces of each vertex of a surface.
class VertexFaces {
  public:
    explicit VertexFaces(std::shared_ptr<const vcg::fcd::SurfaceArrays> arrays)
        : arrays(std::move(arrays)), surface(this->arrays->View()), begin(surface.vertexSlots + 1, 0) {
        forCorners([&](std::uint32_t slot, std::size_t) { ++begin[slot]; });
        std::uint32_t sum = 0;
        for (std::uint32_t &each : begin)
            each = sum += each; // the end; becomes the begin below
        faceOf.resize(sum);
        forCorners([&](std::uint32_t slot, std::size_t f) { faceOf[--begin[slot]] = std::uint32_t(f); });
    }

    std::size_t vertexSlots() const { return surface.vertexSlots; }
    /// Calls \p body with the corners of each face of a vertex: three slots.
    template <class Body>
    void forEach(std::size_t slot, const Body &body) const {
        for (std::uint32_t k = begin[slot]; k < begin[slot + 1]; ++k)
            body(surface.corner + 3 * std::size_t(faceOf[k]));
    }

  private:
    template <class Body>
    void forCorners(const Body &body) const {
        for (std::size_t f = 0; f < surface.faces; ++f)
            for (std::size_t k = 0; k < 3 && surface.IsFace(f); ++k)
                body(surface.corner[3 * f + k], f);
    }

    std::shared_ptr<const vcg::fcd::SurfaceArrays> arrays;
    vcg::fcd::SurfaceView surface;
    std::vector<std::uint32_t> begin, faceOf;
};

#endif
