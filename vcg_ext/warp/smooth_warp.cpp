// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/quantiles.h>
#include <vcg_ext/warp/normal_equations.h>
#include <vcg_ext/warp/smooth_warp.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace vcg::fcd {

// An inverse that stretches by more is none: no shape is pressed so much.
constexpr double mostStretched = 10;

SmoothWarp::SmoothWarp(const Eigen::Vector3d &middle, double radius, int degree) : middle(middle), radius(radius) {
    for (int all = 0; all <= degree; ++all)
        for (int x = all; x >= 0; --x)
            for (int y = all - x; y >= 0; --y)
                power.emplace_back(x, y, all - x - y);
    coefficient = Eigen::Matrix3Xd::Zero(3, Eigen::Index(power.size()));
}

Eigen::VectorXd SmoothWarp::Basis(const Eigen::Vector3d &p, Eigen::MatrixX3d *slope,
                                  Eigen::Matrix<double, Eigen::Dynamic, 6> *curvature) const {
    const Eigen::Vector3d u = (p - middle) / radius;
    const Eigen::Index n = Size();
    Eigen::VectorXd value(n);
    if (slope)
        slope->resize(n, 3);
    if (curvature)
        curvature->resize(n, 6);
    const int degree = power.empty() ? 0 : power.back().z();
    // Powers of the coordinates.
    std::vector<Eigen::Vector3d> to(std::size_t(degree) + 1, Eigen::Vector3d::Ones());
    for (std::size_t d = 1; d < to.size(); ++d)
        to[d] = to[d - 1].cwiseProduct(u);
    const auto at = [&](int axis, int exponent, int order) {
        double factor = 1;
        for (int k = 0; k < order; ++k)
            factor *= exponent - k;
        return factor == 0 ? 0 : factor * to[std::size_t(exponent - order)][axis];
    };
    const auto product = [&](const Eigen::Vector3i &e, int x, int y, int z) {
        return at(0, e.x(), x) * at(1, e.y(), y) * at(2, e.z(), z);
    };
    for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::Vector3i &e = power[std::size_t(i)];
        value[i] = product(e, 0, 0, 0);
        if (slope)
            slope->row(i) << product(e, 1, 0, 0), product(e, 0, 1, 0), product(e, 0, 0, 1);
        if (curvature)
            curvature->row(i) << product(e, 2, 0, 0), product(e, 0, 2, 0), product(e, 0, 0, 2), product(e, 1, 1, 0),
                product(e, 0, 1, 1), product(e, 1, 0, 1);
    }
    if (slope)
        *slope /= radius;
    if (curvature)
        *curvature /= radius * radius;
    return value;
}

Eigen::Vector3d SmoothWarp::At(const Eigen::Vector3d &p) const { return p + coefficient * Basis(p); }

Eigen::Matrix3d SmoothWarp::LinearAt(const Eigen::Vector3d &p) const {
    Eigen::MatrixX3d slope;
    Basis(p, &slope);
    return Eigen::Matrix3d::Identity() + coefficient * slope;
}

Eigen::Vector3d SmoothWarp::Back(const Eigen::Vector3d &p, const Eigen::Vector3d &near) const {
    Eigen::Vector3d x = near;
    double first = 0;                       // how far At(near) is off
    for (int step = 0; step < 20; ++step) { // each step doubles the correct digits
        const Eigen::Vector3d off = At(x) - p;
        if (step == 0)
            first = off.norm();
        x -= LinearAt(x).partialPivLu().solve(off);
        if (!(off.norm() > 1e-14))
            break;
    }
    // Beyond a fold, Newton's method may end anywhere.
    return (x - near).norm() <= mostStretched * first && (At(x) - p).norm() <= first ? x : near;
}

Eigen::Matrix3d SmoothWarp::LinearBack(const Eigen::Vector3d &p) const {
    const Eigen::Matrix3d linear = LinearAt(p), back = linear.inverse();
    return linear.determinant() > 0 && back.norm() <= mostStretched ? back : Eigen::Matrix3d::Identity();
}

