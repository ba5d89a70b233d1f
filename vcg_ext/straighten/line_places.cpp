// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/straighten/line_places.h>

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>

namespace vcg {
namespace fcd {
namespace detail {

Eigen::Matrix3Xd NodesOf(const Deformer &deformer, const ToWorld &toWorld) {
    Eigen::Matrix3Xd position(3, deformer.graph.Size());
    for (Index j = 0; j < deformer.graph.Size(); ++j)
        position.col(j) = toWorld(deformer.graph.graph.position.col(j).cast<double>());
    return position;
}

std::vector<double> PlacesAlong(const FramedLine &line, const Csr &adjacency, const Eigen::Matrix3Xd &position) {
    const Index k = adjacency.Size();
    std::vector<double> place(std::size_t(k), 0);
    std::vector<char> isKnown(std::size_t(k), 0);
    using Offer = std::tuple<double, Index, double>; // distance, node, place
    const auto offer = [&](Index j, double from, double to) {
        const double s = line.Nearest(position.col(j), from, to);
        return Offer((line.At(s).point - position.col(j)).norm(), j, s);
    };
    std::vector<Offer> first;
    for (Index j = 0; j < k; ++j)
        first.push_back(offer(j, 0, line.Length()));
    std::sort(first.begin(), first.end());
    // The nearest node of each component first; then on from there, the nearest next.
    std::priority_queue<Offer, std::vector<Offer>, std::greater<>> queue;
    for (const Offer &each : first) {
        if (!isKnown[std::size_t(std::get<1>(each))])
            queue.push(each);
        while (!queue.empty()) {
            const auto [distance, j, s] = queue.top();
            queue.pop();
            if (isKnown[std::size_t(j)])
                continue;
            isKnown[std::size_t(j)] = 1;
            place[std::size_t(j)] = s;
            for (Index i : adjacency[j])
                if (!isKnown[std::size_t(i)]) {
                    const double reach = mostStretch * (position.col(i) - position.col(j)).norm();
                    queue.push(offer(i, s - reach, s + reach));
                }
        }
    }
    return place;
}

double PlaceNear(const FramedLine &line, const Deformer &deformer, const ToWorld &toWorld,
                 const std::vector<double> &place, Index node, const Eigen::Vector3d &p) {
    const auto patch = std::size_t(deformer.patches.patchOf[std::size_t(node)]);
    const double reach = mostStretch * double(deformer.graph.radius[patch]) * toWorld.scale;
    return line.Nearest(p, place[patch] - reach, place[patch] + reach);
}

std::vector<LineSample> SamplesAlong(const FramedLine &line, const Deformer &deformer, const ToWorld &toWorld,
                                 const std::vector<double> &place, Index count, unsigned threads) {
    const SurfaceGraph &surface = deformer.surface;
    const Index stride = std::max<Index>(1, surface.graph.Size() / count);
    std::vector<LineSample> samples;
    for (Index u = 0; u < surface.graph.Size(); u += stride)
        if (deformer.patches.patchOf[std::size_t(u)] >= 0)
            samples.push_back({u, 0, double(surface.nodeArea[std::size_t(u)]),
                               toWorld(surface.graph.position.col(u).cast<double>())});
    ParallelFor(threads, samples.size(), 256, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            samples[i].s = PlaceNear(line, deformer, toWorld, place, samples[i].node, samples[i].at);
    });
    return samples;
}

} // namespace detail
} // namespace fcd
} // namespace vcg
