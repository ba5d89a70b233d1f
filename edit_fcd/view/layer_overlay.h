// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_OVERLAY_H
#define FCD_LAYER_OVERLAY_H

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <vector>

#include <QOpenGLBuffer>

/// Colours that are drawn over a layer, which stays as it is. What is drawn is kept in buffers: colours and elements
/// are written when they change, positions when the layer moves.
class LayerOverlay {
  public:
    LayerOverlay();

    /// Shows colours over the faces of a layer, or over its vertices where it has no faces.
    /// \param color one per vertex slot; where alpha is 0, nothing is shown \param isIn one per face slot: only over
    /// these; null: over all
    void show(const CMeshO &mesh, const std::vector<vcg::Color4b> &color, const std::vector<char> *isIn = nullptr);
    /// The same of triangles that are known. \param slot vertices \param color of these \param element three corners a
    /// triangle, places in \p slot
    void show(const CMeshO &mesh, std::vector<std::uint32_t> slot, std::vector<vcg::Color4b> color,
              std::vector<std::uint32_t> element);
    void hide();
    /// The vertices of the layer have other positions from now on.
    void move() { isMoved = true; }
    /// Draws it. \pre the context of the view is current, and has the transformation of the world
    void draw(const CMeshO &mesh);

  private:
    void write(const CMeshO &mesh);

    std::vector<std::uint32_t> slot;    ///< of the vertices that are drawn
    std::vector<vcg::Color4b> color;    ///< of these
    std::vector<std::uint32_t> element; ///< three corners a triangle, places in \p slot; none: points are drawn
    std::vector<float> position;
    QOpenGLBuffer positions, colors, elements;
    std::size_t vertexSlots = 0; ///< of the layer's vertices
    bool isMoved = false, isChanged = false;
};

#endif
