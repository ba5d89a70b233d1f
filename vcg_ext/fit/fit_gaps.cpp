// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/fit/fit_gaps.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace vcg::fcd {

namespace {

// Surface without a counterpart is a gap if it is wider than `widest` nodes on each side; narrower, it is a hole, and
// bends as its sides do. `margin` nodes with a counterpart, beside the gap, are as stiff, so that they lead by all of
// their patches. Chosen on the half armadillos and the heads with holes (tests/fit_recipes.py): of widest 0, 1 and 2, 0
// spoils the holes, and 1 and 2 are the same.
constexpr int widest = 2, margin = 1;

/// The largest, or with less = true the smallest, value of each node and its neighbours.
std::vector<double> Beside(const Csr &adjacency, const std::vector<double> &value, bool less) {
    std::vector<double> result = value;
    for (std::size_t j = 0; j < value.size(); ++j)
        for (Index i : adjacency[Index(j)])
            result[j] = less ? std::min(result[j], value[i]) : std::max(result[j], value[i]);
    return result;
}

} // namespace

std::vector<double> MatchedShares(std::size_t nodes, const FitMatches &matches, const FitSamples &samples) {
    std::vector<double> all(nodes, 0), share = all;
    for (std::size_t s = 0; s < samples.Size(); ++s)
        for (std::uint32_t t = samples.begin[s]; t < samples.begin[s + 1]; ++t) {
            all[std::size_t(samples.term[t].node)] += samples.term[t].weight;
            share[std::size_t(samples.term[t].node)] += matches.Counts(s) ? samples.term[t].weight : 0;
        }
    for (std::size_t j = 0; j < all.size(); ++j)
        share[j] = all[j] > 0 ? share[j] / all[j] : 0;
    return share;
}

FitGaps::FitGaps(const RegionDeformer &deformer, const FitMatches &matches, const FitSamples &samples) {
    const Graph &graph = deformer.graph.graph;
    std::vector<double> share = MatchedShares(std::size_t(graph.Size()), matches, samples);
    for (int i = 0; i < 2 * widest + margin; ++i)
        share = Beside(graph.adjacency, share, i >= widest);
    gap = share;
    for (double &each : gap) // 1 up to half of the samples matched, falling to 0 at all
        each = std::clamp(2 * (1 - each), 0.0, 1.0);
    for (std::size_t s = 0; s < samples.Size(); ++s)
        if (matches.Counts(s) &&
            std::any_of(samples.term.begin() + samples.begin[s], samples.term.begin() + samples.begin[s + 1],
                        [&](const FitSamples::Term &term) { return gap[std::size_t(term.node)] > 0; }))
            around.push_back(s);
}

std::vector<double> FitGaps::Stiffness(std::vector<double> soft, double stiff) const {
    for (std::size_t j = 0; j < soft.size(); ++j)
        soft[j] *= detail::Power(std::max(stiff / soft[j], 1.0), gap[j]);
    return soft;
}

double FitGaps::Misfit(const FitMatches &matches) const {
    double sum = 0;
    for (std::size_t s : around)
        sum += detail::Squared(matches.Distance(s));
    return std::sqrt(sum / double(std::max<std::size_t>(around.size(), 1)));
}

double FitGaps::Moved(const std::vector<Eigen::Vector3d> &before, const std::vector<Eigen::Vector3d> &now) const {
    double sum = 0;
    for (std::size_t s : around)
        sum += (now[s] - before[s]).squaredNorm();
    return std::sqrt(sum / double(std::max<std::size_t>(around.size(), 1)));
}

} // namespace vcg::fcd
