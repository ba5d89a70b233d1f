// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_contents.h"
#include "layer_corrections.h"
#include "layer_fitter.h"
#include "layer_labels.h"
#include "layer_straightener.h"
#include "new_layers.h"
#include "point_sources.h"
#include "weight_sources.h"

#include <array>
#include <memory>
#include <utility>

using vcg::fcd::Deformer;
using vcg::fcd::Error;
using vcg::fcd::Fitter;
using vcg::fcd::Progress;
using vcg::fcd::SurfaceView;
using vcg::fcd::SymmetryGoal;
using vcg::fcd::SymmetryMark;

static SymmetryGoal goalOf(const MeshModel &layer, const SymmetrizeParam &param, const Remark &remark) {
    SymmetryGoal goal;
    if (!param.planeNormal.isZero(0))
        goal.plane = vcg::fcd::MirrorPlane{param.planePoint, param.planeNormal};
    if (param.pairsFile.isEmpty() && param.midlineFile.isEmpty())
        return goal;
    VertexFinder vertices(layer, nullptr);
    const auto markAt = [&](const Eigen::Vector3d &place, std::size_t point) {
        return SymmetryMark{vertices.nearestTo(place, point), place};
    };
    if (!param.pairsFile.isEmpty()) {
        for (const vcg::fcd::PointPair &pair : readPointPairs(layer, param.pairsFile)) {
            const std::size_t number = goal.pairs.size();
            SymmetryMark start;
            if (pair.vertex >= 0) {
                start.vertex = vertices.numbered(pair.vertex, param.pairsFile);
                start.place = vertices.world * vertices.at(start.vertex);
            } else {
                start = markAt(pair.start, number);
            }
            goal.pairs.push_back({start, markAt(pair.target, number)});
        }
        vertices.tellFar(param.pairsFile, remark);
    }
    if (!param.midlineFile.isEmpty()) {
        const Eigen::Matrix3Xd points = readLine(param.midlineFile);
        for (Eigen::Index i = 0; i < points.cols(); ++i)
            goal.midline.push_back(markAt(points.col(i), std::size_t(i)));
        vertices.tellFar(param.midlineFile, remark);
    }
    return goal;
}

/// Adds a layer with the mirror image of the surface without a counterpart. \return its number of vertices
static std::size_t addMissing(NewLayers &layers, const SurfaceView &view, const Eigen::Affine3d &world,
                              const vcg::fcd::MirrorPlane &plane, const std::vector<char> &matched,
                              const Eigen::Matrix3Xd &position) {
    std::vector<std::size_t> number(view.vertexSlots, view.vertexSlots), chosen;
    std::vector<std::array<std::size_t, 3>> faces;
    const auto numberAmong = [&](std::size_t i) {
        if (number[i] == view.vertexSlots) {
            number[i] = chosen.size();
            chosen.push_back(i);
        }
        return number[i];
    };
    for (std::size_t f = 0; f < view.faces; ++f) {
        const std::uint32_t *corner = view.corner + 3 * f;
        if (view.IsFace(f) && !matched[corner[0]] && !matched[corner[1]] && !matched[corner[2]])
            faces.push_back({numberAmong(corner[0]), numberAmong(corner[2]), numberAmong(corner[1])});
    }
    for (std::size_t i = 0; view.faces == 0 && i < view.vertexSlots; ++i)
        if (!view.IsDeleted(i) && !matched[i])
            numberAmong(i);
    if (chosen.empty())
        return 0;
    Eigen::Matrix3Xd places(3, Eigen::Index(chosen.size()));
    for (std::size_t k = 0; k < chosen.size(); ++k)
        places.col(Eigen::Index(k)) =
            world.inverse() * plane(world * Eigen::Vector3d(position.col(Eigen::Index(chosen[k]))));
    layers.addSurface("mirrored", places, faces);
    return chosen.size();
}

