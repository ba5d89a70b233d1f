// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/symmetric_eigen.h>
#include <vcg_ext/symmetry/mirror_plane.h>
#include <vcg_ext/warp/smooth_warp.h>

#include <algorithm>
#include <cmath>
#include <utility>

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
// For each direction, matching begins with so many shifts of its plane. If a third of one side is missing, the middle
// lies 5 to 10 % of the diagonal beside the plane, and there nothing tells the right direction from others. Four shifts
// left too much.
constexpr int shifts = 8;
constexpr int steps = 60;     // of matching at most
constexpr double rest = 1e-5; // a plane rests if a step turns (radians) and shifts it by less in sum
// Cosines above which two normals are of the same plane: 15 degrees before matching, 5 after it, as much as a shear may
// turn them. Neighbours of a start may come to rest far from it. They are tried, too, if some plane stands out.
constexpr double sameStart = 0.966, sameAtRest = 0.996;
// Planes with up to so many times the misfit of the best one are kept, before and after matching. A bent shape fits
// nowhere well and a round one nearly everywhere, so the best may be so by chance.
constexpr double nearly = 2.5, asGood = 1e-4; // a misfit below asGood, over the diagonal, is as good as none
// A plane stands out if its misfit before matching is less than this, over the median of all. In random points, 0.72 or
// more was seen, in sheared and bent skulls, which are nearly round, 0.53 or less.
constexpr double asAny = 0.65;

struct Candidate {
    double misfit;
    MirrorPlane plane;
};

/// A plane, while the mirror images of points in it are matched with the nearest points of the surface. A match on a
/// border of triangles is no counterpart: there the surface ends.
class Matching {
  public:
    Matching(const MirrorPlane &plane, const std::vector<Eigen::Vector3d> &points,
             const std::vector<Eigen::Vector3d> &normal, const FitTarget &surface, unsigned threads)
        : plane(plane), points(points), normal(normal), surface(surface), threads(threads), far(points.size()),
          share(points.size()), pairs(points.size()), hint(points.size()) {
        Match();
    }

    /// Moves the plane along its normal only, or freely. \return how far it turned (radians) and shifted, in sum
    double Step(bool isAlong) {
        const std::vector<double> weight = Weights();
        bool isUnique;
        MirrorPlane next = PlaneOf(pairs, weight, isUnique);
        if (isAlong)
            next.normal = plane.normal;
        else if (!isUnique)
            return 0;
        if (next.normal.dot(plane.normal) < 0)
            next.normal = -next.normal;
        const double moved = (next.normal - plane.normal).norm() + std::abs(plane.Above(next.point));
        plane = std::move(next);
        Match();
        return moved;
    }

    Candidate Result() const { return {MisfitOf(far, share), plane}; }

  private:
    /// Distances count more (wrongSide) if normals point to opposite sides.
    void Match() {
        ParallelForEach(threads, points.size(), 64, [&](std::size_t s) {
            const Eigen::Vector3d p = plane(points[s]);
            // Far from the right plane, too much of a cloud with limbs would seem to have no counterpart.
            const FitTarget::Match match = surface.Nearest(p, hint[s], !surface.IsCloud());
            const bool isOther = match.isOriented && match.normal.dot(plane.Turn(normal[s])) < 0;
            const Eigen::Vector3d foot = match.Foot(p);
            far[s] = (p - foot).norm() * (isOther ? wrongSide : 1);
            share[s] = match.onBorder ? 0 : 1;
            pairs[s] = {points[s], foot};
        });
    }

    /// Tukey's biweight (Beaton and Tukey 1974): 0 beyond twice the distance within which four fifths are.
    std::vector<double> Weights() const {
        std::vector<double> found = WithCounterpart(far, share), weight;
        const bool isSome = found.size() < far.size();
        const auto at = found.begin() + std::ptrdiff_t(4 * found.size() / 5);
        std::nth_element(found.begin(), at, found.end());
        const double width = 2 * std::max(*at, 1e-9);
        for (std::size_t s = 0; s < far.size(); ++s)
            weight.push_back(
                far[s] < width && (share[s] > 0 || !isSome) ? detail::Squared(1 - detail::Squared(far[s] / width)) : 0);
        return weight;
    }

    MirrorPlane plane;
    const std::vector<Eigen::Vector3d> &points, &normal;
    const FitTarget &surface;
    const unsigned threads;
    std::vector<double> far, share; // distances of matches; 0 for those on a border, else 1
    MirrorPairs pairs;
    std::vector<NearestPlace::Hint> hint; // from one plane to the next
};

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
    for (const Eigen::Vector3d &each : direction) {
        progress(0.3 * double(all.size()) / double(direction.size()), "Looking for the plane");
        Matching matching({spread.Middle(), each}, someOf, normalOf, surface, progress.threads);
        for (int shift = 0; shift < shifts; ++shift)
            matching.Step(true);
        all.push_back(matching.Result());
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
                      Matching matching(best[i].plane, someOf, normalOf, surface, share.threads);
                      double moved = 1;
                      for (int step = 0; step < steps && moved >= rest; ++step) {
                          share(double(step) / steps, "Looking for the plane");
                          moved = matching.Step(false);
                      }
                      best[i] = matching.Result();
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
