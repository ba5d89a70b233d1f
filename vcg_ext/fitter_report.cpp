// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit is worth: how far it is from the target, and what of it has a counterpart there.
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>

namespace vcg {
namespace fcd {

void Fitter::Measure(const FitMatches &matches, FitReport &report) const {
    const double scale = deformer->surface.frame.scale;
    std::vector<double> distance, near;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        distance.push_back(matches.Distance(s));
    // The nearest fifth lies on the target wherever that is a fifth of the source, and tells its noise: 12 times the
    // 20th percentile of the distances of a plane's noise is three times its standard deviation.
    const double noise = std::max(12 * Quantile(distance, 0.2), 1e-3);
    double squares = 0;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        if (matches.Counts(s) && distance[s] <= noise) {
            near.push_back(distance[s] * scale);
            squares += near.back() * near.back();
        }
    report.rms = near.empty() ? 0 : std::sqrt(squares / double(near.size()));
    report.median = Quantile(near, 0.5);
    report.percentile95 = Quantile(near, 0.95);
    report.nearest = std::max(report.percentile95, 1e-4 * scale);
    std::size_t matched = 0;
    for (std::size_t s = 0; s < matches.Size(); ++s)
        matched += matches.Counts(s) && report.LiesOn(distance[s] * scale, matches.OnBorder(s));
    report.matched = double(matched) / double(std::max<std::size_t>(distance.size(), 1));
}

void Fitter::Compare(const FitTarget &target, const FitReport &report, const PositionsRef &position,
                     std::vector<float> &distance, std::vector<char> &liesOn, const Progress &progress) const {
    const Frame &frame = deformer->surface.frame;
    distance.assign(source.vertexSlots, 0.f);
    liesOn.assign(source.vertexSlots, 0);
    ParallelFor(progress, "Measuring the distance", source.vertexSlots, 1 << 12,
                [&](std::size_t first, std::size_t last) {
                    NearestPlace::Hint hint; // the next vertex mostly is beside the last one
                    for (std::size_t i = first; i < last; ++i) {
                        if (source.IsDeleted(i))
                            continue;
                        const Eigen::Vector3d p = frame.ToFrame(Eigen::Vector3d(position.col(Eigen::Index(i))));
                        const FitTarget::Match match = target.Nearest(p, hint);
                        const double far = (p - match.point).norm() * frame.scale;
                        distance[i] = float(far);
                        liesOn[i] = report.LiesOn(far, match.onBorder) && far <= param.largestDistance;
                    }
                });
}

} // namespace fcd
} // namespace vcg
