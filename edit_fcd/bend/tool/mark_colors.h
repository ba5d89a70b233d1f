// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MARK_COLORS_H
#define FCD_MARK_COLORS_H

#include "edit_fcd/bend/model/session.h" // before Qt

#include "edit_fcd/view/layer_drawing.h"

#include <map>
#include <optional>
#include <set>

/// The colours over a layer while it is bent.
class MarkColors {
  public:
    explicit MarkColors(const MeshModel &layer) : layer(layer) {}

    /// Whether stretch is shown: by the options, while nothing is being marked.
    bool isStretch(const BendSession &session) const;
    /// One colour per vertex slot, by stretch or by marks. Empty if there is nothing to show.
    std::vector<vcg::Color4b> of(const BendSession &session);

    /// Arguments of LayerOverlay::show().
    struct Tint {
        std::vector<std::uint32_t> slot, element;
        std::vector<vcg::Color4b> color;
    };
    /// The same during a preview, but only vertices and faces with a colour. None if there are too many.
    std::optional<Tint> tint(BendSession &session);

    using Extents = std::vector<std::shared_ptr<const BendExtent>>;
    /// Sets the preview: extents of handles that would move. \param extents may be null \return whether it changed
    bool preview(Extents extents);

  private:
    /// All that the colours of marks depend on.
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
    Extents previewed;
    std::optional<Marked> marked;        ///< for which \a colored was computed
    std::vector<std::uint32_t> colored;  ///< vertices with a colour by marks, ascending
    std::vector<vcg::Color4b> colorOf;   ///< of each of these
    std::unique_ptr<DrawnVertices> room; ///< for tint()
};

#endif
