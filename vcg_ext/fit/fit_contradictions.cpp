// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/base/quantiles.h>
#include <vcg_ext/fit/fit_contradictions.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_system.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace vcg::fcd {

namespace {

constexpr double stiffness = 1e-2;            // as at the begin of a fit: contradicting landmarks are hardly followed
constexpr int firstSteps = 12, nextSteps = 4; // until it is at rest: at first, and after one is left out
constexpr std::size_t fewest = 5;             // of fewer, each may lie at an end that has really moved there
constexpr std::size_t looks = 64;             // of many landmarks, the worst and others that are measured: so many each
// A contradiction has at least this times the strain that nine tenths of the followed landmarks stay below. Of right
// landmarks, on tubes, plates and balls that were bent, twisted, rolled and sheared, the worst had 3 times.
constexpr double mostStrain = 4;

/// The surface that follows some of the landmarks.
class Judge {
  public:
    Judge(const RegionDeformer &deformer, const std::vector<char> &isFree, const FitSamples &marks,
          const std::vector<Eigen::Vector3d> &place, double tolerance, double smoothness, GraphPose pose)
        : isIn(place.size(), 1), deformer(deformer), marks(marks), place(place), tolerance(tolerance),
          weight(10 / double(place.size())), pose(std::move(pose)), system(deformer, isFree, marks, smoothness),
          stiff(isFree.size(), stiffness), pull(place.size()) {}

    std::vector<char> isIn; // of each landmark: whether the surface follows it

    double Off(std::size_t l) const { return (marks.At(l, pose) - place[l]).norm(); }

    void Follow(int steps, unsigned threads) {
        for (int step = 0; step < steps; ++step) {
            for (std::size_t l = 0; l < place.size(); ++l) {
                pull[l] = {};
                if (isIn[l]) {
                    pull[l].form = weight * Eigen::Matrix3d::Identity();
                    pull[l].gradient = weight * (marks.At(l, pose) - place[l]);
                }
            }
            FitSystem::Take(system.Step(pose, pull, stiff, threads), pose);
        }
    }

    /// The strain that goes if the surface does not follow this landmark, as a length, frame units.
    double Strain(std::size_t l) {
        const Eigen::Matrix3d one = Eigen::Matrix3d::Identity(), answer = system.Compliance(l);
        const Eigen::Vector3d here = marks.At(l, pose) - place[l];
        const Eigen::Vector3d alone = isIn[l] ? Eigen::Vector3d((one - weight * answer).lu().solve(here)) : here;
        const double off = alone.norm(); // distance of its target from where the others take its vertex
        if (off <= std::max(tolerance, noHand))
            return 0;
        const Eigen::Vector3d beyond = (1 - tolerance / off) * alone;
        const Eigen::Matrix3d free =
            isIn[l] ? Eigen::Matrix3d((one - weight * answer).lu().solve(answer)) : answer; // compliance without it
        const double energy = beyond.dot((free + one / weight).lu().solve(beyond));
        return std::sqrt(std::max(energy, 0.0) * deformer.surface.area / stiffness);
    }

  private:
    const RegionDeformer &deformer;
    const FitSamples &marks;
    const std::vector<Eigen::Vector3d> &place;
    const double tolerance, weight;
    GraphPose pose;
    FitSystem system;
    const std::vector<double> stiff;
    std::vector<FitSystem::Pull> pull;
};

} // namespace

std::vector<Contradiction> Contradictions(const RegionDeformer &deformer, const std::vector<char> &isFree,
                                          const FitSamples &marks, const std::vector<Eigen::Vector3d> &place,
                                          double least, double tolerance, double smoothness, GraphPose pose,
                                          const Progress &progress) {
    const std::size_t n = place.size();
    if (n < fewest)
        return {};
    std::vector<Eigen::Vector3d> rest(n);
    for (std::size_t l = 0; l < n; ++l)
        rest[l] = deformer.surface.graph.position.col(marks.surfaceNode[l]).cast<double>();
    const PointTree<double> tree(rest);
    const double finest = std::sqrt(deformer.surface.area / double(isFree.size())); // mean distance of nodes
    std::vector<double> near(n); // from each landmark to the next one
    for (std::size_t l = 0; l < n; ++l)
        near[l] = std::max(finest, tree.DistanceOf(rest[l], 2));

    Judge judge(deformer, isFree, marks, place, tolerance, smoothness, std::move(pose));
    judge.Follow(firstSteps, progress.threads);
    std::vector<std::size_t> out, order;
    std::vector<double> strain(n);
    double usual = 0; // 90th percentile of the strain of landmarks that are followed
    const auto measure = [&] {
        order.clear();
        for (std::size_t l = 0; l < n; ++l)
            if (judge.isIn[l])
                order.push_back(l);
        std::vector<std::size_t> some;
        for (std::size_t i = 0; i < order.size(); i += 1 + (order.size() - 1) / (2 * looks))
            some.push_back(order[i]);
        std::vector<double> all;
        for (std::size_t l : some) {
            strain[l] = judge.Strain(l) / near[l];
            all.push_back(strain[l]);
        }
        usual = Quantile(all, 0.9);
        if (some.size() < order.size()) {
            std::stable_sort(order.begin(), order.end(),
                             [&](std::size_t a, std::size_t b) { return judge.Off(a) > judge.Off(b); });
            order.resize(looks);
            for (std::size_t l : order)
                strain[l] = judge.Strain(l) / near[l];
        }
        std::stable_sort(order.begin(), order.end(),
                         [&](std::size_t a, std::size_t b) { return strain[a] > strain[b]; });
    };
    const std::size_t most = n / 2, each = 1 + n / (4 * looks);
    for (;;) {
        progress(0, "Comparing the landmarks");
        measure();
        const std::size_t before = out.size();
        for (std::size_t i = 0; i < std::min(each, order.size()) && out.size() < most; ++i)
            if (strain[order[i]] >= least) {
                judge.isIn[order[i]] = 0;
                out.push_back(order[i]);
            }
        if (out.size() == before)
            break;
        judge.Follow(nextSteps, progress.threads);
    }
    std::vector<Contradiction> found;
    std::sort(out.begin(), out.end());
    for (std::size_t l : out)
        if (const double left = judge.Strain(l) / near[l]; left >= std::max(least, mostStrain * usual))
            found.push_back({l, left});
    if (found.size() > n / 3)
        found.clear();
    return found;
}

} // namespace vcg::fcd
