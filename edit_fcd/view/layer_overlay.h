// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_OVERLAY_H
#define FCD_LAYER_OVERLAY_H

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <vector>

#include <QOpenGLBuffer>

/// Draws colours over a layer, which does not change. Buffers are written when colours, elements or the layer's
/// positions change.
class LayerOverlay {
  public:
    LayerOverlay();

    /// Shows colours over the faces of a layer, or over its vertices if it has no faces. \param color one per vertex
    /// slot; alpha 0: nothing is shown there \param isIn flags of face slots; null: all faces
    void show(const CMeshO &mesh, const std::vector<vcg::Color4b> &color, const std::vector<char> *isIn = nullptr);
    /// The same over given triangles. \param slot vertices \param color one for each \param element three corners per
    /// triangle, indices into \p slot
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

#endif
