// SPDX-License-Identifier: GPL-3.0-or-later
// The parameters of a fit.
#include <vcg_ext/fit.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace vcg::fcd {

namespace {

// Beyond these, nothing changes any more, until the fit's system has no solution in double precision.
constexpr double leastStiffness = 1e-6, mostStiffness = 1e6;

} // namespace

FitParam::FitParam() {
    influence = 3; // smooth at joints: 2 folds there (the arm of tests/fit_recipes.py), and 4 takes twice as long
    graph.initialPatches = 150; // twice as many fit no better, and take four times as long
    bendsUnheld = true;
}

FitParam FitParam::LandmarksAlone() const {
    FitParam alone = *this;
    alone.largestDistance = std::numeric_limits<double>::min();
    alone.samples = 100;
    alone.fitSteps = std::min(fitSteps, 20);
    return alone;
}

void FitParam::ValidateFit() const {
    Validate();
    if (!(stiffness >= leastStiffness && stiffness <= mostStiffness))
        throw BadInput("The stiffness must be from 1e-6 to 1e6; 1 is the default.");
    if (smoothness > mostStiffness)
        throw BadInput("The smoothness of a fit must be at most 1e6; useful are 0.001 to 0.1.");
    if (!(fitRigidity >= 0 && fitRigidity <= 1))
        throw BadInput("The rigidity must be from 0 (smooth) to 1 (rigid, the default).");
    if (!(largestDistance > 0))
        throw BadInput("The largest distance of matches must be positive.");
    if (!(largestAngle > 0 && largestAngle <= 180))
        throw BadInput("The largest angle of matches must be above 0 and at most 180 degrees.");
    if (fitSteps < 2 || fitSteps > 10000)
        throw BadInput("A fit takes 2 to 10000 steps.");
    ValidateSamples(samples);
    if (!(landmarkTolerance >= 0) || std::isinf(landmarkTolerance))
        throw BadInput("The tolerance of the landmarks must be 0, for exact ones, or a positive, finite length.");
}

} // namespace vcg::fcd
