// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/error.h>
#include <vcg_ext/symmetry/best_plane.h>

#include <algorithm>
#include <limits>

namespace vcg::fcd {

namespace {

// A warp of degree 3 with fewer points than the final one tells which of several planes is the right one: the one in
// which the surface is its mirror image up to the warp. Planes up to `equal` times the least misfit are as good (if the
// surface is its own mirror image in several, they differ by noise). Misfits below `perfect` of the diagonal count as
// equal. It is sure if the misfit of the best plane with other counterparts is sureBy times as large: of skulls that
// lack up to a third of their area, it was 2.3 to 18 times as large; if they lack more, the plane is a wrong one, and
// it was 1 to 1.9 times as large.
constexpr int roughDegree = 3, sketchDegree = 2;
constexpr std::size_t roughPlaces = 500;
// If there are many planes, as on a shape without symmetry, a warp of fewer points and a lower degree chooses among
// them: the misfit of the right one is several times less than that of others.
constexpr std::size_t sketchPlaces = 100, finalPlanes = 10;
constexpr double roughRest = 0.1; // a warp rests if a step moves places by less than a tenth of what is left
constexpr double equal = 1.25, sureBy = 2, perfect = 1e-4;
constexpr double apart = 0.05; // of the diagonal: counterparts farther from each other than this are different ones
// If no plane stood out before the warps, nor does after them, which one is taken is chance. The misfit of the right
// plane is then below half of the median; that of the best one in random points is above.
constexpr double asAnyWarped = 0.5;

/// A plane, and the warp that takes the surface onto its mirror image in it.
struct WarpedPlane {
    MirrorPlane plane;
    double misfit, misfitOfAll; // of the warp
    MirrorPairs pairs;          // points, and their counterparts
};

/// Warps in each plane, with about so many points.
std::vector<WarpedPlane> WarpInEach(const std::vector<MirrorPlane> &planes, const WarpGoalIn &goalIn,
                                    std::size_t points, int degree, const Progress &progress) {
    std::vector<WarpedPlane> all(planes.size());
    ParallelTasks(progress, "Looking for the plane", planes.size(), [&](std::size_t i, const Progress &share) {
        WarpGoal goal = goalIn(planes[i]);
        goal.place = Some(goal.place, points);
        goal.normal = Some(goal.normal, points);
        goal.weight = Some(goal.weight, points);
        goal.degree = degree;
        goal.rest = roughRest;
        WarpReport fit;
        const SmoothWarp warp = FitWarp(goal, share, &fit);
        all[i].plane = planes[i];
        all[i].misfit = fit.misfit;
        all[i].misfitOfAll = fit.misfitOfAll;
        for (const Eigen::Vector3d &place : goal.place)
            all[i].pairs.emplace_back(place, planes[i](warp.At(place)));
    });
    return all;
}

std::vector<double> SortedMisfits(const std::vector<WarpedPlane> &all) {
    std::vector<double> misfit(all.size());
    std::transform(all.begin(), all.end(), misfit.begin(), [](const WarpedPlane &each) { return each.misfit; });
    std::sort(misfit.begin(), misfit.end());
    return misfit;
}

} // namespace

MirrorPlane BestPlane(const TriedPlanes &tried, const WarpGoalIn &goalIn, bool &isSure, const Progress &progress) {
    std::vector<MirrorPlane> planes = tried.planes;
    const bool isMany = planes.size() > finalPlanes;
    if (isMany) {
        // Points without a surface have no normals: those of the points around would let any plane seem right.
        const WarpGoalIn bareIn = [&](const MirrorPlane &in) {
            WarpGoal goal = goalIn(in);
            if (!tried.standOut)
                std::fill(goal.normal.begin(), goal.normal.end(), Eigen::Vector3d::Zero());
            return goal;
        };
        const auto all = WarpInEach(planes, bareIn, sketchPlaces, sketchDegree, progress.Slice(0, 0.5));
        const std::vector<double> misfit = SortedMisfits(all);
        if (!tried.standOut && misfit[0] > std::max(perfect, asAnyWarped * misfit[misfit.size() / 2]))
            throw BadInput("The surface is as much like its mirror image in any plane as in another one. Give pairs, a "
                           "midline or the plane.");
        planes.clear();
        for (const WarpedPlane &each : all)
            if (each.misfit <= misfit[finalPlanes - 1])
                planes.push_back(each.plane);
    }
    const std::vector<WarpedPlane> all =
        WarpInEach(planes, goalIn, roughPlaces, roughDegree, progress.Slice(isMany ? 0.5 : 0, 1));
    const double least = std::max(SortedMisfits(all)[0], perfect);
    // A part may tell which of these it is: the front of a person is much like the back, but for the feet.
    double leastOfAll = std::numeric_limits<double>::infinity();
    for (const WarpedPlane &each : all)
        if (each.misfit <= equal * least)
            leastOfAll = std::min(leastOfAll, std::max(each.misfitOfAll, perfect));
    const WarpedPlane &best = *std::find_if(all.begin(), all.end(), [&](const WarpedPlane &each) {
        return each.misfit <= equal * least && each.misfitOfAll <= equal * leastOfAll;
    });
    const auto isOther = [&](const WarpedPlane &each) { // its counterparts are others
        double squares = 0;
        for (std::size_t s = 0; s < best.pairs.size(); ++s)
            squares += (each.pairs[s].second - best.pairs[s].second).squaredNorm();
        return squares > apart * apart * double(best.pairs.size());
    };
    isSure = std::none_of(all.begin(), all.end(),
                          [&](const WarpedPlane &each) { return each.misfit <= sureBy * least && isOther(each); });
    bool isTold;
    const MirrorPlane plane = PlaneOf(best.pairs, {}, isTold);
    return isTold ? plane : best.plane;
}

} // namespace vcg::fcd
