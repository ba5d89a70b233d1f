// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/parallel.h>
#include <vcg_ext/base/quantiles.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_turns.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace vcg::fcd {

namespace {

// So many points of each surface are looked at, in so many rounds from each start, and in more from the best ones.
constexpr std::size_t looked = 150, bestAlignments = 12;
constexpr int firstRounds = 8, moreRounds = 20;
// A pair draws along the plane by this share of how it draws across it.
constexpr double along = 0.05;
// The share of a surface that tells how well it lies. Of 24 pairs whose surface and target each lacked another quarter,
// 22 were among the best three with two thirds, 18 with four fifths.
constexpr double told = 2.0 / 3;
// Starts are also shifted along the target by so many standard deviations of its points: the middle of a part that
// lacks a quarter to four tenths of an even bar lies 0.4 to 0.7 of them from the middle of the bar.
constexpr double shifted = 0.7;
// Two alignments are the same if one is turned by less than 30 degrees against the other.
constexpr double sameTurn = 0.8660254037844387;

/// The 60 rotations of an icosahedron: those of a tetrahedron, after none to four turns by 72 degrees. None is farther
/// than 45 degrees from the nearest of them.
std::vector<Eigen::Matrix3d> Icosahedral() {
    constexpr double golden = 1.618033988749895;
    const Eigen::Matrix3d fifth = detail::ToMatrix(Eigen::Vector4d(golden, 1, 1 / golden, 0) / 2);
    std::vector<Eigen::Matrix3d> all;
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    for (int k = 0; k < 5; ++k, turn = fifth * turn)
        for (int cycle = 0; cycle < 3; ++cycle)
            for (int half = 0; half < 4; ++half) { // none, or by 180 degrees about an axis
                Eigen::Matrix3d each = Eigen::Matrix3d::Zero();
                for (int d = 0; d < 3; ++d)
                    each((d + cycle) % 3, d) = half == 0 || half == d + 1 ? 1 : -1;
                all.emplace_back(turn * each);
            }
    return all;
}

} // namespace

FitTurns::Side FitTurns::Prepared(std::vector<Eigen::Vector3d> place) {
    Side side;
    side.stride = 1 + (std::max<std::size_t>(place.size(), 1) - 1) / looked;
    side.place = std::move(place);
    side.middle.setZero();
    for (const Eigen::Vector3d &p : side.place)
        side.middle += p / double(side.place.size());
    if (!side.place.empty())
        side.tree = std::make_unique<PointTree<double>>(side.place);
    return side;
}

FitTurns::FitTurns(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                   const FitTarget &onto)
    : source(Prepared(points)), mainAxis(onto.Spread().Longest()) {
    source.normal = normal;
    source.normal.resize(points.size(), Eigen::Vector3d::Zero());
    source.isOriented.assign(points.size(), 1);
    std::vector<Eigen::Vector3d> place, normalThere;
    std::vector<char> isOriented;
    for (const FitTarget::Match &match : onto.Places(points.size())) {
        place.push_back(match.point);
        normalThere.push_back(match.normal);
        isOriented.push_back(match.isOriented);
    }
    target = Prepared(std::move(place));
    target.normal = std::move(normalThere);
    target.isOriented = std::move(isOriented);
}

/// The mean distance of the nearest points of one side from the other, in units of \p to. The normals of the two are
/// tried as they are and flipped.
double FitTurns::MeanFar(const Side &from, const Side &to, const Eigen::Affine3d &motion, double scale) {
    std::vector<double> asTheyAre, flipped;
    for (std::size_t i = 0; i < from.place.size(); i += from.stride) {
        double far = 0;
        const Index j = to.tree->Nearest(motion * from.place[i], &far);
        const double cosine =
            from.isOriented[i] && to.isOriented[j] ? to.normal[j].dot(motion.linear() * from.normal[i]) / scale : 0;
        asTheyAre.push_back(far * (cosine < 0 ? wrongSide : 1));
        flipped.push_back(far * (cosine > 0 ? wrongSide : 1));
    }
    return std::min(MeanOfSmallest(std::move(asTheyAre), told), MeanOfSmallest(std::move(flipped), told));
}

double FitTurns::Misfit(const Eigen::Affine3d &motion, double scale) const {
    if (!source.tree || !target.tree)
        return 0;
    return std::min(MeanFar(source, target, motion, scale),
                    scale * MeanFar(target, source, motion.inverse(), 1 / scale));
}

