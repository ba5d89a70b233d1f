// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_PART_H
#define FCD_LAYER_PART_H

#include <layer_fcd/edit_host.h>

#include <cstdint>
#include <optional>
#include <vector>

#include <QOpenGLBuffer>

/// How the host draws the faces of a layer, as far as a LayerPart does.
struct LayerLook {
    bool isLit = true, isCulled = false;
    bool hasVertexColors = false;
    vcg::Color4b color; ///< where there are no colours of vertices

    /// None where something else than faces is drawn, or these otherwise than smooth, without textures.
    static std::optional<LayerLook> of(const MLRenderingData &data, const CMeshO &mesh);
};

/// Some of the faces of a layer, drawn as the host draws them. Kept in buffers: what moves is written when it has
/// moved.
class LayerPart {
  public:
    /// \param isIn one per face slot
    LayerPart(const CMeshO &mesh, const std::vector<char> &isIn, const LayerLook &look);

    std::size_t faces() const { return element.size() / 3; }
    /// The vertices of the layer have other positions and normals from now on.
    void move() { isMoved = true; }
    /// \pre the context of the view is current, and has the transformation of the world
    void draw(const GLArea &view);

  private:
    void write();

    const CMeshO &mesh;
    LayerLook look;
    std::vector<std::uint32_t> slot;     ///< of the vertices that are drawn
    std::vector<std::uint32_t> element;  ///< three corners a face, places in \p slot
    std::vector<float> position, normal; ///< of these
    QOpenGLBuffer positions, normals, colors, elements;
    bool isMoved = true, isNew = true;
};

#endif
