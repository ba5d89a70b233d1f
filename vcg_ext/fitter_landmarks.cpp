// SPDX-License-Identifier: GPL-3.0-or-later
// Begin and end of a fit: the target and its position, and the landmarks.
#include <vcg_ext/base/quantiles.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/fit/fit_contradictions.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_matches.h>
#include <vcg_ext/fit/fit_start.h>
#include <vcg_ext/fit/fit_target.h>
#include <vcg_ext/map/carrier.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <utility>

namespace vcg::fcd {

namespace {

// Extent across a plane, over that along it, above which a shape is not as flat as a sheet of paper.
constexpr double someShape = 1e-3;
// Distance between the boxes, over the diagonal, from which hardly any point has its counterpart nearest.
constexpr double afar = 0.5;
// A target that is otherUnits times as large, and farther than astray (of the diagonal) from most of the surface, has
// other units: the closest that people mix, centimetres and inches, are 2.54 apart. A smaller target may be a part that
// was scanned; below smallPart it is not.
constexpr double otherUnits = 2.2, smallPart = 0.2, astray = 0.1;
// To meet the landmarks, nodes may move by mostGivingWay times as much as the landmarks are off: a landmark that few
// nodes lead takes two or three times, two close ones that move apart take more. Or by `unseen` of the diagonal, which
// makes no visible ripple.
constexpr double mostGivingWay = 10, unseen = 0.01;
// A target of these times the size of the surface: above, rounding of its coordinates is as large as the surface;
// below, its own coordinates have fewer than eight digits in the units of the surface.
constexpr double mostLarger = 1e15, mostSmaller = 1e-8;

/// About how large most of a surface is: some vertices may be strays. By a thousand vertices; 0 where it has none.
double SizeOfMost(const SurfaceView &surface) {
    std::vector<Eigen::Vector3d> place;
    for (std::size_t i = 0; i < surface.vertexSlots; i += 1 + surface.vertexSlots / 1000)
        if (const Eigen::Vector3d p = surface.At(i); !surface.IsDeleted(i) && p.allFinite())
            place.push_back(p);
    if (place.empty())
        return 0;
    const auto median = [&](const auto &of) {
        std::vector<double> number(place.size());
        std::transform(place.begin(), place.end(), number.begin(), of);
        return Quantile(std::move(number), 0.5);
    };
    const Eigen::Vector3d center(median([](const Eigen::Vector3d &p) { return p[0]; }),
                                 median([](const Eigen::Vector3d &p) { return p[1]; }),
                                 median([](const Eigen::Vector3d &p) { return p[2]; }));
    return 2 * median([&](const Eigen::Vector3d &p) { return (p - center).cwiseAbs().maxCoeff(); });
}

} // namespace

/// From the mesh units of a layer with the matrix \p world to the frame of the source.
Eigen::Affine3d Fitter::ToFrame(const Eigen::Affine3d &world) const {
    const Frame &frame = deformer->Whole().surface.frame;
    return Eigen::Translation3d(-frame.origin / frame.scale) * Eigen::Scaling(1 / frame.scale) *
           Eigen::Affine3d(frame.metric) * handles.world.inverse() * world;
}

std::shared_ptr<const FitTarget> Fitter::Prepare(const FitGoal &goal, const Progress &progress) const {
    const auto size = [&](const SurfaceView &surface, const Eigen::Affine3d &world) {
        return SizeOfMost(surface) * ToFrame(world).linear().cwiseAbs().maxCoeff();
    };
    const double own = size(source, handles.world), larger = own > 0 ? size(goal.surface, goal.world) / own : 1;
    if (larger > mostLarger || (larger > 0 && larger < mostSmaller)) {
        std::ostringstream text;
        text << std::setprecision(1) << "The " << goal.name << " is about " << (larger > 1 ? larger : 1 / larger)
             << " times " << (larger > 1 ? "larger" : "smaller") << " than the surface. Scale one of them first.";
        throw BadInput(text.str());
    }
    auto target = std::make_shared<FitTarget>(goal.surface, goal.normal, ToFrame(goal.world), progress, goal.isRead,
                                              goal.weight, goal.name);
    if (target->Spans().IsLine())
        throw BadInput("All of the " + std::string(goal.name) +
                       " lies at one point or on one line, so it is no surface. Choose a surface, or points all over "
                       "one; give single points as landmarks.");
    target->reachesFarther = goal.reachesFarther;
    target->curves = goal.curves;
    const Eigen::Affine3d toFrame = ToFrame(Eigen::Affine3d::Identity());
    for (Curve &curve : target->curves) {
        const double far = farFromAll * target->Box().diagonal().norm();
        double nearest = std::numeric_limits<double>::infinity();
        for (Eigen::Vector3d &corner : curve.target) {
            corner = toFrame * corner;
            if (nearest > far && corner.allFinite()) // one near corner is enough
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

/// From the node of its vertex, frame units.
Eigen::Vector3d Fitter::OffsetOf(const Landmark &landmark) const {
    return ToFrame(Eigen::Affine3d::Identity()).linear() * landmark.offset;
}

/// Adds a sample for each landmark. \return their targets, frame units
std::vector<Eigen::Vector3d> Fitter::Lead(const std::vector<Landmark> &landmark, const RegionPose &pose,
                                          FitSamples &samples) const {
    std::set<Index> taken;
    const RegionDeformer &region = deformer->Whole();
    std::vector<Eigen::Vector3d> place;
    for (const Landmark &each : landmark) {
        if (each.vertex >= source.vertexSlots || source.IsDeleted(each.vertex) || !each.target.allFinite() ||
            !each.offset.allFinite())
            throw BadInput("Landmark " + std::to_string(place.size() + 1) +
                           " is at no vertex, or it or its target is not finite.");
        const Index node = deformer->nodeOf[each.vertex];
        place.push_back(region.surface.frame.ToFrame(handles.world.inverse() * each.target));
        if (node < 0 || region.held.tag[node] != 1)
            throw BadInput(
                "Landmark " + std::to_string(place.size()) +
                (handles.tag[each.vertex] == 1
                     ? " is at a vertex of a loose part, which only goes along with the surface. Leave it out."
                     : " is at a vertex that is not free."));
        if (!taken.insert(node).second)
            throw BadInput("Landmark " + std::to_string(place.size()) +
                           " is at the place of another one. Leave one of the two out.");
        samples.Add(region, pose, node, OffsetOf(each));
    }
    return place;
}

std::shared_ptr<const FitTarget> Fitter::TargetOf(const std::vector<Landmark> &landmark) const {
    std::vector<double> place;
    for (const Landmark &each : landmark)
        place.insert(place.end(), each.target.data(), each.target.data() + 3);
    SurfaceView points;
    points.position = place.data();
    points.vertexSlots = landmark.size();
    points.isCloud = true;
    const NormalOf up = [](std::size_t) { return Eigen::Vector3d(0, 0, 1); };
    return std::make_shared<FitTarget>(points, up, ToFrame(Eigen::Affine3d::Identity()));
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
        mark.Add(region, pose.region[0], deformer->nodeOf[landmark[l].vertex], OffsetOf(landmark[l]));
        const Eigen::Vector3d place = frame.ToFrame(handles.world.inverse() * landmark[l].target);
        off.push_back((mark.At(0, pose.region[0].solved) - place).norm() * frame.scale);
    }
    return off;
}

std::vector<double> Fitter::Residuals(const std::vector<Landmark> &pair, const Deformer::Pose &pose,
                                      const PositionsRef &position) const {
    std::vector<SurfacePlace> at;
    std::vector<Eigen::Vector3d> rest;
    for (const Landmark &each : pair) {
        if (each.vertex >= source.vertexSlots || source.IsDeleted(each.vertex) || !each.target.allFinite() ||
            !each.offset.allFinite())
            throw BadInput("Pair " + std::to_string(at.size()) +
                           " of those to check, counted from 0, is at no vertex, or it or its target is not finite.");
        at.push_back(SurfacePlace::AtVertex(Index(each.vertex)));
        rest.emplace_back(source.At(each.vertex));
    }
    std::vector<Eigen::Matrix3f> linear(pair.size(), Eigen::Matrix3f::Identity());
    if (std::any_of(pair.begin(), pair.end(), [](const Landmark &each) { return !each.offset.isZero(0); })) {
        std::vector<Eigen::Vector3d> displacement;
        Carrier(*deformer, pose).Displacements(at, rest, displacement, linear);
    }
    std::vector<double> off;
    for (std::size_t k = 0; k < pair.size(); ++k) {
        const Eigen::Vector3d beside = linear[k].cast<double>() * (handles.world.linear().inverse() * pair[k].offset);
        off.push_back(
            (handles.world * (position.col(Eigen::Index(pair[k].vertex)) + beside) - pair[k].target).stableNorm());
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
    report.flat = target.Spans().acrossPlane < FitTarget::Shape::none && placement.flatness > someShape;
    const bool isApart =
        param.start == FitStart::AsItLies && placement.apart > afar && !isLed && report.apart < param.largestDistance;
    report.fromAfar = isApart && IsAllFree();
    report.isApart = isApart && !report.fromAfar;
    // larger is 0 if the target is so far away that rounding hides its size.
    report.otherSize = report.larger > 0 && (report.larger > otherUnits || report.larger < smallPart) &&
                       (placement.median > astray || isApart) && param.start != FitStart::Similar;
}

/// Whether other starts may be tried: neither the parameters nor landmarks say how the surface lies, and its strain can
/// tell.
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
                              const std::vector<Landmark> &landmark, const std::vector<Eigen::Vector3d> &place,
                              FitReport &report, unsigned threads) const {
    if (!IsAllFree())
        throw BadInput(
            "A start cannot move the surface while vertices are fixed or handles: start from where the layers lie.");
    std::vector<Eigen::Vector3d> from;
    const bool byAxes = param.start == FitStart::TriedAxes || report.fromAfar;
    const auto &node = samples.surfaceNode;
    for (std::size_t s = byAxes ? 0 : matched; s < (byAxes ? matched : matched + place.size()); ++s)
        from.emplace_back(deformer->Whole().surface.graph.position.col(node[s]).cast<double>());
    for (std::size_t l = 0; l < landmark.size() && !byAxes; ++l)
        from[l] += OffsetOf(landmark[l]);
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
        if (each.offset.stableNorm() > rounding)
            continue;
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
