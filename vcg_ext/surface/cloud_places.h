// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CLOUD_PLACES_H
#define VCG_FCD_CLOUD_PLACES_H

#include <vcg_ext/base/parallel.h>
#include <vcg_ext/surface/box_tree.h>
#include <vcg_ext/surface/cloud_neighbourhood.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace vcg::fcd::detail {

/// Runs of places (distinct positions) in Morton order. A run is cut into two parts at its longest jump.
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
                    if (const double step = i > r * size ? (at(i) - at(i - 1)).squaredNorm() : 0; step > longest) {
                        longest = step;
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
    /// A distance that holds the neighbours of all places of a part: within it are as many places as a neighbourhood
    /// looks at, found among those before and behind it in the order.
    double Reach(std::size_t p) const {
        constexpr std::size_t beside = 4, perRun = size / each; // runs
        const std::size_t r = p / 2;
        double square[(2 * beside + 1) * perRun]; // of the largest distance to each group of `each` places
        std::size_t found = 0;
        for (std::size_t s = perRun * (r - std::min(r, beside)); s < std::min(some.size(), perRun * (r + beside + 1));
             ++s)
            square[found++] = (part[p].max() - some[s].min()).cwiseMax(some[s].max() - part[p].min()).squaredNorm();
        constexpr std::size_t wanted = CloudNeighbourhood<double>::most / each + 1; // and the point itself
        static_assert(wanted <= beside * perRun, "as many are there");
        if (found < wanted)
            return std::numeric_limits<double>::infinity();
        std::nth_element(square, square + wanted - 1, square + found);
        return 1.001 * std::sqrt(square[wanted - 1]); // more than rounding
    }

    const std::size_t places;
    std::vector<Eigen::AlignedBox3d> box, part;
    std::vector<std::size_t> cut; // the first place of each second part

  private:
    static constexpr std::size_t each = 16; // a run is a multiple of it
    std::vector<Eigen::AlignedBox3d> some;  // boxes of each `each` places in the order
};

} // namespace vcg::fcd::detail

#endif
