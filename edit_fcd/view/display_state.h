// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DISPLAY_STATE_H
#define FCD_DISPLAY_STATE_H

#include <layer_fcd/edit_host.h>

#include <optional>

/// How a layer is shown in a view while it is bent: as the user has chosen. Only large layers with flat shading are
/// shaded by vertex while they move, which needs a third of the buffers.
class DisplayState {
  public:
    DisplayState(GLArea &view, const MeshModel &layer) : view(view), layer(layer) {}
    DisplayState(const DisplayState &) = delete;
    DisplayState &operator=(const DisplayState &) = delete;

    /// The layer is going to move; rest() ends that.
    void move();
    void rest();
    /// Whether normals of faces are seen.
    bool showsFaces() const;
    /// Takes the layer's positions and normals. \param faces also those of faces
    void updateShape(bool faces);

  private:
    void set(const MLRenderingData &data);

    GLArea &view;
    const MeshModel &layer;
    std::optional<MLRenderingData> atRest; ///< while the layer is shown in another way
};

#endif