namespace {

// The largest move of a step at rest, over the diagonal: a tenth of the error of a good fit. WarpGoal::rest may raise
// it.
constexpr double still = 1e-5;
constexpr int mostSteps = 40; // of each degree; mostly, 10 to 20 are enough
// The weight of a match along the surface, over that across it. At first it is larger, since the surface is shifted
// along itself.
constexpr double alongFirst = 0.1, along = 0.001;
// Errors of a scan, and what of a warp is no polynomial, are alike over a tenth of the diagonal. So all matches of a
// part tell as much as this number of independent ones.
constexpr double independent = 100;
// Cosines between two normals: below the first, sides differ; above the second, they agree.
constexpr double anotherSide = 0.3, sameSide = 0.7;

double MedianOf(std::vector<double> values) {
    if (values.empty())
        return 0;
    const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double RobustWeight(double off) { return 1 / ((1 + off * off) * (1 + off * off)); }

bool HasSides(const Eigen::Vector3d &normal, const WarpMatch &match) {
    return !match.normal.isZero(0) && !normal.isZero(0);
}

/// How much both normals agree, [0, 1].
double SideOf(const Eigen::Vector3d &normal, const WarpMatch &match) {
    if (!HasSides(normal, match))
        return 1;
    const double cosine = match.isOriented ? normal.dot(match.normal) : std::abs(normal.dot(match.normal));
    return std::clamp((cosine - anotherSide) / (sameSide - anotherSide), 0.0, 1.0);
}

// A match so many times farther than the place nearest to it belongs to the other side, as in FitMatches.
constexpr double mostDetour = 2;

/// Leaves out matches with the other side of a thin part. If the target's normals are not oriented, this shows by
/// another place of the surface that is much nearer to the match.
void LeaveOutDetours(const std::vector<Eigen::Vector3d> &at, const std::vector<WarpMatch> &match,
                     const std::vector<double> &far, unsigned threads, std::vector<double> &share) {
    if (std::all_of(match.begin(), match.end(), [](const WarpMatch &each) { return each.isOriented; }))
        return;
    const PointTree<double> tree(at, threads);
    std::vector<double> back(at.size());
    ParallelForEach(threads, at.size(), 64, [&](std::size_t s) { tree.Nearest(match[s].point, &back[s]); });
    const double spacing = MedianOf(back);
    for (std::size_t s = 0; s < at.size(); ++s)
        if (!match[s].isOriented && far[s] > spacing + mostDetour * back[s])
            share[s] = 0;
}

/// The standard deviations of a warp at places, by the equations of its last step. Rigid motions of all count as known.
/// \param width of the noise \param basis, slope at the places
std::vector<double> DoubtsOf(NormalEquations sums, double width, const std::vector<Eigen::VectorXd> &basis,
                             const std::vector<Eigen::MatrixX3d> &slope) {
    const Eigen::Index n = basis.front().size(), places = Eigen::Index(basis.size());
    Eigen::MatrixXd all(n, places);
    Eigen::MatrixX3d turn = Eigen::MatrixX3d::Zero(n, 3);
    for (Eigen::Index s = 0; s < places; ++s) {
        all.col(s) = basis[std::size_t(s)];
        turn += slope[std::size_t(s)] / double(places);
    }
    const double known = sums.Largest();
    for (int i = 0; i < 3; ++i) {
        Eigen::VectorXd shift = Eigen::VectorXd::Zero(3 * n), twist = shift;
        shift.segment(i * n, n) = all.rowwise().mean();
        twist.segment(i * n, n) = turn.col((i + 1) % 3);
        twist.segment((i + 1) % 3 * n, n) = -turn.col(i);
        sums.AddSquare(known, shift);
        sums.AddSquare(known, twist);
    }
    const Eigen::VectorXd variances = sums.Variances(all);
    std::vector<double> doubts(basis.size());
    for (Eigen::Index s = 0; s < places; ++s)
        doubts[std::size_t(s)] = width * std::sqrt(variances[s]);
    return doubts;
}

} // namespace

std::vector<double> WithCounterpart(const std::vector<double> &far, const std::vector<double> &share) {
    std::vector<double> found;
    for (std::size_t s = 0; s < far.size(); ++s)
        if (share[s] > 0)
            found.push_back(far[s]);
    return 2 * found.size() < far.size() ? far : found;
}

double MisfitOf(const std::vector<double> &far, const std::vector<double> &share, double part) {
    const std::vector<double> found = WithCounterpart(far, share);
    return MeanOfSmallest(found, part) * double(far.size()) / double(std::max<std::size_t>(found.size(), 1));
}

SmoothWarp FitWarp(const WarpGoal &goal, const Progress &progress, WarpReport *report) {
    const std::size_t places = goal.place.size();
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d &each : goal.place)
        box.extend(each);
    const Eigen::Vector3d middle = box.center();
    const double radius = std::max(0.5 * box.sizes().maxCoeff(), 1e-9);
    SmoothWarp warp;
    std::vector<Eigen::Vector3d> at = goal.place, normal = goal.normal;
    std::vector<WarpMatch> match(places);
    std::vector<double> far(places), share(places), found; // share: weight of each match, without the robust one
    std::vector<double> off(goal.from.size());             // of landmarks, from where they belong
    std::vector<Eigen::VectorXd> basis(places);
    std::vector<Eigen::MatrixX3d> slope(places);
    const bool hasStrain = std::isfinite(goal.typicalStrain);
    NormalEquations sums(0);
    double width = 0, bends = 0; // bends: the warp of the last step, as typicalBending
    for (int degree = 1; degree <= goal.degree; ++degree) {
        warp = SmoothWarp(middle, radius, degree);
        const Eigen::Index n = warp.Size();
        Eigen::MatrixXd bending = Eigen::MatrixXd::Zero(n, n);
        for (std::size_t s = 0; s < places; ++s) {
            Eigen::Matrix<double, Eigen::Dynamic, 6> curvature;
            basis[s] = warp.Basis(goal.place[s], &slope[s], &curvature);
            for (int k = 0; k < 6; ++k) // mixed derivatives appear twice
                for (Eigen::Index c = 0; c < n; ++c)
                    bending.col(c) += ((k < 3 ? 1 : 2) / double(places) * curvature(c, k)) * curvature.col(k);
        }
        Eigen::MatrixXd strain = Eigen::MatrixXd::Zero(hasStrain ? 3 * n : 0, hasStrain ? 3 * n : 0);
        for (std::size_t s = 0; s < places && hasStrain; ++s) // the squared symmetric part of C slope
            for (int i = 0; i < 3; ++i)
                for (int k = 0; k < 3; ++k)
                    for (Eigen::Index c = 0; c < n; ++c) {
                        auto column = strain.col(k * n + c).segment(i * n, n);
                        column += (0.5 / double(places) * slope[s](c, i)) * slope[s].col(k);
                        for (int j = 0; i == k && j < 3; ++j)
                            column += (0.5 / double(places) * slope[s](c, j)) * slope[s].col(j);
                    }
        for (int step = 0; step < mostSteps; ++step) {
            progress((degree - 1 + double(step) / mostSteps) / goal.degree, "Warping");
            ParallelForEach(progress.threads, places, 64, [&](std::size_t s) {
                match[s] = goal.match(s, at[s]);
                far[s] = (match[s].point - at[s]).norm();
            });
            for (std::size_t s = 0; s < places; ++s)
                share[s] = far[s] <= goal.farthest ? goal.weight[s] * match[s].weight * SideOf(normal[s], match[s]) : 0;
            LeaveOutDetours(at, match, far, progress.threads, share);
            found.clear();
            for (std::size_t s = 0; s < places; ++s)
                if (share[s] > 0)
                    found.push_back(far[s]);
            const double left = std::max(2 * MedianOf(found), leastNoise);
            width = std::max(left, goal.noise);
            // Maximum a posteriori: typical bending is as likely as noise of this width, and so is typical strain. In
            // the first steps the width is larger, and the warp bends less. Once no match is an outlier for its
            // distance alone, what is left is noise, or no polynomial: that is alike over parts of the surface.
            const double together =
                hasStrain ? std::max((1 - width / goal.expected) * double(found.size()) / independent, 1.0) : 1;
            const auto prior = [&](double typical, double actual) {
                return std::max(detail::Squared(width / typical),
                                together * detail::Squared(left / std::max(typical, actual)));
            };
            const double ofBending = prior(goal.typicalBending, bends);
            // A bend over half of the diagonal turns by bends / 2, which looks like a strain of half the square.
            const double ofStrain = hasStrain ? prior(goal.typicalStrain, detail::Squared(bends) / 8) : 0;
            double beside = degree == 1 ? alongFirst : along;
            if (hasStrain && degree > 1) // held by its strain; the matches, which go along, get a tenth of that
                beside = std::min(beside, 0.3 * ofStrain / detail::Squared(radius) /
                                              double(std::max<std::size_t>(found.size(), 1)));
            sums = NormalEquations(n);
            double counted = 0;
            for (std::size_t s = 0; s < places; ++s) {
                if (!(share[s] > 0))
                    continue;
                const double weight = share[s] * RobustWeight(far[s] / std::max(width, goal.expected));
                counted += weight;
                Eigen::Matrix3d form = Eigen::Matrix3d::Identity();
                if (HasSides(normal[s], match[s])) {
                    const Eigen::Vector3d mean =
                        (match[s].normal + (normal[s].dot(match[s].normal) < 0 ? -1 : 1) * normal[s])
                            .stableNormalized();
                    form = mean * mean.transpose() + beside * Eigen::Matrix3d::Identity();
                }
                sums.Add(weight * form, basis[s], match[s].point - goal.place[s]);
            }
            // Landmarks lead a shape that is sheared: they are doubted only once it is.
            const double usual = std::max(2 * MedianOf(off), goal.landmarkNoise);
            for (std::size_t l = 0; l < goal.from.size(); ++l)
                sums.Add((degree == 1 ? 1 : RobustWeight(off[l] / usual)) * goal.landmarkWeight *
                             std::max(counted, 1.0) / double(goal.from.size()) * Eigen::Matrix3d::Identity(),
                         warp.Basis(goal.from[l]), goal.to[l] - goal.from[l]);
            sums.AddBending(ofBending, bending);
            if (hasStrain)
                sums.Add(ofStrain, strain);
            warp.coefficient = sums.Solution();
            if (hasStrain)
                bends = std::sqrt((warp.coefficient * bending * warp.coefficient.transpose()).trace());
            for (std::size_t l = 0; l < goal.from.size(); ++l)
                off[l] = (warp.At(goal.from[l]) - goal.to[l]).norm();
            double moved = 0;
            for (std::size_t s = 0; s < places; ++s) {
                const Eigen::Vector3d to = goal.place[s] + warp.coefficient * basis[s];
                moved = std::max(moved, (to - at[s]).norm());
                at[s] = to;
                const Eigen::Matrix3d linear = Eigen::Matrix3d::Identity() + warp.coefficient * slope[s];
                const Eigen::Matrix3d cofactors = linear.determinant() * linear.inverse().transpose();
                normal[s] = (cofactors * goal.normal[s]).stableNormalized();
            }
            if (moved <= std::max(still, goal.rest * MeanOfSmallest(far, mostMatches)))
                break;
        }
    }
    if (report)
        *report = {MisfitOf(far, share), MisfitOf(far, share, 1), std::move(share), {}};
    if (report && hasStrain)
        report->doubt = DoubtsOf(std::move(sums), width, basis, slope);
    return warp;
}

} // namespace vcg::fcd
