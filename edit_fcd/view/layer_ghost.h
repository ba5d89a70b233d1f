// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_GHOST_H
#define FCD_LAYER_GHOST_H

#include <layer_fcd/meshlab_host.h>

#include <cstdint>
#include <memory>
#include <vector>

#include <QOpenGLBuffer>

/// The elements of a layer's ghosts: its surface. For a cloud or a large surface: points, some of the vertices that
/// move.
struct GhostParts {
    std::vector<std::uint32_t> slot;    ///< vertices
    std::vector<std::uint32_t> element; ///< three corners per triangle, indices into \p slot; empty: points are drawn

    /// Whether a surface has too many faces to be drawn several times, so that ghosts are points.
    static bool isPoints(std::size_t faces);
    /// \param tags one per vertex slot; vertices with a tag <= 0 stay
    static GhostParts of(const vcg::fcd::SurfaceView &surface, const std::vector<int> &tags);
};

/// Another shape of a layer, pale and transparent, drawn behind the layer where both coincide. Its buffers are written
/// when it changes.
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