SymmetrizedLayers symmetrizeLayer(MeshDocument &document, MeshModel &layer, const SymmetrizeParam &asked,
                                  const Remark &remark, const Progress &progress) {
    const vcg::fcd::Stopwatch watch;
    SymmetrizeParam param = asked;
    const LineSurface surface(layer, progress.Slice(0, 0.02));
    param.fit.linear = surface.hasDirections;
    const SurfaceView view = surface.arrays.View();
    const Eigen::Affine3d &world = surface.world;
    const vcg::fcd::NormalOf normal = [&](std::size_t i) { return toVector(surface.normal[i]); };
    const std::vector<float> weights = readWeights(layer, param.weights, param.weightAttribute);
    const vcg::fcd::WeightOf weight = weightOf(weights);
    const SymmetryGoal goal = goalOf(layer, param, remark);

    SymmetrizedLayers made;
    made.pairs = goal.pairs.size();
    made.midline = goal.midline.size();
    vcg::fcd::DeformationResult &result = made.result;
    result.tags = vcg::fcd::CountTags(surface.handles.tag, view.deleted);
    const auto fitter =
        std::make_shared<const Fitter>(view, normal, surface.handles, param.fit, progress.Slice(0.02, 0.2), weight);
    const Deformer &deformer = fitter->Surface();
    made.diagonal = deformer.frame.scale;
    vcg::fcd::SymmetricPose pose =
        vcg::fcd::Symmetrize(*fitter, view, normal, world, goal, made.report, progress.Slice(0.2, 0.75), weight);
    if (made.report.fit.matched == 0)
        throw Error("Nothing of " + inQuotes(layer) +
                    " has a counterpart on its other side. Give pairs, a midline or the plane, or raise "
                    "largest_distance.");
    const auto carried = [&](const Deformer::Pose &of, const Progress &part) {
        Eigen::Matrix3Xd position = view.Copy();
        vcg::fcd::Carrier(deformer, of).Apply(position, nullptr, part);
        return position;
    };
    std::vector<float> distance, quality;
    std::vector<char> matched;
    fitter->Compare(*pose.target, made.report.fit, carried(pose.fitted, progress.Slice(0.75, 0.78)), distance, matched,
                    progress.Slice(0.78, 0.8));
    pose.target = nullptr;
    result.pose = std::move(pose.half);
    result.converged = made.report.fit.converged;
    result.position = view.Copy();
    vcg::fcd::CarryPose(view, normal, surface.handles, deformer, param.fit, progress.Slice(0.8, 0.9), result);
    vcg::fcd::PutPartners(*fitter, view, world, goal, made.report, result.position);
    const auto apart = [&](const vcg::fcd::PositionsRef &position, const Progress &part) {
        return vcg::fcd::DistanceFromMirror(*fitter, view, normal, world, made.report.plane, matched, position, part,
                                            weight);
    };
    made.before = apart(view.Positions(), progress.Slice(0.9, 0.92));
    made.after = apart(result.position, progress.Slice(0.92, 0.94));
    if (param.quality == SymmetrizeParam::Matched) {
        quality.assign(matched.begin(), matched.end());
    } else if (param.quality != SymmetrizeParam::Input) {
        const Eigen::Matrix3Xd to = param.quality == SymmetrizeParam::Moved
                                        ? result.position
                                        : carried(pose.mirror, progress.Slice(0.94, 0.95));
        for (std::size_t i = 0; i < view.vertexSlots; ++i)
            quality.push_back(float((world.linear() * (to.col(Eigen::Index(i)) - view.At(i))).norm()));
    }

    progress(0.95, "Adding layers...");
    NewLayers layers(document, layer, remark);
    if (param.mirrorMissing)
        made.mirrored = addMissing(layers, view, world, made.report.plane, matched, result.position);
    layers.keepResults(
        layer,
        layers.addResult("symmetrized", result, quality, preparedOf(param.graphLayers ? fitter : nullptr, result.tags)),
        progress.Slice(0.95, 1));
    made.seconds = watch.Seconds();
    return made;
}

