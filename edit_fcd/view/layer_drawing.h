// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_DRAWING_H
#define FCD_LAYER_DRAWING_H

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <vector>

#include <QOpenGLBuffer>

/// Numbers the vertices of a layer that are drawn, in the order in which they are first asked for.
class DrawnVertices {
  public:
    explicit DrawnVertices(std::size_t count) : place(count, none) {}

    /// The number of the vertex at slot \p i.
    std::uint32_t operator()(std::size_t i);
    bool has(std::size_t i) const { return place[i] != none; }
    /// Forgets all; takes time for these only.
    void clear();

    std::vector<std::uint32_t> slot; ///< of each drawn vertex

  private:
    static constexpr std::uint32_t none = std::uint32_t(-1);
    std::vector<std::uint32_t> place; // one per vertex slot
};

/// Writes values to a buffer. Afterwards, no buffer is bound.
template <class T>
void fill(QOpenGLBuffer &buffer, const std::vector<T> &values) {
    if (!buffer.isCreated())
        buffer.create();
    buffer.bind();
    buffer.allocate(values.data(), int(values.size() * sizeof(T)));
    buffer.release();
}

/// Writes a vector of each vertex to a buffer. \param at vector of a slot \param values room
template <class At>
void fillVectors(QOpenGLBuffer &buffer, const std::vector<std::uint32_t> &slot, const At &at,
                 std::vector<float> &values) {
    values.resize(3 * slot.size());
    vcg::fcd::ParallelFor(0, slot.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
        for (std::size_t j = first; j < last; ++j)
            for (int d = 0; d < 3; ++d)
                values[3 * j + std::size_t(d)] = float(at(slot[j])[d]);
    });
    fill(buffer, values);
}

/// While it lives, drawing has the transformation of a layer. Its end restores OpenGL's state.
class LayerDrawing {
  public:
    /// \pre the context of the view is current, and has the transformation of the world
    explicit LayerDrawing(const CMeshO &mesh);
    LayerDrawing(const LayerDrawing &) = delete;
    LayerDrawing &operator=(const LayerDrawing &) = delete;
    ~LayerDrawing();
};

/// While it lives, drawing is unlit and over all else. Its end restores OpenGL's state.
class FlatDrawing {
  public:
    FlatDrawing();
    FlatDrawing(const FlatDrawing &) = delete;
    FlatDrawing &operator=(const FlatDrawing &) = delete;
    ~FlatDrawing();
};

// The buffers from which a LayerDrawing draws, instead of those before.
void usePositions(QOpenGLBuffer &positions);
void useNormals(QOpenGLBuffer &normals);
void useColors(QOpenGLBuffer &colors); ///< four bytes each
/// From now on, a LayerDrawing draws transparently, unlit, both sides, and without depth, so that the mouse points
/// through. \param offset in depth of its faces; below 0: in front of the layer
void beSeenThrough(float offset);
/// \param elements corners of the triangles \param corners number of them
void drawTriangles(QOpenGLBuffer &elements, std::size_t corners);

#endif
