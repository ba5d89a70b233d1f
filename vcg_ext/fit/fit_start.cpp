// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/error.h>
#include <vcg_ext/base/parallel.h>
#include <vcg_ext/base/quantiles.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_turns.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD> // umeyama needs it
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace vcg::fcd {

double AcrossALine(const std::vector<Eigen::Vector3d> &points) {
    if (points.size() < 3)
        return 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d &p : points)
        middle += p / double(points.size());
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (const Eigen::Vector3d &p : points)
        second += (p - middle) * (p - middle).transpose();
    const Eigen::Vector3d squared = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvalues();
    return squared[2] > 0 ? std::sqrt(std::max(squared[1], 0.0) / squared[2]) : 0;
}

Eigen::Affine3d StartFromLandmarks(const std::vector<Eigen::Vector3d> &from, const std::vector<Eigen::Vector3d> &to,
                                   bool similar) {
    Eigen::Matrix3Xd a(3, Eigen::Index(from.size())), b(3, a.cols());
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
        a.col(i) = from[i];
        b.col(i) = to[i];
    }
    if (std::min(AcrossALine(from), AcrossALine(to)) > 1e-6) // more than rounding
        return Eigen::Affine3d(Eigen::umeyama(a, b, similar));
    throw BadInput("A start from landmarks needs three of them that are not on a line, better four or more. Give more "
                   "landmarks, or start from where the layers lie.");
}

namespace {

// The misfit of a rotation, over that of none or of the second-best one, below which it is surely better: half of the
// distance of two surfaces after a start is how they are bent.
constexpr double better = 0.8;
// The misfit of a mirror image over that of the best rotation, below which the target is mirrored.
constexpr double farBetter = 0.5;
// Of the diagonal: below this misfit, a shape is its own mirror image, and lies the right way round.
constexpr double apart = 0.01;
constexpr std::size_t few = 200;   // points that are enough to tell
constexpr double mostPoints = 0.8; // the share of them whose distances tell: limbs may be bent
// Bending changes the radius by some percent. The fit itself finds smaller differences of size.
constexpr double someSize = 0.1;
constexpr int mostRounds = 30; // of MotionOfMost: a limb that is turned by 90 degrees takes twenty
// The best alignments are tried, as a bend changes the distances: those whose misfit is less than asNear times the
// least. (It was .008 and .010 for a bent head the right and a wrong way round, .005 and .02 for a body with limbs.)
constexpr std::size_t alignmentsTried = 3;
constexpr double asNear = 1.5;

/// The misfit of moved points: the mean of the nearest four fifths of the distances from the target. Where normals
/// disagree, a distance counts more (wrongSide). The target's normals are tried as they are and flipped.
double Misfit(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
              const Eigen::Affine3d &motion, const FitTarget &target, unsigned threads) {
    std::vector<double> far[2];
    for (std::vector<double> &each : far)
        each.resize(points.size());
    ParallelForEach(threads, points.size(), 64, [&](std::size_t s) {
        const Eigen::Vector3d p = motion * points[s];
        const FitTarget::Match match = target.Nearest(p);
        const double cosine = normal.empty() ? 0 : match.normal.dot(motion.linear() * normal[s]);
        for (int side = 0; side < 2; ++side)
            far[side][s] =
                (p - match.point).norm() * (match.isOriented && (side == 0 ? cosine < 0 : cosine > 0) ? wrongSide : 1);
    });
    return std::min(MeanOfSmallest(std::move(far[0]), mostPoints), MeanOfSmallest(std::move(far[1]), mostPoints));
}

Moments MomentsOf(const std::vector<Eigen::Vector3d> &points) {
    Moments moments;
    for (const Eigen::Vector3d &p : points)
        moments.Add(p, 1);
    return moments;
}

/// The 24 rigid motions that take middle and axes of points onto those of the target, or the 24 mirrored ones.
std::vector<Eigen::Affine3d> OntoAxes(const std::vector<Eigen::Vector3d> &points, const FitTarget &target,
                                      bool mirrored) {
    const Moments own = MomentsOf(points), &onTarget = target.Spread();
    const Eigen::Matrix3d axes = own.Axes(), targetAxes = onTarget.Axes();
    std::vector<Eigen::Affine3d> motions;
    int order[3] = {0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            Eigen::Matrix3d to;
            for (int d = 0; d < 3; ++d)
                to.col(d) = (signs >> d & 1 ? -1 : 1) * targetAxes.col(order[d]);
            const Eigen::Matrix3d turn = to * axes.transpose();
            if ((turn.determinant() < 0) != mirrored)
                continue;
            Eigen::Affine3d motion(turn);
            motion.translation() = onTarget.Middle() - turn * own.Middle();
            motions.push_back(motion);
        }
    } while (std::next_permutation(order, order + 3));
    return motions;
}

} // namespace

