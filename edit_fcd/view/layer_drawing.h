// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_DRAWING_H
#define FCD_LAYER_DRAWING_H

#include <layer_fcd/layer_contents.h>

#include <cstdint>
#include <memory>
#include <vector>

#include <QOpenGLBuffer>

/// Numbers the vertices of a layer that are drawn, in the order in which they are first asked for.
class DrawnVertices {
  public:
    explicit DrawnVertices(std::size_t count) : place(count, none) {}

    /// The number of the vertex at slot \p i.
    std::uint32_t operator()(std::size_t i);
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
    forEach(slot.size(), [&](std::size_t j) {
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

/// From now on, a LayerDrawing draws from a buffer. \param array what it has: GL_VERTEX_ARRAY, GL_NORMAL_ARRAY, or
/// GL_COLOR_ARRAY, four bytes each
void use(QOpenGLBuffer &buffer, GLenum array);
/// From now on, a LayerDrawing draws transparently, unlit, both sides, and without depth, so that the mouse points
/// through. \param offset in depth of its faces; below 0: in front of the layer
void beSeenThrough(float offset);
/// \param elements corners of the triangles \param corners number of them
void drawTriangles(QOpenGLBuffer &elements, std::size_t corners);
void put(const Eigen::Vector3d &p); ///< a vertex between glBegin() and glEnd()
/// \param size pixels
void drawPoint(const Eigen::Vector3d &p, float size);

/// Draws colours over a layer. Buffers are written when colours, elements or the layer's positions change.
class LayerOverlay {
  public:
    LayerOverlay();

    /// Shows colours over the faces of a layer, or over its vertices if it has no faces. \param color one per vertex
    /// slot; alpha 0: nothing is shown there \param isIn flags of face slots; null: all faces
    void show(const CMeshO &mesh, const std::vector<vcg::Color4b> &color, const std::vector<char> *isIn = nullptr);
    /// The same over triangles. \param slot vertices \param color of each \param element corners, indices into \p slot
    void show(const CMeshO &mesh, std::vector<std::uint32_t> slot, std::vector<vcg::Color4b> color,
              std::vector<std::uint32_t> element);
    void hide();
    /// Call when the layer's positions have changed.
    void move() { isMoved = true; }
    /// Draws it. \pre the context of the view is current, and has the transformation of the world
    void draw(const CMeshO &mesh);

  private:
    void write(const CMeshO &mesh);

    std::vector<std::uint32_t> slot;    ///< of the vertices that are drawn
    std::vector<vcg::Color4b> color;    ///< of each
    std::vector<std::uint32_t> element; ///< three corners per triangle, indices into \p slot; empty: points are drawn
    std::vector<float> position;
    QOpenGLBuffer positions, colors, elements;
    std::size_t vertexSlots = 0; ///< of the layer's vertices
    bool isMoved = false, isChanged = false;
};

/// The elements of a layer's ghosts: its surface; of a cloud or a large surface, some of the vertices that move.
struct GhostParts {
    std::vector<std::uint32_t> slot;    ///< vertices
    std::vector<std::uint32_t> element; ///< three corners per triangle, indices into \p slot; empty: points are drawn

    /// Whether a surface has too many faces to be drawn several times, so that ghosts are points.
    static bool isPoints(std::size_t faces);
    /// \param tags one per vertex slot; vertices with a tag <= 0 stay
    static GhostParts of(const vcg::fcd::SurfaceView &surface, const std::vector<int> &tags);
};

/// Another shape of a layer, pale and transparent, behind the layer where both coincide. Buffers are written on change.
class LayerGhost {
  public:
    explicit LayerGhost(const vcg::Color4b &color) : color(color), elements(QOpenGLBuffer::IndexBuffer) {}

    /// \param position three numbers for each vertex of \p parts, layer units
    void show(std::shared_ptr<const GhostParts> parts, std::shared_ptr<const std::vector<float>> position);
    void hide();
    bool isShown() const { return position != nullptr; }
    /// Draws it. \pre the context of the view is current, and has the transformation of the world
    void draw(const CMeshO &mesh);

  private:
    vcg::Color4b color;
    std::shared_ptr<const GhostParts> parts;
    std::shared_ptr<const std::vector<float>> position; ///< null: hidden
    QOpenGLBuffer positions, elements;
    bool isMoved = false, isOther = false; ///< positions, elements are to be written
};

#endif
