// SPDX-License-Identifier: GPL-3.0-or-later
// What is told of a surface that was made symmetric.
#include <vcg_ext/fit/fit_target.h>
#include <vcg_ext/symmetrize.h>

#include <algorithm>
#include <cmath>

namespace vcg::fcd {

namespace {

constexpr std::size_t compared = 2000; // vertices, about: their mean distance is then known to some percent

} // namespace

double DistanceFromMirror(const Fitter &fitter, const SurfaceView &source, const NormalOf &normal,
                          const Eigen::Affine3d &world, const MirrorPlane &given, const std::vector<char> &matched,
                          const PositionsRef &position, const Progress &progress, const WeightOf &weight) {
    const RegionDeformer &region = fitter.Surface().Whole();
    const Frame &frame = region.surface.frame;
    const MirrorPlane plane{detail::ToWorld(frame, world).Back(given.point), given.normal};
    SurfaceView moved = source;
    moved.position = position.data();
    const auto itself = fitter.Prepare({moved, normal, world, {}, weight, {}, "surface"}, progress);
    std::vector<double> far;
    const std::size_t step = std::max<std::size_t>(1, source.vertexSlots / compared);
    for (std::size_t i = 0; i < source.vertexSlots; i += step)
        if (!source.IsDeleted(i) && matched[i]) {
            const Eigen::Vector3d p = plane(frame.ToFrame(Eigen::Vector3d(position.col(Eigen::Index(i)))));
            far.push_back((itself->Nearest(p).point - p).norm());
        }
    std::sort(far.begin(), far.end());
    far.resize(far.size() - far.size() / 10); // what is missing on one side may look matched near its border
    double squares = 0;
    for (double each : far)
        squares += each * each;
    return far.empty() ? 0 : std::sqrt(squares / double(far.size())) * frame.scale;
}

std::string SymmetryReport::Contradiction(std::size_t pairs) const {
    std::string names;
    for (std::size_t each : contradicted)
        names += (names.empty() ? "" : ", ") +
                 (each < pairs ? "pair " + std::to_string(each) : "midline point " + std::to_string(each - pairs));
    return names.empty() ? names
                         : "These landmarks, counted from 0, do not go with the others: " + names +
                               ". Look whether they are mixed up. " +
                               (leftOut ? "They were left out."
                                        : "They were followed, so the surface may be folded there; with a landmark "
                                          "tolerance above 0 they are left out.");
}

} // namespace vcg::fcd
