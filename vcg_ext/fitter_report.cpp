// SPDX-License-Identifier: GPL-3.0-or-later
// The quality of a fit: distances from the target, and the share that has a counterpart.
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/quantiles.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_guess.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>

namespace vcg::fcd {

/// Whether sample \p s lies on the target.
bool Fitter::IsOn(const FitMatches &matches, std::size_t s, const FitReport &report) const {
    return matches.Counts(s) &&
           report.LiesOn(matches.Distance(s) * deformer->Whole().surface.frame.scale, matches.OnBorder(s));
}

void Fitter::MeasureGuess(const FitMatches &matches, const FitSamples &drawn, const std::vector<char> &isFree,
                          const std::vector<char> &leads, const GraphPose &graph, FitReport &report) const {
    const RegionDeformer &region = deformer->Whole();
    const double scale = region.surface.frame.scale;
    std::vector<double> moved;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        if (IsOn(matches, s, report))
            moved.push_back(
                (drawn.At(s, graph) - region.surface.graph.position.col(drawn.surfaceNode[s]).cast<double>()).norm() *
                scale);
    report.moved = Quantile(moved, 0.5);
    report.movedMost = Quantile(moved, 1);
    const auto isKnown = [&](std::size_t s) {
        return s < matches.Size() ? IsOn(matches, s, report) : leads[s - matches.Size()] != 0;
    };
    const double counts = report.counted * region.surface.area,
                 density = counts > 0 && !FollowsAlone() ? double(matches.Size()) / counts : 0;
    const FitGuess guess = Guess(region, drawn, isKnown, isFree, density, graph);
    report.guessed = guess.share;
    report.guessError = guess.rms * scale;
}

/// The number of samples that lie on the target, by the report of another fit to it.
std::size_t Fitter::CountOn(const FitMatches &matches, const FitReport &report) const {
    std::size_t on = 0;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        on += IsOn(matches, s, report);
    return on;
}

/// The share of the free surface with a weight above 0.
double Fitter::CountedShare() const {
    const RegionDeformer &region = deformer->Whole();
    double all = 0, counts = 0;
    for (std::size_t u = 0; u < nodeWeight.size(); ++u)
        if (region.held.tag[u] == 1) {
            all += double(region.surface.nodeArea[u]);
            counts += nodeWeight[u] > 0 ? double(region.surface.nodeArea[u]) : 0;
        }
    return all > 0 ? counts / all : 1;
}

void Fitter::Measure(const FitMatches &matches, FitReport &report) const {
    const double scale = deformer->Whole().surface.frame.scale;
    std::vector<double> distance, near;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        distance.push_back(matches.Distance(s));
    // The nearest fifth lies on the target if that covers a fifth of the source, and tells its noise: for the noise of
    // a plane, 12 times the 20th percentile of the distances is three times the standard deviation.
    const double noise = std::max(12 * Quantile(distance, 0.2), 1e-3);
    double squares = 0;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        if (matches.Counts(s) && distance[s] <= noise) {
            near.push_back(distance[s] * scale);
            squares += distance[s] * distance[s];
        }
    report.rms = near.empty() ? 0 : std::sqrt(squares / double(near.size())) * scale;
    report.median = Quantile(near, 0.5);
    report.percentile95 = Quantile(near, 0.95);
    report.nearest = std::max(report.percentile95, 1e-4 * scale);
    std::size_t matched = 0;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        matched += IsOn(matches, s, report);
    report.matched = double(matched) / double(std::max<std::size_t>(distance.size(), 1));
}

namespace {

// If more than this share of the surface has no counterpart, the rest may not tell the scale: half of a smooth tube, or
// of a potato, lies as near to its target (0.019 to 0.020 % of the diagonal) at 0.94 to 1.06 times its true scale.
constexpr double aPart = 0.05;

std::string Rounded(double value) {
    std::ostringstream stream;
    stream.precision(3);
    stream << value;
    return stream.str();
}

} // namespace

std::vector<std::string> FitReport::Remarks() const {
    std::vector<std::string> remarks = LandmarkRemarks();
    for (std::string &remark : TargetRemarks())
        remarks.push_back(std::move(remark));
    return remarks;
}

std::vector<std::string> FitReport::LandmarkRemarks() const {
    std::vector<std::string> remarks;
    if (!contradicted.empty()) {
        std::string names;
        for (std::size_t i = 0; i < contradicted.size(); ++i)
            names += (i == 0 ? "" : i + 1 < contradicted.size() ? ", " : " and ") + std::to_string(contradicted[i]);
        const bool isOne = contradicted.size() == 1;
        remarks.push_back(std::string(isOne ? "Pair " : "Pairs ") + names + " of the landmarks, counted from 0, " +
                          (isOne ? "does" : "do") + " not go with the others" +
                          (leftOut ? std::string(" and ") + (isOne ? "was" : "were") + " left out. Look whether "
                                   : ", and the surface is torn between them. Look whether ") +
                          (isOne ? "it is" : "they are") + " mixed up or mistyped" +
                          (leftOut ? "." : "; with a landmark_tolerance, such pairs are left out."));
    }
    if (unmet > 0)
        remarks.push_back(std::to_string(unmet) + (unmet == 1 ? " landmark is" : " landmarks are") +
                          " not met, the worst by " + Rounded(beyond) +
                          ": the graph is too coarse for them. Begin with " + std::to_string(patchesForAll) +
                          " patches or more.");
    return remarks;
}

std::vector<std::string> FitReport::TargetRemarks() const {
    std::vector<std::string> remarks;
    if (otherSize)
        remarks.push_back("The target is " + Rounded(larger >= 1 ? larger : 1 / larger) + " times " +
                          (larger >= 1 ? "larger" : "smaller") +
                          " than the surface. If the two have other units, scale one of them first; if not, give "
                          "landmarks, and start from these with a scale.");
    if (isApart)
        remarks.push_back("Surface and target do not overlap: they are " + Rounded(apart) +
                          " apart. Move one onto the other first.");
    if (fromAfar)
        remarks.push_back(
            "Surface and target did not overlap: they were " + Rounded(apart) +
            " apart, so the fit first moved the surface onto the target's middle" +
            (isSureFromAfar
                 ? "."
                 : ", but it may be turned the wrong way. Look at it; if it is, give landmarks and start from these."));
    // A bent surface seems turned by some degrees if it is only scaled.
    const bool isTurned = turnedBy > 0.1, isScaled = std::abs(scaledBy - 1) > 1e-6; // more than rounding
    if (isTurned || isScaled)
        remarks.push_back("The fit first moved the surface onto the target" +
                          (isTurned ? ", turned by " + Rounded(turnedBy * 180 / detail::pi) + " degrees" : "") +
                          (isScaled ? ", scaled by " + Rounded(scaledBy) : "") + ", which strains it far less." +
                          (isScaled && guessed > aPart ? " The scale is a guess: " + Rounded(100 * guessed) +
                                                             " percent of the surface has no counterpart."
                                                       : "") +
                          " Look at it; if that is wrong, give landmarks and start from these.");
    if (endsLed > 0)
        remarks.push_back("The ends of " + std::to_string(endsLed) +
                          " limbs led the fit at first: without this, some came to lie where others belong. Look at "
                          "it; if one lies wrong, give landmarks.");
    if (strained > 0)
        remarks.push_back("The fit stretches and presses the surface by " + Rounded(100 * strained) +
                          " percent (rms) to lie on the target. Look at it: the two may be turned against each other. "
                          "If they are, turn one of them, or give landmarks and start from these.");
    if (mirrored)
        remarks.emplace_back("The target looks like the mirror image of the surface. If it is, mirror one of the two "
                             "first: negate one coordinate, and turn its faces over.");
    if (flat)
        remarks.emplace_back("The target is flat: the fit has pressed all matched parts into one plane. Check that it "
                             "is the right target.");
    return remarks;
}

bool Fitter::CountsAt(std::size_t slot, const FitReport &report) const {
    const Index u = deformer->nodeOf[slot];
    const auto patch = [&] { return deformer->Whole().patches.patchOf[u]; };
    return u < 0 || ((nodeWeight.empty() || nodeWeight[u] > 0) &&
                     (report.carriedNode.empty() || patch() < 0 || !report.carriedNode[std::size_t(patch())]));
}

void Fitter::Compare(const FitTarget &target, const FitReport &report, const PositionsRef &position,
                     std::vector<float> &distance, std::vector<char> &liesOn, const Progress &progress) const {
    const Frame &frame = deformer->Whole().surface.frame;
    distance.assign(source.vertexSlots, 0.f);
    liesOn.assign(source.vertexSlots, 0);
    ParallelFor(progress, "Measuring the distance", source.vertexSlots, 1 << 12,
                [&](std::size_t first, std::size_t last) {
                    NearestPlace::Hint hint; // the next vertex is mostly near the last one
                    for (std::size_t i = first; i < last; ++i) {
                        if (source.IsDeleted(i))
                            continue;
                        const Eigen::Vector3d p = frame.ToFrame(Eigen::Vector3d(position.col(Eigen::Index(i))));
                        const FitTarget::Match match = target.Nearest(p, hint);
                        const double far = (p - match.point).norm() * frame.scale;
                        distance[i] = float(far);
                        liesOn[i] = report.LiesOn(far, match.onBorder) && far <= param.largestDistance &&
                                    match.weight > 0 && CountsAt(i, report);
                    }
                });
}

} // namespace vcg::fcd
