// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_DISPLAY_STATE_H
#define FCD_DISPLAY_STATE_H

#include <layer_fcd/edit_host.h>

#include <optional>

/// The display of a layer in a view while a tool has it. It stays as the user chose. Only large layers with flat
/// shading are shaded by vertex while they move, which needs a third of the buffers.
class DisplayState {
  public:
    DisplayState(GLArea &view, const MeshModel &layer) : view(view), layer(layer) {}
    DisplayState(const DisplayState &) = delete;
    DisplayState &operator=(const DisplayState &) = delete;

    /// The layer is going to move; rest() ends that.
    void move();
    void rest();
    /// Whether the display uses normals of faces.
    bool showsFaces() const;
    /// Updates the buffers of positions and normals. \param faces also normals of faces
    void updateShape(bool faces);

  private:
    void set(const MLRenderingData &data);

    GLArea &view;
    const MeshModel &layer;
    std::optional<MLRenderingData> atRest; ///< the user's choice, while the display is another one
};

#endif