std::string describe(const SymmetrizedLayers &made) {
    const vcg::fcd::SymmetryReport &report = made.report;
    const auto text = [](const Eigen::Vector3d &v) { return inWords(v[0], " ", v[1], " ", v[2]); };
    return inWords("The plane of symmetry, ",
                   report.isGiven         ? "as given"
                   : report.isOfLandmarks ? "of the landmarks"
                                          : "as the surface tells it",
                   ", goes through ", text(report.plane.point), " with the normal ", text(report.plane.normal),
                   ". The surface was ", made.before, " (rms) from its mirror image, and is ", made.after,
                   " from it now. It was moved by ", report.moved, " (rms), at most by ", report.movedMost, "; ",
                   100 * report.fit.matched, " percent have a counterpart on the other side.",
                   made.mirrored > 0 ? inWords(" ", made.mirrored, " vertices are mirrored over what is missing.") : "",
                   " ", made.seconds, " s.");
}

std::vector<std::string> warningsOf(const SymmetrizedLayers &made) {
    const vcg::fcd::SymmetryReport &report = made.report;
    std::vector<std::string> warnings;
    if (!report.isSure)
        warnings.emplace_back("The surface is nearly as much like its mirror image in another plane. Look at the "
                              "plane; if it is wrong, give pairs, a midline or the plane itself.");
    if (made.after > made.before + 1e-6 * made.diagonal) // more than rounding
        warnings.emplace_back("The result is farther from its mirror image than the surface was: the plane is probably "
                              "wrong. Give pairs, a midline or another plane.");
    if (report.fit.matched < 0.3) // most of the shape is a guess
        warnings.push_back(inWords("Only ", 100 * report.fit.matched,
                                   " percent of the surface have a counterpart on the other side: do not trust the "
                                   "rest. Give pairs or a midline."));
    else if (report.fit.guessed > 0.05 && report.fit.guessError > 0.01 * made.diagonal) // 1 %: a hand misses by less
        warnings.push_back(inWords(100 * report.fit.guessed,
                                   " percent of the surface have no counterpart on the other side: their place is a "
                                   "guess that may be off by about ",
                                   report.fit.guessError, "."));
    if (std::string named = report.Contradiction(made.pairs); !named.empty())
        warnings.push_back(std::move(named));
    if (made.result.check.flipped > 0)
        warnings.push_back(trianglesFlipped(std::size_t(made.result.check.flipped)) +
                           ": the surface is folded there. Give pairs, or look at those given, or raise stiffness.");
    if (!made.result.converged)
        warnings.emplace_back("The fit onto the mirror image did not converge: raise fit_steps.");
    return warnings;
}

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
    const vcg::fcd::Compensation compensation(view.With(at), targetView.With(targetAt), normal, param.compensation,
                                              progress.Slice(0.04, 0.95));

    CompensatedLayers made;
    made.report = compensation.report;
    Eigen::Matrix3Xd position = view.Copy();
    std::vector<Eigen::Matrix3f> linear(nominal.hasDirections ? view.vertexSlots : 0);
    std::vector<float> quality(param.quality == CompensateLayerParam::Change ? view.vertexSlots : 0);
    const Eigen::Affine3d back = world.inverse();
    forEach(view.vertexSlots, [&](std::size_t i) {
        const Eigen::Vector3d from = at.col(Eigen::Index(i)), to = compensation.position.col(Eigen::Index(i));
        if (!linear.empty()) // vertices outside of the part stay
            linear[i] = to == from ? Eigen::Matrix3f::Identity().eval()
                                   : (back.linear() * compensation.LinearAt(to) * world.linear()).cast<float>().eval();
        if (to != from)
            position.col(Eigen::Index(i)) = back * to;
        if (!quality.empty())
            quality[i] = float((to - from).norm());
    });

    progress(0.95, "Adding layers...");
    NewLayers layers(document, layer, remark);
    layers.keepResults(layer, {&layers.addDeformed("compensated", position, linear, quality)}, progress.Slice(0.95, 1));
    made.seconds = watch.Seconds();
    return made;
}

std::string describe(const CompensatedLayers &made) {
    const vcg::fcd::CompensateReport &report = made.report;
    return inWords(100 * report.scanned, " percent of the nominal part have a counterpart on the scan, which is ",
                   report.before, " (rms) from it, laid onto it rigidly, and ", report.left,
                   " from it after the warp. What to print differs from the nominal part by ", report.change,
                   " (rms), at most by ", report.changeMost, ". ", made.seconds, " s.");
}
