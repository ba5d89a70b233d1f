// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_compensator.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_straightener.h"
#include "new_layers.h"

#include <sstream>

using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;
using vcg::fcd::SurfaceView;

/// The positions of \p view, world units.
static Eigen::Matrix3Xd inWorld(const SurfaceView &view, const Eigen::Affine3d &world) {
    Eigen::Matrix3Xd position = view.Copy();
    forEach(view.vertexSlots, [&](std::size_t i) {
        position.col(Eigen::Index(i)) = world * Eigen::Vector3d(position.col(Eigen::Index(i)));
    });
    return position;
}

CompensatedLayers compensateLayer(MeshDocument &document, MeshModel &layer, const CompensateLayerParam &param,
                                  const Remark &remark, const Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    const MeshModel &scan = checkedTarget(layer, param.scan, "scan_layer");
    const LineSurface nominal(layer, progress.Slice(0, 0.02)), target(scan, progress.Slice(0.02, 0.04));
    const SurfaceView view = nominal.arrays.View(), targetView = target.arrays.View();
    const Eigen::Affine3d &world = nominal.world;
    const Eigen::Matrix3Xd at = inWorld(view, world), targetAt = inWorld(targetView, target.world);
    const Eigen::Matrix3d turned = vcg::fcd::Cofactors(Eigen::Matrix3d(target.world.linear()));
    const vcg::fcd::NormalOf normal = [&](std::size_t i) {
        return Eigen::Vector3d(turned * toVector(target.normal[i]));
    };
    const vcg::fcd::Compensation way(view.With(at), targetView.With(targetAt), normal, param.compensation,
                                     progress.Slice(0.04, 0.95));

    CompensatedLayers made;
    made.report = way.report;
    Eigen::Matrix3Xd position = view.Copy();
    std::vector<Eigen::Matrix3f> linear(nominal.hasDirections ? view.vertexSlots : 0);
    std::vector<float> quality(param.quality == CompensateLayerParam::Change ? view.vertexSlots : 0);
    const Eigen::Affine3d back = world.inverse();
    ParallelFor(0, view.vertexSlots, 1 << 10, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Eigen::Vector3d from = at.col(Eigen::Index(i)), to = way.position.col(Eigen::Index(i));
            if (!linear.empty()) // vertices outside of the part stay
                linear[i] = to == from ? Eigen::Matrix3f::Identity().eval()
                                       : (back.linear() * way.LinearAt(to) * world.linear()).cast<float>().eval();
            if (to != from)
                position.col(Eigen::Index(i)) = back * to;
            if (!quality.empty())
                quality[i] = float((to - from).norm());
        }
    });

    progress(0.95, "Adding layers...");
    NewLayers layers(document, layer, remark);
    layers.keepResults(layer, {&layers.addDeformed("compensated", position, linear, quality)}, progress.Slice(0.95, 1));
    made.seconds = watch.Seconds();
    return made;
}

std::string describe(const CompensatedLayers &made) {
    const vcg::fcd::CompensateReport &report = made.report;
    std::ostringstream line;
    line << 100 * report.scanned << " percent of the nominal part have a counterpart on the scan, which is "
         << report.before << " (rms) from it, laid onto it rigidly, and " << report.left
         << " from it after the warp. What to print differs from the nominal part by " << report.change
         << " (rms), at most by " << report.changeMost << ". " << made.seconds << " s.";
    return line.str();
}
