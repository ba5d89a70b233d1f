// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/parallel.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/quantiles.h>
#include <vcg_ext/fit/fit_matches.h>

#include <algorithm>
#include <cmath>

namespace vcg::fcd {

namespace {

// The least width of the weights, over the 90th percentile of the distances that count: a limb that comes late is among
// the last tenth, and still drawn. Of 2, 4 and 8, the larger the better, on an armadillo, a bunny and a head posed by
// CGAL.
constexpr double wide = 8;
// And at the end over that of the first step, if the distances are shorter.
constexpr double narrow = 0.05;
// A match does not count if it is this many times as long as its way back (plus a spacing). From 1.2 to 2 there was no
// rule in what it changed.
constexpr double mostDetour = 2;
// How strongly a match draws along the surface, over how strongly across: at first it draws to a point, at the end by
// alongFalls of that. With more, samples take many steps to slide; with less, a smooth shape slides along itself (the
// tube of tests/host_fit.py). Matches from the target draw as at first, since they are far until the end.
constexpr double firstAlong = 0.5, alongFalls = 0.004;

// For Alike: so many samples, and so many neighbours of each, `nearest` to `farthest` spacings away: farther than the
// noise of a triangle's corner reaches, and nearer than nodes are to each other.
constexpr std::size_t places = 1500;
constexpr int neighbours = 4;
constexpr double nearest = 1.5, farthest = 3;
// The standard deviation of noise over the median of its absolute values (Huber 1981). Distances beyond three standard
// deviations are no noise, and count as three.
constexpr double deviation = 1.4826, mostOfMedian = 3 * deviation;

// So many samples around one tell whether it lies at a rim of the surface: if their mean lies beside it, by more than
// this share of their reach (Bendels, Schnabel and Klein 2006). At a straight rim it is 4 / (3 pi) = 0.42, elsewhere 0.
constexpr std::size_t aroundOne = 24;
constexpr double besideIt = 0.3;

/// How many of some points of equal area lie at a rim of their surface.
std::size_t CountOnRim(const std::vector<Eigen::Vector3d> &at, const std::vector<Eigen::Vector3d> &normal) {
    const PointTree<double> tree(at);
    std::vector<PointTree<double>::Neighbour> beside;
    std::size_t onRim = 0;
    for (std::size_t s = 0; s < at.size(); ++s) {
        tree.Nearest(at[s], aroundOne, beside);
        Eigen::Vector3d off = Eigen::Vector3d::Zero();
        for (const auto &each : beside)
            off += (at[std::size_t(each.point)] - at[s]) / double(beside.size());
        off -= normal[s].dot(off) * normal[s];
        onRim += off.norm() > besideIt * std::sqrt(beside.back().square);
    }
    return onRim;
}

} // namespace

double SideOfNearest(const std::vector<double> &distance, const std::vector<double> &cosine) {
    const double near = Quantile(distance, 0.5);
    double sum = 0;
    for (std::size_t s = 0; s < distance.size(); ++s)
        if (distance[s] <= near)
            sum += cosine[s];
    return sum < 0 ? -1 : 1;
}

FitMatches::FitMatches(const FitTarget &target, const FitSamples &samples, const MatchParam &param)
    : target(target), samples(samples), param(param), at(Size()), turned(Size()), normal(Size()), distance(Size()),
      back(Size()), angular(Size()), weight(samples.weight), match(Size()), hint(Size()), counts(Size()),
      reach(target.Places(Size())), reaches(param.bothWays ? reach.size() : 0) {
    ListThoseThatCount();
}

void FitMatches::ListThoseThatCount() {
    some.clear();
    for (std::size_t s = 0; s < Size(); ++s)
        if (weight[s] > 0)
            some.push_back(Index(s));
}

void FitMatches::LeaveOut(const std::vector<char> &carried) {
    for (std::size_t s = 0; s < Size(); ++s)
        if (carried[s]) {
            weight[s] = 0;
            counts[s] = 0;
        }
    ListThoseThatCount();
}

std::vector<Eigen::Vector3d> FitMatches::WhereTheyAre() const {
    std::vector<Eigen::Vector3d> places;
    places.reserve(some.size());
    for (Index s : some)
        places.push_back(at[s]);
    return places;
}

void FitMatches::Search(const GraphPose &pose, unsigned threads) {
    ParallelForEach(threads, Size(), 64, [&](std::size_t s) {
        at[s] = samples.At(s, pose);
        turned[s] = samples.NormalAt(s, pose);
        match[s] = target.Nearest(at[s], hint[s]);
        distance[s] = (at[s] - match[s].point).norm();
    });
    if (some.empty())
        return;
    const std::vector<Eigen::Vector3d> own = WhereTheyAre();
    const PointTree<double> tree(own);
    ParallelForEach(threads, Size(), 64, [&](std::size_t s) {
        back[s] = (own[std::size_t(tree.Nearest(match[s].point))] - match[s].point).norm();
    });
    ParallelForEach(threads, reaches.size(), 64,
                    [&](std::size_t r) { reaches[r] = some[std::size_t(tree.Nearest(reach[r].point))]; });
}

double FitMatches::Side() const {
    std::vector<double> cosine(Size(), 0);
    for (std::size_t s = 0; s < Size(); ++s)
        if (match[s].isOriented)
            cosine[s] = match[s].normal.dot(turned[s]);
    return SideOfNearest(distance, cosine);
}

/// How well the normals of a sample and of a match agree, [0, 1]. \param n out: the mean of the two
double FitMatches::Angular(const FitTarget::Match &place, std::size_t s, Eigen::Vector3d &n) const {
    n = side * place.normal;
    if (n.isZero(0) || turned[s].isZero(0))
        return 1;
    double cosine = n.dot(turned[s]);
    if (!place.isOriented && cosine < 0) {
        n = -n;
        cosine = -cosine;
    }
    n = (n + turned[s]) / 2;
    const double full = param.edge + (1 - param.edge) / 2;
    return std::clamp((cosine - param.edge) / (full - param.edge), 0.0, 1.0);
}

/// The pull from point to plane, plus a share \p along of that from point to point (all of it if \p n is 0).
FitSystem::Pull FitMatches::PullOf(double weight, std::size_t s, const Eigen::Vector3d &place, const Eigen::Vector3d &n,
                                   double along) const {
    FitSystem::Pull pull;
    pull.form = weight / double(Size()) * (n * n.transpose() + (n.isZero(0) ? 1 : along) * Eigen::Matrix3d::Identity());
    pull.gradient = pull.form * (at[s] - place);
    return pull;
}

/// How much point \p r of the target draws its nearest sample \p s, [0, 1]; 0 if it is reached.
/// \param n out: the mean of the two normals, unless it is reached
double FitMatches::Draw(std::size_t r, std::size_t s, Eigen::Vector3d &n) const {
    const double far = (at[s] - reach[r].point).norm();
    return far <= 2 * param.spacing || far > param.farthest ? 0 : reach[r].weight * Angular(reach[r], s, n);
}

/// Adds the pulls of the target's points on their nearest samples. All pulls on one sample count together as one match,
/// however far they reach.
void FitMatches::DrawBack(std::vector<FitSystem::Pull> &pull) const {
    std::vector<double> sum(Size(), 0), drawn(reaches.size(), 0);
    std::vector<Eigen::Vector3d> mean(reaches.size());
    for (std::size_t r = 0; r < reaches.size(); ++r) {
        const std::size_t s = std::size_t(reaches[r]);
        drawn[r] = Draw(r, s, mean[r]);
        sum[s] += drawn[r];
    }
    for (std::size_t r = 0; r < reaches.size(); ++r) {
        if (drawn[r] <= 0)
            continue;
        const std::size_t s = std::size_t(reaches[r]);
        const FitSystem::Pull each =
            PullOf(weight[s] * drawn[r] * std::min(1.0, 1 / sum[s]), s, reach[r].point, mean[r], firstAlong);
        pull[s].form += each.form;
        pull[s].gradient += each.gradient;
    }
}

double FitMatches::Unreached() const {
    if (some.empty() || reach.empty())
        return 0;
    const PointTree<double> tree(WhereTheyAre());
    std::size_t unreached = 0;
    Eigen::Vector3d mean;
    for (std::size_t r = 0; r < reach.size(); ++r)
        unreached += Draw(r, std::size_t(some[std::size_t(tree.Nearest(reach[r].point))]), mean) > 0;
    return double(unreached) / double(reach.size());
}

/// The signed distance of a sample from its match, across the target.
double FitMatches::Across(std::size_t s) const { return normal[s].normalized().dot(at[s] - match[s].point); }

double FitMatches::Noise() const {
    std::vector<double> far;
    for (std::size_t s = 0; s < Size(); ++s)
        if (counts[s])
            far.push_back(std::abs(Across(s)));
    return deviation * Quantile(far, 0.5);
}

double FitMatches::Alike() {
    for (std::size_t s = 0; s < Size() && beside.size() < neighbours * places; s += 1 + (Size() - 1) / places) {
        int found = 0;
        for (std::size_t other = 0; other < Size() && found < neighbours; ++other) {
            const double far = (at[s] - at[other]).norm() / param.spacing;
            if (far > nearest && far < farthest && turned[s].dot(turned[other]) >= 0.5) { // on the same side
                beside.emplace_back(Index(s), Index(other));
                ++found;
            }
        }
    }
    std::vector<double> far;
    for (std::size_t s = 0; s < Size(); ++s)
        if (counts[s])
            far.push_back(distance[s]);
    const double most = mostOfMedian * Quantile(far, 0.5);
    const auto off = [&](Index s) { return std::clamp(Across(std::size_t(s)), -most, most); };
    double squares = 0, products = 0;
    for (const auto &[a, b] : beside)
        if (counts[a] && counts[b]) {
            squares += detail::Squared(off(a)) + detail::Squared(off(b));
            products += 2 * off(a) * off(b);
        }
    return squares > 0 ? products / squares : 1;
}

void FitMatches::Find(const GraphPose &pose, double part, unsigned threads, std::vector<FitSystem::Pull> &pull) {
    Search(pose, threads);
    if (first < 0) {
        side = Side();
        onRim = target.IsCloud() && !target.reachesFarther ? CountOnRim(at, turned) : 0;
    }
    std::vector<double> good;
    for (std::size_t s = 0; s < Size(); ++s) {
        angular[s] = Angular(match[s], s, normal[s]);
        counts[s] = weight[s] > 0 && match[s].weight > 0 && angular[s] > 0 && distance[s] <= param.farthest &&
                    distance[s] <= param.spacing + mostDetour * back[s];
        if (counts[s] && !match[s].onBorder)
            good.push_back(distance[s]);
    }
    // At a border of the target, samples that are farther than most are elsewhere lie beyond it.
    const double median = Quantile(good, 0.5), atBorder = std::max(1.5 * median, least);
    const auto isBeyond = [&](std::size_t s) { return match[s].onBorder && distance[s] > atBorder; };
    std::size_t beyond = 0;
    for (std::size_t s = 0; s < Size(); ++s)
        beyond += weight[s] > 0 && isBeyond(s);
    for (std::size_t s = 0; s < Size() && beyond > onRim; ++s)
        if (isBeyond(s))
            counts[s] = 0;
    if (first < 0)
        first = std::max(2 * median, 2e-6);
    const double width = std::max({first * detail::Power(narrow, part), wide * Quantile(good, 0.9), least});
    const double along = firstAlong * detail::Power(alongFalls, part);
    for (std::size_t s = 0; s < Size(); ++s) {
        const double w = counts[s] ? weight[s] * match[s].weight * angular[s] *
                                         detail::Exponential(-0.5 * detail::Squared(distance[s] / width))
                                   : 0;
        pull[s] = PullOf(w, s, match[s].point, normal[s], along);
    }
    DrawBack(pull);
}

} // namespace vcg::fcd
