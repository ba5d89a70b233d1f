// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CLOUD_PLACES_H
#define VCG_FCD_CLOUD_PLACES_H

#include <vcg_ext/base/parallel.h>
#include <vcg_ext/surface/cloud_neighbourhood.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
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

/// Those of places in Morton order that are asked for, by boxes of some, and of some of these.
class AskedPlaces {
  public:
    /// \param isAsked isAsked(place)
    template <class IsAsked>
    AskedPlaces(const Eigen::Matrix3Xd &point, const IsAsked &isAsked) {
        for (std::size_t place = 0; place < std::size_t(point.cols()); ++place)
            if (isAsked(place)) {
                if (asked.size() % some == 0)
                    small.emplace_back();
                if (asked.size() % (some * some) == 0)
                    large.emplace_back();
                asked.emplace_back(point.col(Eigen::Index(place)));
                small.back().extend(asked.back());
                large.back().extend(asked.back());
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
                for (std::size_t i = b * some; i < std::min(asked.size(), (b + 1) * some); ++i)
                    if (box.squaredExteriorDistance(asked[i]) <= reach)
                        return true;
            }
        }
        return false;
    }

  private:
    static constexpr std::size_t some = 64;
    std::vector<Eigen::Vector3d> asked;
    std::vector<Eigen::AlignedBox3d> small, large;
};

/// Places in Morton order, run by run, each of two parts, as the order jumps here and there.
struct PlaceRuns {
    static constexpr std::size_t size = 64;

    PlaceRuns(const Eigen::Matrix3Xd &point, unsigned threads)
        : places(std::size_t(point.cols())), box((places + size - 1) / size), part(2 * box.size()), cut(box.size()),
          some(places / each) {
        ParallelFor(threads, box.size(), 256, [&](std::size_t first, std::size_t last) {
            const auto at = [&](std::size_t i) { return Eigen::Vector3d(point.col(Eigen::Index(i))); };
            for (std::size_t r = first; r < last; ++r) {
                double longest = -1;
                for (std::size_t i = r * size; i < End(r); ++i)
                    if (const double way = i > r * size ? (at(i) - at(i - 1)).squaredNorm() : 0; way > longest) {
                        longest = way;
                        cut[r] = i;
                    }
                for (std::size_t i = r * size; i < End(r); ++i) {
                    part[PartOf(i)].extend(at(i));
                    if (i / each < some.size())
                        some[i / each].extend(at(i));
                }
                box[r] = part[2 * r].merged(part[2 * r + 1]);
            }
        });
    }
    std::size_t End(std::size_t r) const { return std::min(places, (r + 1) * size); }
    std::size_t PartOf(std::size_t place) const { return 2 * (place / size) + (place >= cut[place / size]); }
    /// How far from a part what is looked at is at most: no farther than as many places, those nearest to it among the
    /// ones before and behind.
    double Reach(std::size_t p) const {
        constexpr std::size_t beside = 4, perRun = size / each; // runs
        const std::size_t r = p / 2;
        double square[(2 * beside + 1) * perRun]; // of how far some of them are at most
        std::size_t found = 0;
        for (std::size_t s = perRun * (r - std::min(r, beside)); s < std::min(some.size(), perRun * (r + beside + 1));
             ++s)
            square[found++] = (part[p].max() - some[s].min()).cwiseMax(some[s].max() - part[p].min()).squaredNorm();
        constexpr std::size_t wanted = CloudNeighbourhood<double>::most / each + 1; // and the point itself
        static_assert(wanted <= beside * perRun, "as many are there");
        if (found < wanted)
            return std::numeric_limits<double>::infinity();
        std::nth_element(square, square + wanted - 1, square + found);
        return 1.001 * std::sqrt(square[wanted - 1]); // and what is rounded
    }

    const std::size_t places;
    std::vector<Eigen::AlignedBox3d> box, part;
    std::vector<std::size_t> cut; // the first place of each second part

  private:
    static constexpr std::size_t each = 16; // a run is a multiple of it
    std::vector<Eigen::AlignedBox3d> some;  // of so many places that follow each other
};

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
