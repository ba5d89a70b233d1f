// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/fit/fit_parts.h>
#include <vcg_ext/fit/fit_system.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace vcg::fcd {

namespace {

// The least share of a part that must lie on the target, apart from other parts, for its matches to lead it. Balls in
// and beside a body have none; a separate limb of which the target has a fifth has a twentieth.
constexpr double leastLed = 0.03;
constexpr int carrySteps = 10; // a part that is placed comes to rest in fewer

} // namespace

FitParts::FitParts(const RegionDeformer &deformer, const FitSamples &samples, std::size_t matched)
    : deformer(deformer), matched(matched) {
    const Index parts = ConnectedComponents(deformer.graph.graph.adjacency, partOf);
    isHeld.assign(std::size_t(parts), 0);
    for (Index j = 0; j < deformer.graph.Size(); ++j)
        if (deformer.held.tag[std::size_t(deformer.patches.center[j])] != 1)
            isHeld[std::size_t(partOf[j])] = 1;
    for (std::size_t s = 0; s < samples.Size(); ++s)
        sampleOf.push_back(samples.begin[s] < samples.begin[s + 1]
                               ? partOf[std::size_t(samples.term[samples.begin[s]].node)]
                               : -1); // all around it is held
    std::vector<char> isLed = isHeld;
    for (Index part : sampleOf)
        if (part >= 0)
            isLed[part] = 1;
    Decide(isLed);
}

void FitParts::Decide(const std::vector<char> &isLed) {
    isCarried.assign(isLed.size(), 0);
    if (std::count(isLed.begin(), isLed.end(), char(0)) < std::ptrdiff_t(isLed.size())) // something can carry
        for (std::size_t p = 0; p < isLed.size(); ++p)
            isCarried[p] = !isLed[p];
}

void FitParts::Judge(const FitMatches &matches, const std::function<bool(std::size_t)> &liesOn,
                     const std::vector<char> &follows) {
    const std::size_t parts = isHeld.size();
    if (parts < 2)
        return;
    std::vector<char> isLed = isHeld;
    for (std::size_t l = 0; l < follows.size(); ++l)
        if (follows[l] && sampleOf[matched + l] >= 0)
            isLed[std::size_t(sampleOf[matched + l])] = 1;
    std::vector<std::vector<std::size_t>> own(parts); // samples
    for (std::size_t s = 0; s < matched; ++s)
        if (sampleOf[s] >= 0)
            own[std::size_t(sampleOf[s])].push_back(s);
    std::vector<std::size_t> order(parts);
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return isLed[a] != isLed[b] ? isLed[a] > isLed[b] : own[a].size() > own[b].size();
    });
    std::vector<Eigen::Vector3d> there; // matches of samples of led parts that lie on the target
    for (std::size_t part : order) {
        std::vector<Eigen::Vector3d> found;
        for (std::size_t s : own[part])
            if (liesOn(s))
                found.push_back(matches.Place(s));
        std::size_t alone = found.size();
        if (!there.empty() && !isLed[part] && !found.empty()) {
            const PointTree<double> tree(there);
            for (const Eigen::Vector3d &place : found)
                alone -= (there[std::size_t(tree.Nearest(place))] - place).norm() <= matches.Spacing();
        }
        if (!isLed[part])
            isLed[part] = !own[part].empty() && double(alone) >= leastLed * double(own[part].size());
        if (isLed[part])
            there.insert(there.end(), found.begin(), found.end());
    }
    Decide(isLed);
}

std::size_t FitParts::Carried() const {
    return std::size_t(std::count_if(isCarried.begin(), isCarried.end(), [](char each) { return each != 0; }));
}

std::vector<char> FitParts::CarriedNodes() const {
    std::vector<char> carried(Carried() > 0 ? partOf.size() : 0);
    for (std::size_t j = 0; j < carried.size(); ++j)
        carried[j] = IsCarried(Index(j));
    return carried;
}

