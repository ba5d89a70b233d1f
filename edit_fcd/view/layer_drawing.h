// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_DRAWING_H
#define FCD_LAYER_DRAWING_H

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <vector>

#include <QOpenGLBuffer>

/// The vertices of a layer that are drawn, in the order in which they are first asked for.
class DrawnVertices {
  public:
    explicit DrawnVertices(std::size_t count) : place(count, none) {}

    /// The place of a vertex among them. \param i its slot
    std::uint32_t operator()(std::size_t i);
    bool has(std::size_t i) const { return place[i] != none; }
    /// There are none. Costs as much as those that there were.
    void clear();

    std::vector<std::uint32_t> slot; ///< of each

  private:
    static constexpr std::uint32_t none = std::uint32_t(-1);
    std::vector<std::uint32_t> place; // one per vertex slot
};

/// Makes a buffer hold values, and none the one that is bound.
template <class T>
void fill(QOpenGLBuffer &buffer, const std::vector<T> &values) {
    if (!buffer.isCreated())
        buffer.create();
    buffer.bind();
    buffer.allocate(values.data(), int(values.size() * sizeof(T)));
    buffer.release();
}

/// Makes a buffer hold a vector of each of some vertices. \param at of a slot \param values room, three for each
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

/// While it lives, what is drawn has the transformation of a layer; then all of OpenGL's state is what it was.
class LayerDrawing {
  public:
    /// \pre the context of the view is current, and has the transformation of the world
    explicit LayerDrawing(const CMeshO &mesh);
    LayerDrawing(const LayerDrawing &) = delete;
    LayerDrawing &operator=(const LayerDrawing &) = delete;
    ~LayerDrawing();
};

/// While it lives, what is drawn is flat and over all else; then all of OpenGL's state is what it was.
class FlatDrawing {
  public:
    FlatDrawing();
    FlatDrawing(const FlatDrawing &) = delete;
    FlatDrawing &operator=(const FlatDrawing &) = delete;
    ~FlatDrawing();
};

// From which buffers a LayerDrawing draws; from no others that were in use before.
void usePositions(QOpenGLBuffer &positions);
void useNormals(QOpenGLBuffer &normals);
void useColors(QOpenGLBuffer &colors); ///< four bytes each
/// What a LayerDrawing draws from now on is seen through, not lit, of both sides, and nothing that the mouse points at.
/// \param offset of its faces from those of the layer; below 0: in front of these
void beSeenThrough(float offset);
/// \param elements corners of the triangles \param corners how many
void drawTriangles(QOpenGLBuffer &elements, std::size_t corners);

#endif