Eigen::Affine3d StartFromAxes(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                              const FitTarget &target, unsigned threads) {
    Eigen::Affine3d best = Eigen::Affine3d::Identity();
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::Affine3d &motion : OntoAxes(points, target, false))
        if (const double misfit = Misfit(points, normal, motion, target, threads); misfit < least) {
            least = misfit;
            best = motion;
        }
    return best;
}

Eigen::Affine3d StartFromAfar(const std::vector<Eigen::Vector3d> &points, const std::vector<Eigen::Vector3d> &normal,
                              const FitTarget &target, unsigned threads, bool &isSure) {
    const Eigen::Affine3d shift(Eigen::Translation3d(target.Spread().Middle() - MomentsOf(points).Middle()));
    const double unturned = Misfit(points, normal, shift, target, threads);
    Eigen::Affine3d best = shift;
    double least = unturned, second = std::numeric_limits<double>::infinity();
    for (const Eigen::Affine3d &motion : OntoAxes(points, target, false)) {
        const double misfit = Misfit(points, normal, motion, target, threads);
        second = std::min(second, std::max(misfit, least));
        if (misfit < least) {
            least = misfit;
            best = motion;
        }
    }
    isSure = least > better * unturned || least < better * second;
    return least > better * unturned ? shift : best;
}

std::vector<OtherStart> OtherStarts(const std::vector<Eigen::Vector3d> &points,
                                    const std::vector<Eigen::Vector3d> &normal, const FitTarget &target,
                                    const Eigen::Affine3d &reached, bool isPressed, unsigned threads) {
    const Moments own = MomentsOf(points), &onTarget = target.Spread();
    const double larger = onTarget.Radius() / std::max(own.Radius(), 1e-12);
    const FitTurns turns(points, normal, target);
    const double present = turns.Misfit(reached);
    std::vector<OtherStart> starts;
    if (present <= apart && !isPressed)
        return starts;
    for (const double scale : {1.0, larger}) {
        if (scale != 1 && std::abs(scale - 1) < someSize)
            continue;
        if (scale != 1)
            starts.push_back(
                {Eigen::Translation3d(onTarget.Middle()) * Eigen::Scaling(scale) * Eigen::Translation3d(-own.Middle()),
                 false});
        const std::vector<Alignment> alignments = turns.Best(scale, OntoAxes(points, target, false), threads);
        for (std::size_t k = 0;
             k < alignments.size() && k < alignmentsTried && alignments[k].misfit < asNear * alignments[0].misfit; ++k)
            starts.push_back({alignments[k].motion, alignments[k].misfit < farBetter * present});
        if (!isPressed &&
            std::none_of(starts.begin(), starts.end(), [](const OtherStart &each) { return each.isNearer; }))
            return {};
    }
    return starts;
}

/// Calls body(weight, edge, i, j) for all edges, both ways; the edge as the map of node i takes it, frame units.
template <class Body>
static void ForMovedEdges(const DeformationGraph &graph, const GraphPose &pose, const Body &body) {
    for (Index i = 0; i < graph.Size(); ++i)
        for (std::uint32_t item = graph.graph.adjacency.begin[i];
             item < graph.graph.adjacency.begin[std::size_t(i) + 1]; ++item) {
            const Index j = graph.graph.adjacency.item[item];
            const Eigen::Vector3d edge = (graph.graph.position.col(j) - graph.graph.position.col(i)).cast<double>();
            body(double(graph.weight[item]), Eigen::Vector3d(pose.linear[i] * edge), i, j);
        }
}

/// How much an edge counts by the shares of its ends; fully if there are none.
static double ShareOf(const std::vector<double> &share, Index i, Index j) {
    return share.empty() ? 1 : share[std::size_t(i)] * share[std::size_t(j)];
}

double StrainOf(const RegionDeformer &deformer, const GraphPose &pose, const std::vector<double> &share) {
    double off = 0, all = 0;
    ForMovedEdges(deformer.graph, pose, [&](double weight, const Eigen::Vector3d &edge, Index i, Index j) {
        weight *= ShareOf(share, i, j);
        off += weight * (pose.position.col(i) + edge - pose.position.col(j)).squaredNorm();
        all += weight * edge.squaredNorm();
    });
    return all > 0 ? std::sqrt(off / all) : 0;
}

