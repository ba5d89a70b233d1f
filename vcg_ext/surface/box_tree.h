// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_BOX_TREE_H
#define VCG_FCD_BOX_TREE_H

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// A tree over boxes, to find those near a query box. Boxes that follow each other should lie together.
template <class BoxOf>
class BoxTree {
  public:
    using Box = std::decay_t<decltype(std::declval<const BoxOf &>()(std::size_t(0)))>;

    /// \param boxOf boxOf(i): the i-th of \p count boxes; an empty one is never found
    BoxTree(std::size_t count, const BoxOf &boxOf) : count(count), boxOf(boxOf) {
        for (std::size_t size = count; levels.empty() || size > 1; size = levels.back().size()) {
            std::vector<Box> around((size + each - 1) / each);
            for (std::size_t i = 0; i < size; ++i)
                around[i / each].extend(levels.empty() ? boxOf(i) : levels.back()[i]);
            levels.push_back(std::move(around));
        }
    }
    /// Whether any box is within \p distance of \p box.
    bool IsNear(const Box &box, double distance) const {
        return count > 0 && IsNear(box, distance * distance, levels.size(), 0);
    }
    /// Calls body(i), ascending, for each box that has a point in common with \p box.
    template <class Body>
    void ForMeeting(const Box &box, const Body &body) const {
        if (count > 0)
            ForMeeting(box, body, levels.size(), 0);
    }

  private:
    static constexpr std::size_t each = 8;

    std::size_t SizeOf(std::size_t level) const { return level == 0 ? count : levels[level - 1].size(); }

    bool IsNear(const Box &box, double square, std::size_t level, std::size_t at) const {
        const Box here = level == 0 ? boxOf(at) : levels[level - 1][at];
        if (here.isEmpty() || box.squaredExteriorDistance(here) > square)
            return false;
        if (level == 0)
            return true;
        for (std::size_t i = at * each; i < std::min(SizeOf(level - 1), (at + 1) * each); ++i)
            if (IsNear(box, square, level - 1, i))
                return true;
        return false;
    }
    template <class Body>
    void ForMeeting(const Box &box, const Body &body, std::size_t level, std::size_t at) const {
        const Box here = level == 0 ? boxOf(at) : levels[level - 1][at];
        if (!here.intersects(box))
            return;
        if (level == 0) {
            body(at);
            return;
        }
        for (std::size_t i = at * each; i < std::min(SizeOf(level - 1), (at + 1) * each); ++i)
            ForMeeting(box, body, level - 1, i);
    }

    const std::size_t count;
    const BoxOf boxOf;
    std::vector<std::vector<Box>>
        levels; ///< boxes around `each` boxes of the level below; level 0: around those of boxOf
};

} // namespace vcg::fcd::detail

#endif
