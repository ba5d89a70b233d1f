// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/fit_contradictions.h>
#include <vcg_ext/fit/fit_landmarks.h>
#include <vcg_ext/fit/fit_target.h>
#include <vcg_ext/symmetrize.h>
#include <vcg_ext/symmetry/best_plane.h>
#include <vcg_ext/symmetry/half_pose.h>
#include <vcg_ext/warp/smooth_warp.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <string>
#include <utility>

namespace vcg::fcd {

using detail::ToWorld;

namespace {

// Points that plane and warp are found with: enough for the 168 numbers of the warp to be left with a third of the
// noise.
constexpr std::size_t places = 2000;
// Degree of the warp. A bend by half a radian to each side needs degree 5 to be met to a thousandth of the diagonal
// (the series of the cosine of twice the bend ends with the power of 4, and it is sheared); more would follow single
// features.
constexpr int degree = 5;
// Weight of landmarks over that of the surface: more than a match has along the surface (a hundredth).
constexpr double landmarkWeight = 0.1;
// Landmarks nearer to each other than this, frame units, count as one for the warp: half of its shortest wave. (One of
// degree 5 has its extremes a fifth of the surface apart, a tenth near the ends.) Else it follows their errors there,
// and swings elsewhere.
constexpr double oneLandmark = 0.05;

/// Landmarks in the order of the fit: both ends of each pair, then the midline.
struct Marks {
    std::vector<std::size_t> vertex, partner; // slot of the vertex; number of the partner
    MirrorPairs place;                        // of the landmark, and of its partner, frame units
    std::vector<Eigen::Vector3d> beside;      // from the landmark to its vertex, frame units
    std::size_t pairs = 0;                    // number of pairs