double GrowthOf(const RegionDeformer &deformer, const GraphPose &pose, const std::vector<double> &share) {
    double along = 0, all = 0;
    ForMovedEdges(deformer.graph, pose, [&](double weight, const Eigen::Vector3d &edge, Index i, Index j) {
        weight *= ShareOf(share, i, j);
        along += weight * edge.dot(pose.position.col(j) - pose.position.col(i));
        all += weight * edge.squaredNorm();
    });
    return along > 0 ? along / all : 1;
}

Eigen::Affine3d MotionOfMost(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to, double scale) {
    Eigen::VectorXd weight = Eigen::VectorXd::Ones(from.cols());
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    for (int round = 0; round < mostRounds; ++round) {
        weight /= weight.sum();
        const Eigen::Vector3d a = from * weight, b = to * weight;
        motion.linear() =
            scale * detail::FitRotation((from.colwise() - a) * weight.asDiagonal() * (to.colwise() - b).transpose());
        motion.translation() = b - motion.linear() * a;
        const Eigen::VectorXd off = ((motion.linear() * from).colwise() + motion.translation() - to).colwise().norm();
        const double half = std::max(Quantile({off.data(), off.data() + off.size()}, 0.5), FitMatches::least);
        weight = (1 + (off / half).array().square()).square().inverse();
    }
    return motion;
}

GraphPose Grown(GraphPose pose, double growth) {
    for (Eigen::Matrix3d &linear : pose.linear)
        linear *= growth;
    return pose;
}

GraphPose Moved(GraphPose pose, const Eigen::Affine3d &motion) {
    for (std::size_t j = 0; j < pose.linear.size(); ++j) {
        pose.position.col(Eigen::Index(j)) = motion * pose.position.col(Eigen::Index(j)).eval();
        pose.linear[j] = motion.linear() * pose.linear[j];
    }
    return pose;
}

double MirrorMisfit(const std::vector<Eigen::Vector3d> &points, const FitTarget &target, unsigned threads) {
    const auto least = [&](const std::vector<Eigen::Vector3d> &from) {
        const std::vector<Alignment> best = FitTurns(from, {}, target).Best(1, OntoAxes(from, target, false), threads);
        return best.empty() ? 0 : best.front().misfit;
    };
    std::vector<Eigen::Vector3d> image = points;
    for (Eigen::Vector3d &p : image)
        p[0] = -p[0];
    return least(image) / std::max(least(points), 1e-12);
}

FitPlacement PlacementOf(const std::vector<Eigen::Vector3d> &points, const FitTarget &target, unsigned threads) {
    FitPlacement placement;
    if (points.empty())
        return placement;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d &p : points)
        box.extend(p);
    placement.apart = box.exteriorDistance(target.Box());
    const Moments own = MomentsOf(points);
    placement.larger = target.Spread().Radius() / std::max(own.Radius(), 1e-12);
    const Eigen::Matrix3d axes = own.Axes();
    Eigen::Vector3d squares = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d &p : points)
        squares += (axes.transpose() * (p - own.Middle())).cwiseAbs2();
    placement.flatness = std::sqrt(squares[0] / std::max(squares[2], 1e-300));

    std::vector<Eigen::Vector3d> some;
    std::vector<double> far;
    for (std::size_t i = 0; i < points.size(); i += 1 + (points.size() - 1) / few) {
        some.push_back(points[i]);
        far.push_back((points[i] - target.Nearest(points[i]).point).norm());
    }
    std::nth_element(far.begin(), far.begin() + std::ptrdiff_t(far.size() / 2), far.end());
    placement.median = far[far.size() / 2];
    const auto least = [&](bool mirrored) {
        double misfit = std::numeric_limits<double>::infinity();
        for (const Eigen::Affine3d &motion : OntoAxes(some, target, mirrored))
            misfit = std::min(misfit, Misfit(some, {}, motion, target, threads));
        return misfit;
    };
    const double turned = std::min(least(false), Misfit(some, {}, Eigen::Affine3d::Identity(), target, threads));
    placement.mirrored =
        turned > apart && least(true) < farBetter * turned && MirrorMisfit(points, target, threads) < farBetter;
    return placement;
}

} // namespace vcg::fcd
