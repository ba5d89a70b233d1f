// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CLOUD_PLACES_H
#define VCG_FCD_CLOUD_PLACES_H

#include <vcg_ext/base/parallel.h>
#include <vcg_ext/surface/cloud_neighbourhood.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace vcg {
namespace fcd {
namespace detail {

/// Boxes in an order in which they are near, by boxes of some of them.
class BoxGroups {
  public:
    explicit BoxGroups(const std::vector<Eigen::AlignedBox3d> &box) : box(box) {
        for (std::size_t i = 0; i < box.size(); ++i) {
            if (i % some == 0)
                group.emplace_back();
            group.back().extend(box[i]);
        }
    }
    /// Whether one touches \p other.
    bool Touch(const Eigen::AlignedBox3d &other) const {
        for (std::size_t g = 0; g < group.size(); ++g)
            if (group[g].intersects(other))
                for (std::size_t i = g * some; i < std::min(box.size(), (g + 1) * some); ++i)
                    if (box[i].intersects(other))
                        return true;
        return false;
    }

  private:
    static constexpr std::size_t some = 64;
    const std::vector<Eigen::AlignedBox3d> &box;
    std::vector<Eigen::AlignedBox3d> group;
};

/// The held ones of places in Morton order, by boxes of some, and of some of these.
class HeldPlaces {
  public:
    /// \param isHeld isHeld(place)
    template <class IsHeld>
    HeldPlaces(const std::vector<Eigen::Vector3d> &point, const IsHeld &isHeld) {
        for (std::size_t place = 0; place < point.size(); ++place)
            if (isHeld(place)) {
                if (held.size() % some == 0)
                    small.emplace_back();
                if (held.size() % (some * some) == 0)
                    large.emplace_back();
                held.push_back(point[place]);
                small.back().extend(point[place]);
                large.back().extend(point[place]);
            }
    }
    /// Whether one is no farther from \p box than \p distance.
    bool IsNear(const Eigen::AlignedBox3d &box, double distance) const {
        const double reach = distance * distance;
        for (std::size_t l = 0; l < large.size(); ++l) {
            if (box.squaredExteriorDistance(large[l]) > reach)
                continue;
            for (std::size_t b = l * some; b < std::min(small.size(), (l + 1) * some); ++b) {
                if (box.squaredExteriorDistance(small[b]) > reach)
                    continue;
                for (std::size_t i = b * some; i < std::min(held.size(), (b + 1) * some); ++i)
                    if (box.squaredExteriorDistance(held[i]) <= reach)
                        return true;
            }
        }
        return false;
    }

  private:
    static constexpr std::size_t some = 64;
    std::vector<Eigen::Vector3d> held;
    std::vector<Eigen::AlignedBox3d> small, large;
};

/// Places in Morton order, run by run, each of two parts, as the order jumps here and there.
struct PlaceRuns {
    static constexpr std::size_t size = 64;
    static_assert(CloudNeighbourhood<double>::most <= 3 * size, "three runs are all that is looked at");

    PlaceRuns(const std::vector<Eigen::Vector3d> &point, unsigned threads)
        : places(point.size()), box((places + size - 1) / size), part(2 * box.size()), cut(box.size()) {
        ParallelFor(threads, box.size(), 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t r = first; r < last; ++r) {
                double longest = -1;
                for (std::size_t i = r * size; i < End(r); ++i)
                    if (const double way = i > r * size ? (point[i] - point[i - 1]).squaredNorm() : 0; way > longest) {
                        longest = way;
                        cut[r] = i;
                    }
                for (std::size_t i = r * size; i < End(r); ++i)
                    part[PartOf(i)].extend(point[i]);
                box[r] = part[2 * r].merged(part[2 * r + 1]);
            }
        });
    }
    std::size_t End(std::size_t r) const { return std::min(places, (r + 1) * size); }
    std::size_t PartOf(std::size_t place) const { return 2 * (place / size) + (place >= cut[place / size]); }
    /// How far from a part what is looked at is at most: no farther than the three runs before or behind reach.
    double Reach(std::size_t p) const {
        const std::size_t r = p / 2;
        double reach = std::numeric_limits<double>::infinity();
        for (std::size_t first : {r - 3, r + 1}) // below 0: a very large number
            if (first < box.size() && (first + 3) * size <= places) {
                const Eigen::AlignedBox3d all = box[first].merged(box[first + 1]).merged(box[first + 2]);
                reach = std::min(reach, 1.001 * all.merged(part[p]).diagonal().norm()); // and what is rounded
            }
        return reach;
    }

    const std::size_t places;
    std::vector<Eigen::AlignedBox3d> box, part;
    std::vector<std::size_t> cut; // the first place of each second part
};

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
