// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit/fit_guess.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

namespace vcg::fcd {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::size_t bins = 24, mostNodes = 400; // of more nodes, so many are compared, evenly chosen
constexpr double mostOff = 2;                     // times the rms: what 95 % are within
constexpr std::size_t fewPairs = 30;              // the least number of pairs in a bin, for an rms that is no chance

/// The structure function of a pose: how far nodes are from where another node, at some distance, would carry them.
class Structure {
  public:
    Structure(const RegionDeformer &deformer, std::vector<Index> node, const GraphPose &pose) {
        const auto rest = [&](Index j) { return deformer.graph.graph.position.col(j).cast<double>(); };
        if (node.size() > mostNodes) {
            std::vector<Index> some;
            some.reserve(mostNodes);
            for (std::size_t i = 0; i < mostNodes; ++i)
                some.push_back(node[i * node.size() / mostNodes]);
            node.swap(some);
        }
        for (Index i : node)
            for (Index j : node)
                farthest = std::max(farthest, (rest(i) - rest(j)).norm());
        std::vector<double> sum(bins, 0);
        std::vector<std::size_t> count(bins, 0);
        for (Index i : node)
            for (Index j : node) {
                if (i == j)
                    continue;
                const Eigen::Vector3d offset = rest(j) - rest(i);
                const std::size_t bin = std::min(bins - 1, std::size_t(double(bins) * offset.norm() / farthest));
                sum[bin] += (pose.linear[i] * offset + pose.position.col(i) - pose.position.col(j)).squaredNorm();
                ++count[bin];
            }
        for (std::size_t bin = 0; bin < bins; ++bin)
            if (count[bin] >= fewPairs) { // never less than in nearer bins
                at.push_back((double(bin) + 0.5) / double(bins) * farthest);
                off.push_back(
                    std::max(off.empty() ? 0 : off.back(), mostOff * std::sqrt(sum[bin] / double(count[bin]))));
            }
    }

    double operator()(double distance) const {
        if (at.empty())
            return std::numeric_limits<double>::quiet_NaN();
        if (distance >= at.back())
            return off.back() * detail::Squared(distance / at.back());
        double before = 0, offBefore = 0;
        for (std::size_t k = 0;; ++k) {
            if (distance <= at[k])
                return offBefore + (off[k] - offBefore) * (distance - before) / (at[k] - before);
            before = at[k];
            offBefore = off[k];
        }
    }

  private:
    double farthest = 0;
    std::vector<double> at, off; ///< middles of the bins, and the values there
};

} // namespace

FitGuess Guess(const RegionDeformer &deformer, const FitSamples &samples,
               const std::function<bool(std::size_t)> &isKnown, const std::vector<char> &isFree, double density,
               const GraphPose &pose) {
    const Graph &graph = deformer.graph.graph;
    const std::size_t k = std::size_t(graph.Size());
    std::vector<double> all(k, 0), known(k, 0);
    for (std::size_t s = 0; s < samples.Size(); ++s) {
        const bool isSampleKnown = isKnown(s);
        for (std::uint32_t t = samples.begin[s]; t < samples.begin[s + 1]; ++t) {
            all[std::size_t(samples.term[t].node)] += samples.term[t].weight;
            known[std::size_t(samples.term[t].node)] += isSampleKnown ? samples.term[t].weight : 0;
        }
    }
    std::vector<Index> matched;
    std::vector<double> distance(k, infinite); // along the graph from matched or held nodes
    using Reached = std::pair<double, Index>;
    std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
    for (std::size_t j = 0; j < k; ++j) {
        const double expected = deformer.graph.area.empty() ? 0 : density * deformer.graph.area[j];
        const bool leads = isFree[j] && known[j] > 0 && 2 * known[j] >= std::max(all[j], expected);
        if (leads)
            matched.push_back(Index(j));
        if (leads || !isFree[j]) {
            distance[j] = 0;
            next.emplace(0, Index(j));
        }
    }
    const auto rest = [&](Index j) { return graph.position.col(j).cast<double>(); };
    std::vector<Index> source;
    for (std::size_t j = 0; j < k; ++j)
        if (distance[j] == 0)
            source.push_back(Index(j));
    while (!next.empty()) {
        const auto [far, i] = next.top();
        next.pop();
        if (far > distance[i])
            continue;
        for (Index j : graph.adjacency[i]) {
            const double there = far + (rest(i) - rest(j)).norm();
            if (there < distance[j]) {
                distance[j] = there;
                next.emplace(there, j);
            }
        }
    }
    FitGuess guess;
    guess.error.assign(k, 0);
    const Structure structure(deformer, matched, pose);
    double free = 0, guessed = 0, squares = 0;
    for (std::size_t j = 0; j < k; ++j) {
        if (!isFree[j])
            continue;
        const double area = deformer.graph.area.empty() ? 1 : deformer.graph.area[j];
        free += area;
        if (distance[j] == 0)
            continue;
        if (distance[j] == infinite) // a part that others carry
            for (Index i : source)
                distance[j] = std::min(distance[j], (rest(i) - rest(Index(j))).norm());
        guess.error[j] = distance[j] == infinite ? std::numeric_limits<double>::quiet_NaN() : structure(distance[j]);
        guessed += area;
        squares += area * detail::Squared(guess.error[j]);
    }
    guess.share = free > 0 ? guessed / free : 0;
    guess.rms = guessed > 0 ? std::sqrt(squares / guessed) : 0;
    return guess;
}

} // namespace vcg::fcd
