// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/symmetric_eigen.h>
#include <vcg_ext/symmetry/mirror_plane.h>
#include <vcg_ext/warp/smooth_warp.h>

#include <algorithm>
#include <cmath>

namespace vcg::fcd {

MirrorPlane PlaneOf(const MirrorPairs &pairs, const std::vector<double> &weight, bool &isUnique) {
    // With c on the plane, the squared distance of p's mirror image from q is |p - q|^2 + 4 (n (p - c)) (n (q - c)).
    // The sum is least if c is the mean of the pairs' middles.
    double sum = 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    const auto weightOf = [&](std::size_t i) { return weight.empty() ? 1 : weight[i]; };
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        sum += weightOf(i);
        middle += 0.5 * weightOf(i) * (pairs[i].first + pairs[i].second);
    }
    MirrorPlane plane;
    isUnique = false;
    if (!(sum > 0))
        return plane;
    middle /= sum;
    Eigen::Matrix3d product = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Eigen::Vector3d p = pairs[i].first - middle, q = pairs[i].second - middle;
        product += 0.5 * weightOf(i) * (p * q.transpose() + q * p.transpose());
    }
    const detail::SymmetricEigen eigen(product);
    plane.point = middle;
    plane.normal = eigen.Vectors().col(0);
    const double most = eigen.values.cwiseAbs().maxCoeff();
    isUnique = eigen.values[1] - eigen.values[0] > 1e-6 * most; // more than rounding
    return plane;
}

namespace {

// Number of directions that are tried: about 10 degrees apart, so that one is within about 8 degrees of any. Unless a
// shape is round, matching finds the plane from 20 degrees away.
constexpr int directions = 200;
constexpr std::size_t few = 300;  // points that are matched
constexpr std::size_t tried = 10; // least number of planes to match from, and to keep
constexpr int steps = 60;         // of matching at most
constexpr double rest = 1e-5;     // a plane rests if a step turns (radians) and shifts it by less in sum
// Cosines above which two normals are of the same plane: 15 degrees before matching, 5 after it, as much as a shear may
// turn them. Neighbours of a start may come to rest far from it. They are tried, too, if some plane stands out.
constexpr double sameStart = 0.966, sameAtRest = 0.996;
// Planes with up to so many times the misfit of the best one are kept, before and after matching. A bent shape fits
// nowhere well and a round one nearly everywhere, so the best may be so by chance.
constexpr double nearly = 2.5, asGood = 1e-4; // a misfit below asGood, over the diagonal, is as good as none
// A plane stands out if its misfit before matching is less than this, over the median of all. In random points, 0.72 or
// more was seen, in sheared and bent skulls, which are nearly round, 0.53 or less.
constexpr double asAny = 0.65;

struct Mirrored {
    std::vector<double> far;
    MirrorPairs pairs;
    std::vector<NearestPlace::Hint> hint; // from one plane to the next
};

/// Matches the mirror images of points with the nearest ones of the surface. Distances count more (wrongSide) if
/// normals point to opposite sides. \param all out; its hints: in, out
void MatchIn(const MirrorPlane &plane, const std::vector<Eigen::Vector3d> &points,
             const std::vector<Eigen::Vector3d> &normal, const FitTarget &surface, unsigned threads, Mirrored &all) {
    all.far.resize(points.size());
    all.pairs.resize(points.size());
    all.hint.resize(points.size());
    ParallelFor(threads, points.size(), 64, [&](std::size_t first, std::size_t last) {
        for (std::size_t s = first; s < last; ++s) {
            const Eigen::Vector3d p = plane(points[s]);
            const FitTarget::Match match = surface.Nearest(p, all.hint[s]);
            const bool isOther = match.isOriented && match.normal.dot(plane.Turn(normal[s])) < 0;
            all.far[s] = (p - match.point).norm() * (isOther ? wrongSide : 1);
            all.pairs[s] = {points[s], match.point};
        }
    });
}

/// The distance within which four fifths are.
double MostOf(std::vector<double> far) {
    const auto at = far.begin() + std::ptrdiff_t(4 * far.size() / 5);
    std::nth_element(far.begin(), at, far.end());
    return *at;
}

struct Candidate {
    double misfit;
    MirrorPlane plane;
};

Candidate AtRest(MirrorPlane plane, const std::vector<Eigen::Vector3d> &points,
                 const std::vector<Eigen::Vector3d> &normal, const FitTarget &surface, const Progress &progress) {
    Mirrored all;
    MatchIn(plane, points, normal, surface, progress.threads, all);
    for (int step = 0; step < steps; ++step) {
        progress(double(step) / steps, "Looking for the plane");
        const double width = std::max(MostOf(all.far), 1e-9);
        std::vector<double> weight;
        for (double far : all.far) { // Tukey's biweight (Beaton and Tukey 1974)
            const double part = 1 - far * far / (4 * width * width);
            weight.push_back(part > 0 ? part * part : 0);
        }
        bool isUnique;
        MirrorPlane next = PlaneOf(all.pairs, weight, isUnique);
        if (!isUnique)
            break;
        if (next.normal.dot(plane.normal) < 0)
            next.normal = -next.normal;
        const double moved = (next.normal - plane.normal).norm() + std::abs(plane.Above(next.point));
        plane = next;
        MatchIn(plane, points, normal, surface, progress.threads, all);
        if (moved < rest)
            break;
    }
    return {MeanOfMost(all.far), plane};
}

} // namespace

