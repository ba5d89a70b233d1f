// SPDX-License-Identifier: GPL-3.0-or-later
// What follows when a fit has arrived: a second one if it is bent far, and the stiffness, by the noise of its target,
// and in gaps, where it has no target.
#include <vcg_ext/fit/fit_gaps.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fitter_run.h>

#include <algorithm>
#include <cmath>

namespace vcg::fcd {

namespace {

// A surface that bends by more than this (rms, of the diagonal) is fitted twice. The pairs of the training half of
// tests/fit_recipes.py bend by 0.055 at most, and gain little by it. Of eleven long shapes, bent by 75 to 120 degrees,
// which bend by 0.07 to 0.24, ten come nearer by it, by up to 70 %.
constexpr double bentFar = 0.06;
// A fit that follows the target's noise, and may therefore not come to rest, is made stiffer: by the factor `stiffer`,
// up to stifferTimes, in stifferSteps each. This goes on until the correlation of the distances is noiseLeft of what it
// was, the distances grow by more than mostNoise (Morozov's discrepancy principle), or more than comesOff of the
// samples come off the target. Chosen on 32 shapes made by formula, smooth, with relief, open and halved; stifferTimes
// on 11 pairs of scans of the training half, where twice as often made no difference. Nodes that move by more than the
// noise had followed the shape (a limb's tip, a slide along the target), and stay soft. This rule fails if the noise is
// above strongNoise (of the diagonal): such noise moves the surface by more than itself. (The scans had 0.0007 at most,
// a shape made by formula with strong noise 0.0016.)
constexpr double stiffer = 3, noiseLeft = 0.6, mostNoise = 1.07, comesOff = 0.0005;
constexpr int stifferTimes = 4, stifferSteps = 6;
constexpr double strongNoise = 0.001;
// A gap gets as stiff as the surface around it allows: the distance of that surface from the target may grow by
// mostMisfit (Morozov's discrepancy principle). The surface may not move farther than this distance: then it slides
// along the target.
constexpr double mostMisfit = 1.2;
constexpr int gapSteps = 6;

} // namespace

/// Whether the surface is bent far, so that it slid along the target on its way.
bool Fitter::Run::IsBentFar() const {
    const Eigen::Affine3d most = MotionOfMost(start.position, graph.position, 1);
    const Eigen::Matrix3Xd bent = (most.linear() * start.position).colwise() + most.translation() - graph.position;
    return std::sqrt(bent.colwise().squaredNorm().mean()) > bentFar;
}

/// Fits a surface that is bent far a second time, from where it lies: so it comes nearer to where it belongs.
void Fitter::Run::FitAgain(const Progress &progress) {
    if (isAlone || !IsBentFar())
        return;
    MatchAnew(report.bothWays);
    Soften(progress);
}

/// How far the samples of each node are from \p before, rms, frame units. \param before position of each sample
std::vector<double> Fitter::Run::MovedFrom(const std::vector<Eigen::Vector3d> &before) const {
    std::vector<double> squares(isFree.size(), 0), weight = squares;
    for (std::size_t s = 0; s < matched; ++s) {
        const double square = (samples.At(s, graph) - before[s]).squaredNorm();
        for (std::uint32_t t = samples.begin[s]; t < samples.begin[s + 1]; ++t) {
            const FitSamples::Term &term = samples.term[t];
            squares[std::size_t(term.node)] += term.weight * square;
            weight[std::size_t(term.node)] += term.weight;
        }
    }
    for (std::size_t j = 0; j < squares.size(); ++j)
        squares[j] = std::sqrt(squares[j] / std::max(weight[j], 1e-300));
    return squares;
}

/// Adds the nodes that moved by more than \p noise, and their neighbours, to those that stay soft.
/// \param before position of each sample \param stays in, out: flags of the graph's nodes \return whether any is new
bool Fitter::Run::MoreStay(const std::vector<Eigen::Vector3d> &before, double noise, std::vector<char> &stays) const {
    const std::vector<double> moved = MovedFrom(before);
    bool isAnyNew = false;
    const auto stay = [&](Index node) {
        isAnyNew = isAnyNew || !stays[node];
        stays[node] = 1;
    };
    for (Index j = 0; j < region.graph.Size(); ++j)
        if (moved[j] > noise) {
            stay(j);
            for (Index beside : region.graph.graph.adjacency[j])
                stay(beside);
        }
    return isAnyNew;
}

/// Makes a fit that follows the target's noise stiffer. \return the stiffness of each node
std::vector<double> Fitter::Run::Settle(const Progress &progress) {
    std::vector<double> end = AllOf(SoftEnd());
    // As onto its mirror image: it is not noise that keeps it from rest.
    const bool isLost = !report.converged && matches->IsInsideOut();
    const double alike = isAlone || isLost ? 0 : matches->Alike();
    if (!(alike < 0))
        return end;
    const FitReport before = report;
    const std::size_t on = fitter.CountOn(*matches, before);
    const double noise = matches->Noise();
    const std::vector<Eigen::Vector3d> arrived = samples.Places(matched, graph);
    std::vector<char> stays(isFree.size(), 0);
    for (int k = 0; k < stifferTimes; ++k) {
        const GraphPose softer = graph;
        std::vector<double> stiffness;
        double moved = 0;
        do {
            progress(0.9, "Fitting");
            stiffness = end;
            for (std::size_t j = 0; j < stiffness.size(); ++j)
                stiffness[j] *= stays[j] ? 1 : stiffer;
            moved = 1;
            for (int step = 0; step < stifferSteps && moved > rest / 3; ++step)
                moved = Step(1, stiffness);
        } while (noise < strongNoise && MoreStay(arrived, noise, stays)); // again, with these soft
        Find(1);
        fitter.Measure(*matches, report);
        if (matches->Alike() > noiseLeft * alike || report.rms > mostNoise * before.rms ||
            double(fitter.CountOn(*matches, before)) < (1 - comesOff) * double(on)) {
            graph = softer;
            Find(1);
            break;
        }
        end = stiffness;
        report.converged = report.converged || moved <= rest;
    }
    return end;
}

/// Makes gaps as stiff as the surface around them allows. \param end the stiffness of each node elsewhere
void Fitter::Run::StiffenGaps(const std::vector<double> &end, const Progress &progress) {
    const double least = end.empty() ? stiffest : *std::min_element(end.begin(), end.end()); // empty: a single point
    const FitGaps gaps(region, *matches, samples);
    const double bearable = std::max(mostMisfit * gaps.Misfit(*matches), FitMatches::least);
    const GraphPose without = graph;
    const std::vector<Eigen::Vector3d> arrived = samples.Places(matched, graph);
    const bool isTorn = !report.contradicted.empty(); // the surface moves in any case
    bool isStiff = !gaps.Any();
    for (double stiff = stiffest; !isStiff; stiff /= 10) {
        graph = without;
        if (stiff > 2 * least) { // otherwise the gap stays soft
            const std::vector<double> stiffness = gaps.Stiffness(end, stiff);
            for (int step = 0; step < gapSteps && Step(1, stiffness) > rest / 10; ++step)
                progress(0.95, "Fitting");
        }
        Find(1);
        isStiff = stiff <= 2 * least || (gaps.Misfit(*matches) <= bearable &&
                                         (isTorn || gaps.Moved(arrived, samples.Places(matched, graph)) <= bearable));
    }
    fitter.Measure(*matches, report);
}

} // namespace vcg::fcd