    /// The counterpart of a landmark's vertex: the partner, plus the mirror image of the offset to the vertex.
    Eigen::Vector3d Partner(std::size_t l, const MirrorPlane &plane) const {
        return place[l].second + plane.Turn(beside[l]);
    }
};

Marks MarksOf(const SymmetryGoal &goal, const SurfaceView &source, const Frame &frame, const ToWorld &world) {
    Marks marks;
    marks.pairs = goal.pairs.size();
    const auto add = [&](const SymmetryMark &mark, const SymmetryMark &partner, std::size_t number) {
        if (mark.vertex >= source.vertexSlots || source.IsDeleted(mark.vertex))
            throw BadInput("Vertex " + std::to_string(mark.vertex) +
                           " of the pairs or the midline is no vertex of the surface. Give numbers from 0, or places.");
        marks.vertex.push_back(mark.vertex);
        marks.partner.push_back(number);
        marks.place.emplace_back(world.Back(mark.place), world.Back(partner.place));
        marks.beside.emplace_back(frame.ToFrame(Eigen::Vector3d(source.At(mark.vertex))) - marks.place.back().first);
    };
    for (const auto &[a, b] : goal.pairs) {
        add(a, b, marks.vertex.size() + 1);
        add(b, a, marks.vertex.size() - 1);
    }
    for (const SymmetryMark &each : goal.midline)
        add(each, each, marks.vertex.size());
    std::vector<std::size_t> sorted = marks.vertex;
    std::sort(sorted.begin(), sorted.end());
    if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
        throw BadInput("Vertex " + std::to_string(*twice) +
                       " is named twice in the pairs and the midline. A vertex has one partner; if it is its own "
                       "partner, put it into the midline.");
    return marks;
}

/// Adds the landmarks to the goal of a warp onto the mirror image; of those that count as one, the mean.
void AddTo(WarpGoal &goal, const MirrorPairs &landmarks, const MirrorPlane &plane) {
    std::vector<Eigen::Vector3d> first; // of those that count as one
    std::vector<double> count;
    for (const auto &[place, partner] : landmarks) {
        const auto same = std::find_if(first.begin(), first.end(), [&, p = place](const Eigen::Vector3d &each) {
            return (each - p).norm() < oneLandmark;
        });
        const auto k = std::size_t(same - first.begin());
        if (same == first.end()) {
            first.push_back(place);
            count.push_back(0);
            goal.from.emplace_back(Eigen::Vector3d::Zero());
            goal.to.emplace_back(Eigen::Vector3d::Zero());
        }
        goal.from[k] += place;
        goal.to[k] += plane(partner);
        ++count[k];
    }
    for (std::size_t k = 0; k < count.size(); ++k) {
        goal.from[k] /= count[k];
        goal.to[k] /= count[k];
    }
}

/// The landmarks without some. \param without numbers of pairs, then midline points, ascending \param number in, out:
/// of each landmark that is left, its number in the first goal
SymmetryGoal Without(const SymmetryGoal &goal, const std::vector<std::size_t> &without,
                     std::vector<std::size_t> &number) {
    SymmetryGoal rest;
    rest.plane = goal.plane;
    std::vector<std::size_t> left;
    for (std::size_t l = 0; l < goal.pairs.size() + goal.midline.size(); ++l)
        if (!std::binary_search(without.begin(), without.end(), l)) {
            if (l < goal.pairs.size())
                rest.pairs.push_back(goal.pairs[l]);
            else
                rest.midline.push_back(goal.midline[l - goal.pairs.size()]);
            left.push_back(number[l]);
        }
    number = std::move(left);
    return rest;
}

MirrorPlane InFrame(const MirrorPlane &plane, const ToWorld &world) {
    if (!plane.point.allFinite() || !plane.normal.allFinite() || !(plane.normal.norm() > 0))
        throw BadInput("The plane has no direction: give a point on it, and its normal, of any length but 0.");
    return {world.Back(plane.point), plane.normal.normalized()};
}

} // namespace

/// Symmetrize with all landmarks. If the fit leaves some out, the poses are none.
static SymmetricPose Follow(const Fitter &fitter, const SurfaceView &source, const NormalOf &normal,
                            const Eigen::Affine3d &world, const SymmetryGoal &goal, SymmetryReport &report,
                            const Progress &progress, const WeightOf &weight) {
    const RegionDeformer &region = fitter.Surface().Whole();
    const Frame &frame = region.surface.frame;
    const ToWorld inWorld(frame, world);
    const Marks marks = MarksOf(goal, source, frame, inWorld);
    const std::vector<float> nodeWeight =
        weight ? WeightsAtNodes(source, weight, fitter.Surface()) : std::vector<float>();
    const std::vector<Index> sample = EvenSample(region, places, nodeWeight);
    WarpGoal warped;
    warped.normal = NormalsAtNodes(source, normal, fitter.Surface(), sample);
    for (Index node : sample) {
        warped.place.emplace_back(region.surface.graph.position.col(node).cast<double>());
        warped.weight.push_back(nodeWeight.empty() ? 1 : double(nodeWeight[node]));
    }
    const auto itself =
        fitter.Prepare({source, normal, world, {}, weight, {}, "surface", true}, progress.Slice(0, 0.1));

    for (std::size_t s = 0; s < warped.place.size(); ++s) // of a cloud without normals: that of the points around
        if (warped.normal[s].isZero(0))
            warped.normal[s] = itself->Nearest(warped.place[s]).normal;

    MirrorPlane plane;
    report.isGiven = goal.plane.has_value();
    if (report.isGiven)
        plane = InFrame(*goal.plane, inWorld);
    else
        plane = PlaneOf(marks.place, {}, report.isOfLandmarks);
    const WarpGoalIn goalIn = [&](const MirrorPlane &in) {
        WarpGoal whole = warped;
        // The warp takes the surface onto its mirror image, as far as it is smooth. Matches are found on the surface
        // itself, for points that are mirrored back.
        const auto hints = std::make_shared<std::vector<NearestPlace::Hint>>(warped.place.size());
        whole.match = [&itself, in, hints](std::size_t s, const Eigen::Vector3d &at) {
            const Eigen::Vector3d back = in(at);
            const FitTarget::Match match = itself->Nearest(back, (*hints)[s]);
            return WarpMatch{in(match.Foot(back)), in.Turn(match.normal), match.isOriented,
                             match.onBorder ? 0 : match.weight};
        };
        AddTo(whole, marks.place, in);
        whole.landmarkWeight = landmarkWeight;
        whole.landmarkNoise = noHand;
        whole.degree = degree;
        return whole;
    };
    if (!report.isGiven && !report.isOfLandmarks)
        plane = BestPlane(FindPlanes(warped.place, warped.normal, *itself, progress.Slice(0.1, 0.2)), goalIn,
                          report.isSure, progress.Slice(0.2, 0.3));
    report.plane = {inWorld(plane.point), plane.normal};
    const SmoothWarp warp = FitWarp(goalIn(plane), progress.Slice(0.3, 0.45));

    // A fit does the rest. Its target is the mirror image of the warped surface: that lies near the surface at rest,
    // where the fit begins.
    Eigen::Matrix3Xd position(3, Eigen::Index(source.vertexSlots));
    ParallelForEach(progress.threads, source.vertexSlots, 1 << 12, [&](std::size_t i) {
        const Eigen::Vector3d p = source.At(i);
        position.col(Eigen::Index(i)) = source.IsDeleted(i) ? p : frame.FromFrame(plane(warp.At(frame.ToFrame(p))));
    });
    std::vector<std::uint32_t> corner(source.corner, source.corner + 3 * source.faces);
    for (std::size_t f = 0; f < source.faces; ++f) // mirrored faces look inwards: flip them
        if (source.IsFace(f))
            std::swap(corner[3 * f + 1], corner[3 * f + 2]);
    SurfaceView mirrored = source.With(position);
    mirrored.corner = corner.data();
    const NormalOf mirroredNormal = [&](std::size_t i) -> Eigen::Vector3d {
        const Eigen::Vector3d n = frame.metric.inverse().transpose() * normal(i);
        const Eigen::Matrix3d linear = warp.LinearAt(frame.ToFrame(Eigen::Vector3d(source.At(i))));
        return frame.metric.transpose() * plane.Turn(linear.inverse().transpose() * n);
    };
    SymmetricPose made;
    try {
        made.target =
            fitter.Prepare({mirrored, normal ? mirroredNormal : NormalOf(), world, {}, weight, {}, "surface", true},
                           progress.Slice(0.45, 0.55));
    } catch (const BadInput &) { // the surface itself was one: the warp has pressed it together
        throw BadInput(
            "The surface is not at all like its mirror image in this plane. Give pairs, a midline or another plane.");
    }
    std::vector<Landmark> landmarks;
    landmarks.reserve(marks.vertex.size());
    for (std::size_t l = 0; l < marks.vertex.size(); ++l)
        landmarks.push_back({marks.vertex[l], inWorld(plane(warp.At(marks.Partner(l, plane))))});
    made.fitted = fitter.Solve(*made.target, landmarks, report.fit, progress.Slice(0.55, 0.95));
    for (std::size_t each : report.fit.contradicted) {
        const std::size_t number = each < 2 * marks.pairs ? each / 2 : each - marks.pairs;
        if (report.contradicted.empty() || report.contradicted.back() != number)
            report.contradicted.push_back(number);
    }
    if (report.fit.leftOut)
        return {};

    // The fit puts points at the mirror images of their warped counterparts; undo the warp.
    const auto put = [](Deformer::Pose &pose, const GraphPose &graph) {
        pose.region[0].solved = pose.region[0].graph = graph;
    };
    GraphPose whole = made.fitted.region[0].solved;
    whole.moves = true;
    for (Index j = 0; j < region.graph.Size(); ++j) {
        const Eigen::Vector3d at = plane(whole.position.col(j));
        const Eigen::Vector3d from = warp.Back(at, at);
        whole.position.col(j) = plane(from);
        whole.linear[j] = plane.Linear() * warp.LinearBack(from) * plane.Linear() * whole.linear[j];
    }
    GraphPose half = HalfPose(region.graph, whole);
    if (!marks.vertex.empty()) {
        FitSamples samples;
        std::vector<Eigen::Vector3d> at, goals;
        for (std::size_t l = 0; l < marks.vertex.size(); ++l) {
            samples.Add(region, made.fitted.region[0], fitter.Surface().nodeOf[marks.vertex[l]]);
            at.emplace_back(samples.At(l, half) - marks.beside[l]); // of the landmark
        }
        for (std::size_t l = 0; l < at.size(); ++l) {
            const Eigen::Vector3d middle = 0.5 * (at[l] + plane(at[marks.partner[l]]));
            goals.emplace_back(middle + marks.beside[l]);
            report.landmarks = std::max(report.landmarks, 2 * (middle - at[l]).norm() * frame.scale);
        }
        const std::vector<char> isFree(std::size_t(region.graph.Size()), 1);
        MoveTowards(samples, 0, goals, isFree, half);
    }
    made.half = made.mirror = made.fitted;
    put(made.half, half);
    put(made.mirror, whole);

    FitSamples drawn;
    for (Index node : sample)
        drawn.Add(region, made.fitted.region[0], node);
    for (std::size_t s = 0; s < drawn.Size(); ++s) {
        const double far = (drawn.At(s, whole) - warped.place[s]).norm(),
                     moved = (drawn.At(s, half) - warped.place[s]).norm();
        report.asymmetry += far * far / double(drawn.Size());
        report.asymmetryMost = std::max(report.asymmetryMost, far);
        report.moved += moved * moved / double(drawn.Size());
        report.movedMost = std::max(report.movedMost, moved);
    }
    report.asymmetry = std::sqrt(report.asymmetry) * frame.scale;
    report.asymmetryMost *= frame.scale;
    report.moved = std::sqrt(report.moved) * frame.scale;
    report.movedMost *= frame.scale;
    progress(1, "Making it symmetric");
    return made;
}

SymmetricPose Symmetrize(const Fitter &fitter, const SurfaceView &source, const NormalOf &normal,
                         const Eigen::Affine3d &world, const SymmetryGoal &goal, SymmetryReport &report,
                         const Progress &progress, const WeightOf &weight) {
    const LoopHelpers helpers;
    report = {};
    SymmetricPose made = Follow(fitter, source, normal, world, goal, report, progress.Slice(0, 0.9), weight);
    // Landmarks that are left out have led plane and warp, so begin again without them.
    std::vector<std::size_t> number(goal.pairs.size() + goal.midline.size()), without;
    std::iota(number.begin(), number.end(), 0);
    SymmetryGoal rest = goal;
    while (report.fit.leftOut) {
        for (std::size_t each : report.contradicted)
            without.push_back(number[each]);
        rest = Without(rest, report.contradicted, number);
        report = {};
        made = Follow(fitter, source, normal, world, rest, report, progress.Slice(0.9, 1), weight);
    }
    if (!without.empty()) {
        std::sort(without.begin(), without.end());
        report.contradicted = std::move(without);
        report.leftOut = true;
    }
    return made;
}

void PutPartners(const Fitter &fitter, const SurfaceView &source, const Eigen::Affine3d &world,
                 const SymmetryGoal &goal, const SymmetryReport &report, Eigen::Ref<Eigen::Matrix3Xd> position) {
    const double rounding = 1e-5 * fitter.Surface().Whole().surface.frame.scale;
    const auto at = [&](std::size_t vertex) -> Eigen::Vector3d { return world * position.col(Eigen::Index(vertex)); };
    const auto isVertex = [&](const SymmetryMark &mark) {
        return (world * Eigen::Vector3d(source.At(mark.vertex)) - mark.place).stableNorm() <= 1e-6 * rounding;
    };
    const Eigen::Affine3d back = world.inverse();
    const std::vector<Index> &nodeOf = fitter.Surface().nodeOf;
    std::map<Index, Eigen::Vector3d> placed; // by node, so with all vertices at one position
    const auto put = [&](std::size_t vertex, const Eigen::Vector3d &to) {
        if ((at(vertex) - to).stableNorm() <= rounding)
            placed[nodeOf[vertex]] = back * to;
    };
    for (const auto &[a, b] : goal.pairs)
        if (isVertex(a) && isVertex(b)) {
            const Eigen::Vector3d middle = 0.5 * (at(a.vertex) + report.plane(at(b.vertex)));
            put(a.vertex, middle);
            put(b.vertex, report.plane(middle));
        }
    for (const SymmetryMark &each : goal.midline)
        if (isVertex(each))
            put(each.vertex, report.plane.Onto(at(each.vertex)));
    for (std::size_t i = 0; i < source.vertexSlots && !placed.empty(); ++i)
        if (const auto found = placed.find(nodeOf[i]); nodeOf[i] >= 0 && found != placed.end())
            position.col(Eigen::Index(i)) = found->second;
}

} // namespace vcg::fcd
