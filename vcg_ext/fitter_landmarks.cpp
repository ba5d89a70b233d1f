// SPDX-License-Identifier: GPL-3.0-or-later
// What a fit begins with and ends with: its target, how that lies, and the landmarks.
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_contradictions.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_target.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>

namespace vcg::fcd {

namespace {

// Across a line or a plane, of how far along: what rounding leaves; and what a shape has that is no sheet of paper.
constexpr double noShape = 1e-6, someShape = 1e-3;
// Of the diagonal between the boxes: so far apart, hardly anything has its counterpart nearest.
constexpr double afar = 0.5;
// A target so many times as large, and farther than astray of the diagonal from most of the surface, is in other units:
// the closest that people mix, centimetres and inches, are 2.54 apart. Of a smaller one, a part may have been scanned.
constexpr double otherUnits = 2.2, smallPart = 0.2, astray = 0.1;
// So many times as much as the landmarks are off, nodes may give way: one that few nodes lead takes twice to three
// times; two that are close and go apart, more. Or so much of the diagonal, in which no ripple is seen.
constexpr double mostGivingWay = 10, unseen = 0.01;

} // namespace

/// From the world. The frame has the source's matrix without its translation.
Eigen::Affine3d Fitter::ToFrame(const Eigen::Affine3d &world) const {
    const Frame &frame = deformer->Whole().surface.frame;
    return Eigen::Translation3d(-frame.origin / frame.scale) * Eigen::Scaling(1 / frame.scale) *
           Eigen::Affine3d(frame.metric) * handles.world.inverse() * world;
}

std::shared_ptr<const FitTarget> Fitter::Prepare(const FitGoal &goal, const Progress &progress) const {
    auto target = std::make_shared<FitTarget>(goal.surface, goal.normal, ToFrame(goal.world), progress, goal.isRead,
                                              goal.weight, goal.name);
    if (!(target->Spans().acrossLine > noShape))
        throw BadInput("All of the " + std::string(goal.name) +
                       " lies at one point or on one line, so it is no surface. Choose a surface, or points all over "
                       "one; where points are meant one by one, give them as landmarks.");
    target->curves = goal.curves;
    const Eigen::Affine3d toFrame = ToFrame(Eigen::Affine3d::Identity());
    for (Curve &curve : target->curves) {
        const double far = farFromAll * target->Box().diagonal().norm();
        double nearest = std::numeric_limits<double>::infinity();
        for (Eigen::Vector3d &corner : curve.target) {
            corner = toFrame * corner;
            if (nearest > far && corner.allFinite()) // one that is near is enough
                nearest = std::min(nearest, (target->Nearest(corner).point - corner).norm());
        }
        if (std::isfinite(nearest) && nearest > far) {
            std::ostringstream text;
            text << "Curve " << &curve - target->curves.data() + 1 << " is " << deformer->frame.scale * nearest
                 << " from the target at the least, more than a tenth of its diagonal. Give its line there in world "
                    "coordinates, as the target lies.";
            throw BadInput(text.str());
        }
        for (Eigen::Vector3d &offset : curve.offset)
            offset = toFrame.linear() * offset;
    }
    return target;
}

/// Adds a sample for each landmark. \return where it belongs, frame units
std::vector<Eigen::Vector3d> Fitter::Lead(const std::vector<Landmark> &landmark, const RegionPose &pose,
                                          FitSamples &samples) const {
    std::set<Index> taken;
    const RegionDeformer &region = deformer->Whole();
    std::vector<Eigen::Vector3d> place;
    for (const Landmark &each : landmark) {
        if (each.vertex >= source.vertexSlots || source.IsDeleted(each.vertex) || !each.target.allFinite())
            throw BadInput("Landmark " + std::to_string(place.size() + 1) +
                           " is at no vertex, or its target is not finite.");
        const Index node = deformer->nodeOf[each.vertex];
        place.push_back(region.surface.frame.ToFrame(handles.world.inverse() * each.target));
        if (node < 0 || region.held.tag[std::size_t(node)] != 1)
            throw BadInput("Landmark " + std::to_string(place.size()) + " is at a vertex that is not free.");
        if (!taken.insert(node).second)
            throw BadInput("Landmark " + std::to_string(place.size()) +
                           " is at the place of another one. Leave one of the two out.");
        samples.Add(region, pose, node);
    }
    return place;
}

/// No place of the surface is near enough to it to be matched.
FitTarget Fitter::NoTarget(const std::vector<Landmark> &landmark) const {
    std::vector<double> place;
    for (const Landmark &each : landmark)
        place.insert(place.end(), each.target.data(), each.target.data() + 3);
    FitGoal goal;
    goal.surface.position = place.data();
    goal.surface.vertexSlots = landmark.size();
    goal.surface.isCloud = true;
    goal.normal = [](std::size_t) { return Eigen::Vector3d(0, 0, 1); };
    return FitTarget(goal.surface, goal.normal, ToFrame(goal.world));
}

Deformer::Pose Fitter::Follow(const std::vector<Landmark> &landmark, FitReport &report,
                              const Progress &progress) const {
    return Solve(NoTarget(landmark), landmark, report, progress);
}

std::vector<double> Fitter::LeaveOneOut(const std::vector<Landmark> &landmark, const Progress &progress) const {
    return LeaveOneOut(NoTarget(landmark), landmark, progress);
}

std::vector<double> Fitter::LeaveOneOut(const FitTarget &target, const std::vector<Landmark> &landmark,
                                        const Progress &progress) const {
    const RegionDeformer &region = deformer->Whole();
    const Frame &frame = region.surface.frame;
    std::vector<double> off;
    const double n = double(landmark.size());
    for (std::size_t l = 0; l < landmark.size(); ++l) {
        std::vector<Landmark> others = landmark;
        others.erase(others.begin() + std::ptrdiff_t(l));
        FitReport report;
        const Deformer::Pose pose = Solve(target, others, report, progress.Slice(double(l) / n, (double(l) + 1) / n));
        FitSamples mark;
        mark.Add(region, pose.region[0], deformer->nodeOf[landmark[l].vertex]);
        const Eigen::Vector3d place = frame.ToFrame(handles.world.inverse() * landmark[l].target);
        off.push_back((mark.At(0, pose.region[0].solved) - place).norm() * frame.scale);
    }
    return off;
}

std::vector<double> Fitter::Residuals(const std::vector<Landmark> &pair, const PositionsRef &position) const {
    std::vector<double> off;
    for (const Landmark &each : pair) {
        if (each.vertex >= source.vertexSlots || source.IsDeleted(each.vertex) || !each.target.allFinite())
            throw BadInput("Pair " + std::to_string(off.size()) +
                           " of those to check, counted from 0, is at no vertex, or its target is not finite.");
        off.push_back((handles.world * position.col(Eigen::Index(each.vertex)) - each.target).stableNorm());
    }
    return off;
}

bool Fitter::IsAllFree() const {
    return std::all_of(deformer->Whole().held.tag.begin(), deformer->Whole().held.tag.end(),
                       [](Index tag) { return tag == 1; });
}

bool Fitter::FollowsAlone() const { return param.largestDistance <= std::numeric_limits<double>::min(); }

void Fitter::Judge(const FitTarget &target, const FitPlacement &placement, bool isLed, FitReport &report) const {
    const double scale = deformer->Whole().surface.frame.scale;
    report.notFinite = target.LeftOut();
    report.apart = placement.apart * scale;
    report.larger = placement.larger;
    report.mirrored = placement.mirrored && !isLed;
    report.flat = target.Spans().acrossPlane < noShape && placement.flatness > someShape;
    const bool isApart =
        param.start == FitStart::AsItLies && placement.apart > afar && !isLed && report.apart < param.largestDistance;
    report.fromAfar = isApart && IsAllFree();
    report.isApart = isApart && !report.fromAfar;
    // Where it is 0, rounding has taken it: the target is so far away.
    report.otherSize = report.larger > 0 && (report.larger > otherUnits || report.larger < smallPart) &&
                       (placement.median > astray || isApart) && param.start != FitStart::Similar;
}

/// Nothing is told or asked for that says where it is, and its strain tells it.
bool Fitter::MayBegin(const FitReport &report, bool isLed) const {
    return param.start == FitStart::AsItLies && !isLed && IsAllFree() && !report.otherSize && !report.mirrored &&
           !report.flat && std::isinf(param.largestDistance) && param.fitRigidity == 1;
}

std::vector<Contradiction> Fitter::Doubted(const FitSamples &drawn, std::size_t first,
                                           const std::vector<Eigen::Vector3d> &place, const std::vector<char> &isFree,
                                           const GraphPose &pose, const Progress &progress) const {
    if (!param.judgesLandmarks || place.empty())
        return {};
    FitSamples marks = drawn.From(first);
    marks.Shrink(place.size());
    return Contradictions(deformer->Whole(), isFree, marks, place, FollowsAlone() ? tornStrain : tornStrain / 2,
                          param.landmarkTolerance / deformer->Whole().surface.frame.scale, param.smoothness, pose,
                          progress);
}

void Fitter::Arrive(const FitSamples &drawn, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                    const std::vector<char> &leads, const std::vector<char> &isFree, GraphPose &graph,
                    FitReport &report, const Progress &progress) const {
    const double scale = deformer->Whole().surface.frame.scale, tolerance = param.landmarkTolerance / scale;
    std::vector<Eigen::Vector3d> goal = place;
    double off = 0;
    for (std::size_t l = 0; l < place.size(); ++l) {
        const Eigen::Vector3d x = drawn.At(first + l, graph);
        goal[l] = leads[l] ? Within(tolerance, place[l], x) : x;
        off = std::max(off, (goal[l] - x).norm());
    }
    const GraphPose before = graph;
    double move = MoveOnto(drawn, first, goal, isFree, graph, progress);
    if (!(move <= std::max(mostGivingWay * off, unseen))) {
        graph = before;
        move = MoveTowards(drawn, first, goal, isFree, graph);
    }
    report.pull = move * scale;
    for (std::size_t l = 0; l < place.size(); ++l)
        if (leads[l]) {
            const double far = (drawn.At(first + l, graph) - place[l]).norm();
            report.landmarks = std::max(report.landmarks, far * scale);
            report.unmet += far > tolerance + 1e-6;
        }
    report.patchesForAll = 2 * std::max(int(place.size()), param.graph.initialPatches);
    report.beyond = std::max(report.landmarks - param.landmarkTolerance, 0.0);
}

Eigen::Affine3d Fitter::Start(const FitTarget &target, const FitSamples &samples, std::size_t matched,
                              const std::vector<Eigen::Vector3d> &place, FitReport &report, unsigned threads) const {
    if (!IsAllFree())
        throw BadInput("A start that moves all of the surface does not go with fixed vertices or handles: start "
                       "from where the layers lie.");
    std::vector<Eigen::Vector3d> from;
    const bool byAxes = param.start == FitStart::TriedAxes || report.fromAfar;
    const auto &node = samples.surfaceNode;
    for (std::size_t s = byAxes ? 0 : matched; s < (byAxes ? matched : matched + place.size()); ++s)
        from.emplace_back(deformer->Whole().surface.graph.position.col(node[s]).cast<double>());
    if (report.fromAfar)
        return StartFromAfar(from, sampleNormal, target, threads, report.isSureFromAfar);
    if (byAxes)
        return StartFromAxes(from, sampleNormal, target, threads);
    return StartFromLandmarks(from, place, param.start == FitStart::Similar);
}

void Fitter::PutLandmarks(const std::vector<Landmark> &landmark, Eigen::Ref<Eigen::Matrix3Xd> position) const {
    if (param.landmarkTolerance > 0)
        return;
    const double rounding = 1e-5 * deformer->Whole().surface.frame.scale;
    std::map<Index, Eigen::Vector3d> at;
    for (const Landmark &each : landmark) {
        const Eigen::Vector3d target = handles.world.inverse() * each.target;
        const Eigen::Vector3d off = target - position.col(Eigen::Index(each.vertex));
        if (Eigen::Vector3d(handles.world.linear() * off).stableNorm() <= rounding)
            at[deformer->nodeOf[each.vertex]] = target;
    }
    if (at.empty())
        return;
    for (std::size_t i = 0; i < source.vertexSlots; ++i)
        if (const auto found = at.find(deformer->nodeOf[i]); found != at.end())
            position.col(Eigen::Index(i)) = found->second;
}

} // namespace vcg::fcd
