// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_DISPLAY_H
#define FCD_BEND_DISPLAY_H

#include <vcg_ext/centroidal_deformation.h> // before Qt

#include <layer_fcd/edit_host.h>

/// How a layer is shown in a view while it is bent: smooth, so that its buffers are indexed, and only positions and
/// normals change.
class BendDisplay {
  public:
    /// \param isColored whether the colours of vertices tell something, and nothing may hide them
    BendDisplay(GLArea &view, const MeshModel &layer, bool isColored);

    /// Leaves textures away, which slow down what moves.
    void bare();
    /// Whether the colours of vertices tell something from now on.
    void setColored(bool colored);
    /// Takes the layer's colours, and whether it has some.
    void updateColors(bool colored);
    /// Takes the layer's shape. \param full also what does not change while it is dragged \param recolored its colours
    /// have changed, too
    void updateShape(bool full, bool recolored);
    /// Shows the layer as it was before, but with its colours if they tell something.
    void end(bool colored);

  private:
    void show();
    void update(std::initializer_list<MLRenderingData::ATT_NAMES> names);

    GLArea &view;
    const MeshModel &layer;
    const MLRenderingData::PRIMITIVE_MODALITY primitive;
    MLRenderingData before;
    bool isColored, isBare;
};

#endif