/// Moves the surface nearer to the target, by planes through pairs of nearest points. Pairs count by the weights of
/// Geman and McClure, as wide as the median distance of that side that lies on the other.
Alignment FitTurns::Nearer(Alignment alignment, double scale, int rounds) const {
    const std::size_t sourceCount = source.Count(), count = sourceCount + target.Count();
    std::vector<Eigen::Vector3d> from(count), to(count), n(count);
    std::vector<double> cosine(count), distance(count);
    for (int round = 0; round < rounds; ++round) {
        const Eigen::Affine3d back = alignment.motion.inverse();
        for (std::size_t k = 0; k < count; ++k) {
            const bool isSource = k < sourceCount;
            const Eigen::Vector3d p =
                isSource ? source.place[k * source.stride] : target.place[(k - sourceCount) * target.stride];
            const std::size_t i = isSource ? k * source.stride : std::size_t(source.tree->Nearest(back * p)),
                              j = isSource ? std::size_t(target.tree->Nearest(alignment.motion * p))
                                           : (k - sourceCount) * target.stride;
            from[k] = alignment.motion * source.place[i];
            to[k] = target.place[j];
            n[k] = target.normal[j];
            distance[k] = (from[k] - to[k]).norm();
            cosine[k] = target.isOriented[j] ? n[k].dot(alignment.motion.linear() * source.normal[i]) / scale : 0;
        }
        const auto half = distance.begin() + std::ptrdiff_t(sourceCount);
        const double width = std::max(
                         {std::min(Quantile({distance.begin(), half}, 0.5), Quantile({half, distance.end()}, 0.5)),
                          FitMatches::least}),
                     side = SideOfNearest(distance, cosine);
        Eigen::Matrix<double, 6, 6> form = Eigen::Matrix<double, 6, 6>::Zero();
        Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
        const Eigen::Vector3d middle = alignment.motion * source.middle;
        for (std::size_t k = 0; k < count; ++k) {
            if (side * cosine[k] < 0)
                continue;
            const double weight = 1 / detail::Squared(1 + detail::Squared(distance[k] / width));
            const Eigen::Vector3d lever = from[k] - middle;
            Eigen::Matrix<double, 3, 6> move; // by a small turn, and a shift
            move << 0, lever[2], -lever[1], 1, 0, 0, -lever[2], 0, lever[0], 0, 1, 0, lever[1], -lever[0], 0, 0, 0, 1;
            const Eigen::Matrix3d across =
                weight * (n[k] * n[k].transpose() + (n[k].isZero(0) ? 1 : along) * Eigen::Matrix3d::Identity());
            form += move.transpose() * across * move;
            gradient += move.transpose() * across * (to[k] - from[k]);
        }
        form.diagonal().array() += 1e-12 * (form.trace() + 1e-300);
        const Eigen::Matrix<double, 6, 1> step = form.ldlt().solve(gradient);
        const Eigen::Matrix3d turn =
            detail::ToMatrix(Eigen::Vector4d(1, step[0] / 2, step[1] / 2, step[2] / 2).normalized());
        alignment.motion =
            Eigen::Translation3d(middle + step.tail<3>()) * turn * Eigen::Translation3d(-middle) * alignment.motion;
    }
    alignment.misfit = Misfit(alignment.motion, scale);
    return alignment;
}

std::vector<Alignment> FitTurns::Best(double scale, std::vector<Eigen::Affine3d> start, unsigned threads) const {
    if (!source.tree || !target.tree)
        return {};
    for (const Eigen::Matrix3d &turn : Icosahedral())
        for (const double shift : {0.0, -shifted, shifted})
            start.push_back(Eigen::Translation3d(target.middle + shift * mainAxis) * turn *
                            Eigen::Translation3d(-source.middle));
    std::vector<Alignment> alignments(start.size());
    const auto nearer = [&](int rounds) {
        ParallelForEach(threads, alignments.size(), 4,
                        [&](std::size_t k) { alignments[k] = Nearer(alignments[k], scale, rounds); });
        std::stable_sort(alignments.begin(), alignments.end(),
                         [](const Alignment &a, const Alignment &b) { return a.misfit < b.misfit; });
    };
    for (std::size_t k = 0; k < start.size(); ++k) {
        alignments[k].motion = start[k];
        alignments[k].motion.linear() *= scale;
        alignments[k].motion.translation() = start[k] * source.middle - alignments[k].motion.linear() * source.middle;
    }
    nearer(firstRounds);
    alignments.resize(std::min(alignments.size(), bestAlignments));
    nearer(moreRounds);
    std::vector<Alignment> unlike;
    for (const Alignment &alignment : alignments)
        if (std::none_of(unlike.begin(), unlike.end(), [&](const Alignment &other) {
                return ((other.motion.linear().transpose() * alignment.motion.linear()).trace() / (scale * scale) - 1) /
                           2 >
                       sameTurn;
            }))
            unlike.push_back(alignment);
    return unlike;
}

} // namespace vcg::fcd
