// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARK_COLORS_H
#define FCD_MARK_COLORS_H

#include "edit_fcd/bend/model/session.h" // before Qt

#include "edit_fcd/view/layer_drawing.h"
#include "edit_fcd/view/stretch_colors.h"

#include <map>
#include <optional>
#include <set>

/// What is drawn over a layer while it is bent.
class MarkColors {
  public:
    explicit MarkColors(const MeshModel &layer) : layer(layer) {}

    /// Whether stretch is shown: the options say so, and nothing is being marked.
    bool isStretch(const BendSession &session) const;
    /// One colour per vertex slot, of its stretch or else of its marks. Empty where there is nothing to be shown.
    std::vector<vcg::Color4b> of(const BendSession &session);

    /// What LayerOverlay::show() takes of triangles.
    struct Tint {
        std::vector<std::uint32_t> slot, element;
        std::vector<vcg::Color4b> color;
    };
    /// The same colours while something would move: of the vertices and faces alone that have any. None where all have
    /// to be gone through anyway.
    std::optional<Tint> tint(BendSession &session);

    /// From now on, what would move with a handle is shown by how much it would. \param extent null: no more is
    /// \return whether that is another one
    bool preview(std::shared_ptr<const BendExtent> extent);

  private:
    /// What the colours of marks follow from.
    struct Marked {
        std::shared_ptr<const BendTags> marks, tags;
        std::map<int, BendPoint> points;
        std::set<int> hidden;
        bool operator==(const Marked &o) const {
            return marks == o.marks && tags == o.tags && points == o.points && hidden == o.hidden;
        }
    };

    static std::vector<vcg::Color4b> ofMarks(const BendSession &session);
    void findColored(const BendSession &session);
    template <class Set>
    void forPreview(const BendSession &session, const Set &set) const;

    const MeshModel &layer;
    std::shared_ptr<const BendExtent> previewed;
    std::optional<Marked> marked;           ///< of what is next
    std::vector<std::uint32_t> colored;     ///< vertices that marks give a colour, ascending
    std::vector<vcg::Color4b> colorOf;      ///< of each of these
    std::unique_ptr<DrawnVertices> room;    ///< for those of a tint
    std::unique_ptr<StretchColors> stretch; ///< once it has been shown
};

#endif
