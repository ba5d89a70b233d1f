// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARK_COLORS_H
#define FCD_MARK_COLORS_H

#include "edit_fcd/bend/model/session.h" // before Qt

#include "edit_fcd/view/stretch_colors.h"

/// What is drawn over a layer while it is bent.
class MarkColors {
  public:
    explicit MarkColors(const MeshModel &layer) : layer(layer) {}

    /// Whether stretch is shown: the options say so, and nothing is being marked.
    bool isStretch(const BendSession &session) const;
    /// One colour per vertex slot, of its stretch or else of its marks. Empty where there is nothing to be shown.
    std::vector<vcg::Color4b> of(const BendSession &session);

    /// From now on, what would move with a handle is shown by how much it would. \param extent null: no more is
    /// \return whether that is another one
    bool preview(std::shared_ptr<const BendExtent> extent);

  private:
    void addPreview(const BendSession &session, std::vector<vcg::Color4b> &color) const;

    const MeshModel &layer;
    std::shared_ptr<const BendExtent> previewed;
    std::unique_ptr<StretchColors> stretch; ///< once it has been shown
};

#endif
