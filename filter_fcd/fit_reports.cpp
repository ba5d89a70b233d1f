// SPDX-License-Identifier: GPL-3.0-or-later
// The report of FCD: Fit to Layer.
#include "filter_reports.h"

#include <layer_fcd/layer_labels.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <sstream>

namespace {

double rmsOf(const std::vector<double> &off) {
    double squares = 0;
    for (double each : off)
        squares += each * each;
    return off.empty() ? 0 : std::sqrt(squares / double(off.size()));
}
double mostOf(const std::vector<double> &off) { return off.empty() ? 0 : *std::max_element(off.begin(), off.end()); }

/// Writes the rms and the largest error. \param what name of the errors
void tell(const std::vector<double> &off, const char *what, std::ostream &line) {
    if (!off.empty())
        line << " " << what << " by " << rmsOf(off) << " (rms), at most by " << mostOf(off) << " (number "
             << std::max_element(off.begin(), off.end()) - off.begin() << " of " << off.size() << ", counted from 0).";
}

} // namespace

std::string describe(const FittedLayers &made) {
    const vcg::fcd::FitReport &report = made.report;
    std::ostringstream line;
    line << describe(made.result.tags) << "; " << made.result.rest.position.cols() << " nodes, " << report.steps
         << " steps.";
    if (!made.landmarksOnly)
        line << " " << 100 * report.matched << " percent have a counterpart, at a distance of " << report.rms
             << " (rms; median " << report.median << ", 95 percent within " << report.percentile95 << ").";
    if (report.matched > 0)
        line << " That came from " << report.moved << " away (median; at most " << report.movedMost << ").";
    if (report.guessed > 0 && !made.landmarksOnly)
        line << " " << 100 * report.guessed
             << " percent have no counterpart; their place is a guess that may be off by about " << report.guessError
             << ".";
    tell(made.check, "Pairs that were kept back are off", line);
    tell(made.leftOut, "Landmarks that are left out in turn are off", line);
    if (report.counted < 1)
        line << " That is of the " << 100 * report.counted << " percent that count; the rest went along.";
    if (report.carried > 0)
        line << " "
             << counted(report.carried, "separate part without a counterpart was",
                        "separate parts without a counterpart were")
             << " carried by the parts around.";
    if (report.bothWays)
        line << " Parts of the target also drew the nearest surface.";
    if (report.notFinite > 0)
        line << " " << report.notFinite << " vertices of the target are not finite and were left out.";
    if (report.insideOut)
        line << " Its normals point to the other side than the target's, which count as flipped.";
    if (made.landmarks > 0)
        line << " None of the " << made.landmarks - (report.leftOut ? report.contradicted.size() : 0)
             << " landmarks is off by more than " << report.landmarks << "; for that, nodes gave way by up to "
             << report.pull << ".";
    if (const std::size_t curves = made.curves.curve.size(); curves > 0)
        line << " " << made.curves.vertices << " vertices lie along the " << counted(curves, "curve", "curves")
             << ", at most " << made.curves.farthest << " away on this layer; on the target, none is off by more than "
             << report.curves << ".";
    line << " " << made.seconds << " s.";
    return line.str();
}

HostFilterPlugin::ReturnedValues valuesOf(const FittedLayers &made) {
    const vcg::fcd::FitReport &report = made.report;
    HostFilterPlugin::ReturnedValues values = valuesOf(made.result.tags);
    values.insert({{"rms", report.rms},
                   {"median", report.median},
                   {"percentile_95", report.percentile95},
                   {"matched", report.matched},
                   {"counted", report.counted},
                   {"moved", report.moved},
                   {"moved_most", report.movedMost},
                   {"guessed", report.guessed},
                   {"guess_error", report.guessError},
                   {"check_rms", rmsOf(made.check)},
                   {"check_largest", mostOf(made.check)},
                   {"leave_one_out_rms", rmsOf(made.leftOut)},
                   {"leave_one_out_largest", mostOf(made.leftOut)},
                   {"carried_parts", int(report.carried)},
                   {"landmarks", int(made.landmarks)},
                   {"landmark_residual", report.landmarks},
                   {"landmark_pull", report.pull},
                   {"curves", int(made.curves.curve.size())},
                   {"curve_residual", report.curves},
                   {"landmarks_contradicted", int(report.contradicted.size())},
                   {"target_not_finite", int(report.notFinite)},
                   {"from_afar", report.fromAfar},
                   {"both_ways", report.bothWays},
                   {"inside_out", report.insideOut},
                   {"steps", report.steps},
                   {"seconds", made.seconds}});
    return values;
}

std::vector<std::string> warningsOf(const FittedLayers &made) {
    const vcg::fcd::FitReport &report = made.report;
    std::vector<std::string> warnings = report.Remarks();
    if (report.matched < 0.3 && !made.landmarksOnly) // most of the shape is a guess
        warnings.push_back(inWords("Only ", 100 * report.matched,
                                   " percent of the surface have a counterpart: do not trust the rest. Move the layers "
                                   "onto each other first, give landmarks, or raise largest_distance or "
                                   "largest_angle."));
    if (report.guessed > 0.05 && report.guessError > 0.01 * made.diagonal) // 1 %: a hand misses by less
        warnings.push_back(
            inWords(100 * report.guessed,
                    " percent of the surface have no counterpart: their place is a guess that may be off "
                    "by about ",
                    report.guessError, ": give landmarks there, or do not trust them."));
    if (made.result.check.flipped > 0)
        warnings.push_back(trianglesFlipped(std::size_t(made.result.check.flipped)) +
                           ": the fit folds the surface there. Give landmarks, or raise stiffness.");
    if (report.pull > 0.01 * made.diagonal && report.contradicted.empty()) // 1 %: a hand misses by less
        warnings.push_back(inWords("The landmarks contradict each other or the target, by ", report.pull,
                                   ". Look for pairs that are mixed up."));
    if (!report.converged && !report.IsMisplaced())
        warnings.emplace_back("The fit did not converge: raise fit_steps.");
    return warnings;
}