std::vector<char> FitParts::CarriedSamples() const {
    std::vector<char> carried(matched, 0);
    for (std::size_t s = 0; s < matched; ++s)
        carried[s] = sampleOf[s] >= 0 && isCarried[std::size_t(sampleOf[s])];
    return carried;
}

std::vector<char> FitParts::Led(std::vector<char> isFree) const {
    for (std::size_t j = 0; j < isFree.size(); ++j)
        isFree[j] = isFree[j] && !IsCarried(Index(j));
    return isFree;
}

void FitParts::Carry(const std::vector<char> &isFree, double smoothness, double rigidity, double stiffness,
                     GraphPose &pose, unsigned threads) const {
    const Index k = deformer.graph.Size();
    const auto rest = [&](Index j) { return deformer.graph.graph.position.col(j).cast<double>(); };
    const double spacing = std::sqrt(std::max(deformer.surface.area, 1e-12) / double(std::max<Index>(k, 1)));
    std::vector<double> gap(isHeld.size(), std::numeric_limits<double>::infinity()); // from each part to led ones
    std::vector<Index> leader, follower;
    for (Index j = 0; j < k; ++j)
        if (!IsCarried(j))
            leader.push_back(j);
        else if (isFree[j])
            follower.push_back(j);
    if (leader.empty() || follower.empty())
        return;
    for (Index j : follower)
        for (Index i : leader) {
            double &least = gap[std::size_t(partOf[j])];
            least = std::min(least, (rest(i) - rest(j)).norm());
        }
    // Where the surroundings take a point of the rest shape, and their rotation there.
    const auto around = [&](Index part, const Eigen::Vector3d &p, Eigen::Matrix3d &turn) {
        std::vector<double> far;
        far.reserve(leader.size());
        for (Index i : leader)
            far.push_back((p - rest(i)).norm());
        const double reach = *std::min_element(far.begin(), far.end()) + gap[part] + spacing;
        Eigen::Vector3d to = Eigen::Vector3d::Zero();
        double sum = 0;
        turn.setZero();
        for (std::size_t n = 0; n < leader.size(); ++n) {
            if (far[n] >= reach)
                continue;
            const Index i = leader[n];
            const double part = 1 - detail::Squared(far[n] / reach), weight = part * part * part;
            to += weight * (pose.linear[i] * (p - rest(i)) + pose.position.col(i));
            turn += weight * pose.linear[i];
            sum += weight;
        }
        turn = rigidity < 1 ? Eigen::Matrix3d(turn / sum) : detail::RotationOf(turn / sum);
        return Eigen::Vector3d(to / sum);
    };
    FitSamples marks;
    std::vector<Eigen::Vector3d> place;
    std::vector<char> moves(isFree.size(), 0);
    RegionPose held; // empty: samples of carried parts are not influenced by held surface
    for (Index j : follower) {
        Eigen::Matrix3d turn;
        const Index center = deformer.patches.center[j];
        marks.Add(deformer, held, center);
        const Index part = partOf[j];
        place.push_back(around(part, deformer.surface.graph.position.col(center).cast<double>(), turn));
        pose.position.col(j) = around(part, rest(j), turn);
        pose.linear[j] = turn;
        moves[j] = 1;
    }
    FitSystem system(deformer, moves, marks, smoothness, rigidity);
    std::vector<FitSystem::Pull> pull(marks.Size());
    const std::vector<double> stiff(isFree.size(), stiffness);
    for (int step = 0; step < carrySteps; ++step) {
        for (std::size_t s = 0; s < marks.Size(); ++s) {
            pull[s].form = Eigen::Matrix3d::Identity() / double(k);
            pull[s].gradient = pull[s].form * (marks.At(s, pose) - place[s]);
        }
        FitSystem::Take(system.Step(pose, pull, stiff, threads), pose);
    }
}

} // namespace vcg::fcd
