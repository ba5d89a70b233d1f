// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_PART_H
#define FCD_LAYER_PART_H

#include <layer_fcd/edit_host.h>

#include <cstdint>
#include <optional>
#include <vector>

#include <QOpenGLBuffer>

/// How the host draws the faces of a layer.
struct LayerLook {
    bool isLit = true, isCulled = false;
    bool hasVertexColors = false;
    vcg::Color4b color; ///< without vertex colours

    /// None unless only smooth faces without textures are drawn, as LayerPart can.
    static std::optional<LayerLook> of(const MLRenderingData &data, const CMeshO &mesh);
};

/// Draws some faces of a layer as the host would. Buffers are written when the layer has moved.
class LayerPart {
  public:
    /// \param isIn one per face slot
    LayerPart(const CMeshO &mesh, const std::vector<char> &isIn, const LayerLook &look);

    std::size_t faces() const { return element.size() / 3; }
    /// Call when the layer's positions or normals have changed.
    void move() { isMoved = true; }
    /// \pre the context of the view is current, and has the transformation of the world
    void draw(const GLArea &view);

  private:
    void write();

    const CMeshO &mesh;
    LayerLook look;
    std::vector<std::uint32_t> slot;     ///< of the vertices that are drawn
    std::vector<std::uint32_t> element;  ///< three corners per face, indices into \p slot
    std::vector<float> position, normal; ///< three of each vertex
    QOpenGLBuffer positions, normals, colors, elements;
    bool isMoved = true, isNew = true;
};

#endif
