// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/straighten/line_places.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>

namespace vcg::fcd::detail {

Eigen::Matrix3Xd NodesOf(const RegionDeformer &deformer, const ToWorld &toWorld) {
    return (deformer.graph.graph.position.cast<double>() * toWorld.scale).colwise() + toWorld.origin;
}

namespace {

/// Keeps \p s beyond an end of the line if its neighbour's \p before is, at least by the least number.
double StillBeyond(const FramedLine &line, double before, double s) {
    if (before < 0)
        return std::min(s, std::nextafter(0.0, -1.0));
    return before > line.Length() ? std::max(s, std::nextafter(line.Length(), 2 * line.Length())) : s;
}

} // namespace

std::vector<double> PlacesAlong(const FramedLine &line, const Csr &adjacency, const Eigen::Matrix3Xd &position) {
    const Index k = adjacency.Size();
    std::vector<double> place(std::size_t(k), 0);
    std::vector<char> isKnown(std::size_t(k), 0);
    struct Offer {
        bool isBeyond; // beyond an end of the line
        double distance;
        Index node;
        double s;
        bool operator>(const Offer &other) const {
            return std::tie(isBeyond, distance, node, s) >
                   std::tie(other.isBeyond, other.distance, other.node, other.s);
        }
    };
    const auto offer = [&](Index j, double from, double to, double before) {
        const double s = StillBeyond(line, before, line.Nearest(position.col(j), from, to));
        return Offer{s < 0 || s > line.Length(), (line.At(s).point - position.col(j)).norm(), j, s};
    };
    std::vector<Offer> first;
    first.reserve(std::size_t(k));
    for (Index j = 0; j < k; ++j)
        first.push_back(offer(j, 0, line.Length(), 0));
    std::sort(first.begin(), first.end(), [](const Offer &a, const Offer &b) { return b > a; });
    // Begins at the nearest node of each component. Then the nearest neighbour is next; those beyond the ends come
    // last.
    std::priority_queue<Offer, std::vector<Offer>, std::greater<>> queue;
    for (const Offer &each : first) {
        if (!isKnown[std::size_t(each.node)])
            queue.push(each);
        while (!queue.empty()) {
            const Offer best = queue.top();
            queue.pop();
            const Index j = best.node;
            if (isKnown[j])
                continue;
            isKnown[j] = 1;
            place[j] = best.s;
            for (Index i : adjacency[j])
                if (!isKnown[i]) {
                    const double reach = mostStretch * (position.col(i) - position.col(j)).norm();
                    queue.push(offer(i, best.s - reach, best.s + reach, best.s));
                }
        }
    }
    return place;
}

double PlaceNear(const FramedLine &line, const RegionDeformer &deformer, const ToWorld &toWorld,
                 const std::vector<double> &place, Index node, const Eigen::Vector3d &p) {
    const auto patch = std::size_t(deformer.patches.patchOf[node]);
    const double reach = mostStretch * double(deformer.graph.radius[patch]) * toWorld.scale;
    return StillBeyond(line, place[patch], line.Nearest(p, place[patch] - reach, place[patch] + reach));
}

std::vector<LineSample> SamplesAlong(const FramedLine &line, const RegionDeformer &deformer, const ToWorld &toWorld,
                                     const std::vector<double> &place, Index count, const Progress &progress) {
    const SurfaceGraph &surface = deformer.surface;
    const Index stride = std::max<Index>(1, surface.graph.Size() / count);
    std::vector<LineSample> samples;
    for (Index u = 0; u < surface.graph.Size(); u += stride)
        if (deformer.patches.patchOf[u] >= 0)
            samples.push_back(
                {u, 0, double(surface.nodeArea[u]), toWorld(surface.graph.position.col(u).cast<double>())});
    if (std::all_of(samples.begin(), samples.end(), [](const LineSample &each) { return !(each.weight > 0); }))
        for (LineSample &each : samples) // points without an area
            each.weight = 1;
    ParallelForEach(progress, "Following the line", samples.size(), 256, [&](std::size_t i) {
        samples[i].s = PlaceNear(line, deformer, toWorld, place, samples[i].node, samples[i].at);
    });
    return samples;
}

} // namespace vcg::fcd::detail
