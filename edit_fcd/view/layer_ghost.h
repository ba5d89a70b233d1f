// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_GHOST_H
#define FCD_LAYER_GHOST_H

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <memory>
#include <vector>

#include <QOpenGLBuffer>

/// What the ghosts of a layer are drawn from: its surface, or, of a cloud or a large surface, some of the vertices that
/// move, as points.
struct GhostParts {
    std::vector<std::uint32_t> slot;    ///< vertices
    std::vector<std::uint32_t> element; ///< three corners a triangle, places in \p slot; none: points are drawn

    /// Whether a surface of so many faces is too large to be drawn a few times more.
    static bool isPoints(std::size_t faces);
    /// \param tags one per vertex slot: what is not above 0 stays
    static GhostParts of(const vcg::fcd::SurfaceView &surface, const std::vector<int> &tags);
};

/// A shape that a layer has at another time, pale and see-through. It is behind the layer where both are at the same
/// place. Kept in buffers, which are written when it changes.
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
    std::shared_ptr<const std::vector<float>> position; ///< null: it is hidden
    QOpenGLBuffer positions, elements;
    bool isMoved = false, isOther = false; ///< not written yet
};

#endif