TriedPlanes FindPlanes(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                       const FitTarget &surface, const Progress &progress) {
    Moments spread;
    for (const Eigen::Vector3d &p : points)
        spread.Add(p, 1);
    std::vector<Eigen::Vector3d> direction;
    direction.reserve(std::size_t(directions) + 3);
    const Eigen::Matrix3d axes = spread.Axes();
    for (int d = 0; d < 3; ++d)
        direction.emplace_back(axes.col(d));
    const double turn = detail::pi * (3 - std::sqrt(5.)); // evenly on half a sphere (Fibonacci's lattice)
    for (int i = 0; i < directions; ++i) {
        const double z = (i + 0.5) / directions, r = std::sqrt(1 - z * z);
        direction.emplace_back(r * detail::Cosine(turn * i), r * detail::Sine(turn * i), z);
    }
    const std::vector<Eigen::Vector3d> someOf = Some(points, few), normalOf = Some(normal, few);
    std::vector<Candidate> all;
    Mirrored images;
    for (const Eigen::Vector3d &each : direction) {
        progress(0.3 * double(all.size()) / double(direction.size()), "Looking for the plane");
        const MirrorPlane plane{spread.Middle(), each};
        MatchIn(plane, someOf, normalOf, surface, progress.threads, images);
        all.push_back({MeanOfMost(images.far), plane});
    }
    const auto isBetter = [](const Candidate &a, const Candidate &b) { return a.misfit < b.misfit; };
    std::stable_sort(all.begin(), all.end(), isBetter);
    TriedPlanes found;
    found.standOut = all[0].misfit <= asAny * all[all.size() / 2].misfit;
    const auto isAmong = [](const std::vector<Candidate> &list, const Candidate &a, double same) {
        return std::any_of(list.begin(), list.end(),
                           [&](const Candidate &b) { return std::abs(a.plane.normal.dot(b.plane.normal)) > same; });
    };
    std::vector<Candidate> best, apart; // the latter without neighbours of better ones
    for (const Candidate &each : all) {
        if (apart.size() >= tried && each.misfit > nearly * all[0].misfit)
            break;
        const bool isApart = !isAmong(apart, each, sameStart);
        if (isApart)
            apart.push_back(each);
        if (isApart || found.standOut)
            best.push_back(each);
    }
    ParallelTasks(progress.Slice(0.3, 1), "Looking for the plane", best.size(),
                  [&](std::size_t i, const Progress &share) {
                      best[i] = AtRest(best[i].plane, someOf, normalOf, surface, share);
                  });
    std::stable_sort(best.begin(), best.end(), isBetter);
    const std::size_t least = best[0].misfit > asGood ? tried : 1;
    std::vector<Candidate> kept; // several starts may come to rest in one plane
    for (const Candidate &each : best)
        if ((kept.size() < least || each.misfit <= nearly * std::max(best[0].misfit, asGood)) &&
            !isAmong(kept, each, sameAtRest)) {
            kept.push_back(each);
            found.planes.push_back(each.plane);
        }
    return found;
}

} // namespace vcg::fcd
