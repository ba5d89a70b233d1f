// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/line/line_jitter.h>
#include <vcg_ext/straighten.h>
#include <vcg_ext/straighten/line_places.h>
#include <vcg_ext/straighten/line_sections.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace vcg::fcd {

StraightenParam::StraightenParam() {
    bendsUnheld = true;
    graph.initialPatches = 1000; // patches are no wider than a body that is fifty times as long as it is thick
}

Handles AllFree(std::size_t slots, const Eigen::Affine3d &world) {
    Handles handles;
    handles.tag.assign(slots, 1);
    handles.world = world;
    return handles;
}

namespace {

using detail::ToWorld;

/// Constrains the node nearest to the line in each component of the graph that has no constrained node.
void ConstrainComponents(const Csr &adjacency, const FramedLine &line, const Eigen::Matrix3Xd &position,
                         const std::vector<double> &place, std::vector<bool> &constrained) {
    std::vector<char> seen(constrained.size(), 0);
    for (Index first = 0; first < adjacency.Size(); ++first) {
        if (seen[first])
            continue;
        std::vector<Index> component(1, first);
        seen[first] = 1;
        std::pair<double, Index> nearest(std::numeric_limits<double>::infinity(), first);
        bool hasConstraint = false;
        for (std::size_t n = 0; n < component.size(); ++n) {
            const Index j = component[n];
            hasConstraint = hasConstraint || constrained[j];
            nearest = std::min(nearest, {(line.At(place[j]).point - position.col(j)).norm(), j});
            for (Index i : adjacency[j])
                if (!seen[i]) {
                    seen[i] = 1;
                    component.push_back(i);
                }
        }
        if (!hasConstraint)
            constrained[std::size_t(nearest.second)] = true;
    }
}

/// Sets report.releasedAt: the ranges of the line that patches of released nodes cover.
void ListReleased(const std::vector<double> &place, const std::vector<bool> &constrained, const DeformationGraph &graph,
                  double scale, StraightenReport &report) {
    std::vector<std::pair<double, double>> at;
    for (std::size_t j = 0; j < constrained.size(); ++j)
        if (!constrained[j]) {
            const double reach = double(graph.radius[j]) * scale;
            at.emplace_back(std::clamp(place[j] - reach, 0.0, report.length),
                            std::clamp(place[j] + reach, 0.0, report.length));
        }
    std::sort(at.begin(), at.end());
    for (const auto &each : at)
        if (!report.releasedAt.empty() && each.first <= report.releasedAt.back().second)
            report.releasedAt.back().second = std::max(report.releasedAt.back().second, each.second);
        else
            report.releasedAt.push_back(each);
}

/// Measures by what share cross-sections get longer along a line, one part of the line after the other.
class Lengthening {
  public:
    /// \param at place, as a share of the line \param node of the sample \param goesAlong whether that moves along
    void Add(double at, const LineMotion::Moved &node, double weight, bool goesAlong) {
        Part &to = part[std::size_t(std::clamp(at, 0.0, 0.999) * double(part.size()))];
        to.area += weight;
        to.change += weight * (node.stretch - 1);
        to.isWhole = to.isWhole && goesAlong;
    }
    /// The rms of all parts that move with the line.
    double Rms() const {
        double squares = 0, all = 0;
        for (const Part &each : part)
            if (each.isWhole && each.area > 0) {
                squares += each.change * each.change / each.area;
                all += each.area;
            }
        return all > 0 ? std::sqrt(squares / all) : 0;
    }

  private:
    struct Part {
        double area = 0, change = 0;
        bool isWhole = true;
    };
    std::array<Part, 20> part; // with some 200 samples each, whose mean is known to 0.02 in tight bends
};

/// Sets report.rms, report.largest and report.lengthening.
void MeasureDifference(const RegionDeformer &deformer, const ToWorld &toWorld, const LineMotion &motion,
                       const std::vector<double> &place, const std::vector<bool> &constrained, const RegionPose &pose,
                       const Progress &progress, StraightenReport &report) {
    progress(0, "Following the line");
    const GraphMapping::Posed mapped = deformer.mapping->At(pose.graph, pose.motion, {}, progress.threads);
    Lengthening lengthening;
    double squares = 0;
    std::size_t count = 0;
    for (const detail::LineSample &each :
         detail::SamplesAlong(motion.From(), deformer, toWorld, place, 4000, progress)) {
        const Index patch = deformer.patches.patchOf[std::size_t(each.node)];
        bool isOfLine = constrained[patch]; // and so are all nodes around it
        for (Index i : deformer.graph.graph.adjacency[patch])
            isOfLine = isOfLine && constrained[i];
        const LineMotion::Moved moved = motion.At(each.s, each.at);
        lengthening.Add(each.s / report.length, moved, each.weight, isOfLine);
        if (!isOfLine)
            continue;
        const Eigen::Vector3d at = toWorld(mapped(each.node, toWorld.Back(each.at)));
        const double off = (at - moved.position).norm();
        squares += off * off;
        report.largest = std::max(report.largest, off);
        ++count;
    }
    report.rms = count > 0 ? std::sqrt(squares / double(count)) : 0;
    report.lengthening = lengthening.Rms();
    progress(1, "Following the line");
}

/// The points of a line without jitter, unless smoothing is given.
SteadyPoints Steady(const Eigen::Matrix3Xd &points, double smoothing, double thickness) {
    return smoothing > 0 || !(thickness > 0) ? SteadyPoints{points, 0} : WithoutJitter(points, thickness);
}

/// A stretch that few points, or some jitter, leave along a straight body. A line that lies wrong makes tenths.
constexpr double unclear = 0.03;

/// The line through the middles of the cross-sections along \p line; empty: it would stretch the surface more.
/// \throw BadInput as MiddleOf
Eigen::Matrix3Xd BetterMiddle(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
                              double smoothing, const Progress &progress) {
    Eigen::Matrix3Xd middle = detail::MiddleOf(deformer, world, line, progress.Slice(0, 0.8));
    const FramedLine through(middle, smoothing);
    const double before = detail::StretchAlong(deformer, world, line, progress.Slice(0.8, 0.9)),
                 after = detail::StretchAlong(deformer, world, through, progress.Slice(0.9, 1));
    return after <= std::max(before, unclear * unclear) ? middle : Eigen::Matrix3Xd();
}

/// Whether a line lies to one side of the surface, so that the surface gets longer or shorter than the line. A line
/// that was moved into the middle lies where it can: the middles along it may be others, but nobody can ask for these.
bool IsBeside(const RegionDeformer &deformer, const Eigen::Affine3d &world, const FramedLine &line,
              const StraightenReport &report, const Progress &progress) {
    if (!(report.lengthening > unclear) || report.isMiddle || report.leftMiddle)
        return false;
    try {
        return BetterMiddle(deformer, world, line, 0, progress).cols() > 0;
    } catch (const BadInput &) { // it has no middle
        return false;
    }
}

/// \throw BadInput less than half of the line lies in the box of the surface
void ExpectInside(const FramedLine &line, const RegionDeformer &deformer, const Eigen::Affine3d &world) {
    const ToWorld toWorld(deformer.surface.frame, world);
    Eigen::AlignedBox3d box;
    for (Index u = 0; u < deformer.surface.graph.Size(); ++u)
        box.extend(toWorld(deformer.surface.graph.position.col(u).cast<double>()));
    const Eigen::Vector3d hair =
        Eigen::Vector3d::Constant(0.01 * box.diagonal().stableNorm()); // for lines on the surface
    box.extend(Eigen::Vector3d(box.min() - hair));
    box.extend(Eigen::Vector3d(box.max() + hair));
    const int places = 100;
    int inside = 0;
    for (int i = 0; i < places; ++i)
        inside += box.contains(line.At(line.Length() * (i + 0.5) / places).point);
    if (2 * inside < places)
        throw BadInput("The line is outside of the surface: " + std::to_string(places - inside) +
                       " percent of it lie beside the surface's box. Give it in world coordinates, along the surface "
                       "or through its middle.");
}

} // namespace

Eigen::Matrix3Xd LineOf(const LineGoal &goal, const Deformer &prepared, const Eigen::Affine3d &world,
                        const Progress &progress, StraightenReport *report) {
    const RegionDeformer &deformer = prepared.Whole();
    const FramedLine given(goal.line, goal.smoothing);
    ExpectInside(given, deformer, world);
    if (goal.isFound)
        return goal.line;
    const double thickness = detail::ThicknessAlong(deformer, world, given, progress.Slice(0, 0.1));
    const SteadyPoints steady = Steady(goal.line, goal.smoothing, thickness);
    if (report)
        report->jitter = steady.jitter;
    if (!goal.middle)
        return steady.point;
    const FramedLine line(steady.point, goal.smoothing);
    const Eigen::Matrix3Xd middle = BetterMiddle(deformer, world, line, goal.smoothing, progress.Slice(0.1, 1));
    if (report) {
        report->isMiddle = middle.cols() > 0;
        report->leftMiddle = !report->isMiddle;
    }
    return middle.cols() > 0 ? middle : steady.point;
}

LineMotion MotionTo(LineGoal goal, const Deformer &prepared, const Eigen::Affine3d &world, StraightenReport &report,
                    const Progress &progress) {
    const RegionDeformer &deformer = prepared.Whole();
    goal.line = LineOf(goal, prepared, world, progress, &report);
    if (goal.target.cols() > 0)
        goal.target =
            Steady(goal.target, goal.smoothing,
                   detail::ThicknessAlong(deformer, world, FramedLine(goal.line, goal.smoothing), progress.Slice(1, 1)))
                .point;
    LineMotion motion = MotionTo(goal);
    report.length = motion.From().Length();
    report.newLength = motion.Length();
    if (goal.untwist) {
        motion.twist = detail::TwistOf(deformer, world, motion.From());
        report.twist = (motion.twist(0).angle - motion.twist(report.length).angle) * 180 / double(EIGEN_PI);
    }
    return motion;
}

Deformer::Pose Straighten(const Deformer &prepared, const Eigen::Affine3d &world, const LineMotion &motion,
                          const DeformationParam &param, StraightenReport &report, const Progress &progress) {
    const RegionDeformer &deformer = prepared.Whole();
    const DeformationGraph &graph = deformer.graph;
    const FramedLine &line = motion.From();
    const Index k = graph.Size();
    const ToWorld toWorld(deformer.surface.frame, world);
    const Eigen::Matrix3Xd rest = detail::NodesOf(deformer, toWorld);
    progress(0, "Following the line");
    const std::vector<double> place = detail::PlacesAlong(line, graph.graph.adjacency, rest);

    std::vector<LineMotion::Moved> moved;
    NodeConstraints given;
    given.compliant.assign(std::size_t(k), false);
    given.heldArea.assign(std::size_t(k), 0);
    double farthest = 0; // largest move of a node, frame units, or change of its linear map
    for (Index j = 0; j < k; ++j) {
        const LineMotion::Moved &node = moved.emplace_back(motion.At(place[j], rest.col(j)));
        const Eigen::Vector3d before = toWorld.Back(rest.col(j)), after = toWorld.Back(node.position);
        farthest = std::max({farthest, (after - before).norm(), (node.linear - Eigen::Matrix3d::Identity()).norm()});
        Eigen::Affine3d rigid;
        rigid.linear() = node.turn;
        rigid.translation() = after - node.turn * before;
        given.motion.push_back(rigid);
        given.constrained.push_back(!node.isFolded && node.stretch < detail::mostStretch &&
                                    node.stretch > 1 / detail::mostStretch);
    }
    // The surface would tear where neighbours lie far apart along the line.
    const double ratio = std::max(1.0, motion.Length() / line.Length());
    std::vector<char> tears(std::size_t(k), 0);
    for (Index j = 0; j < k; ++j)
        for (Index i : graph.graph.adjacency[j]) {
            const Eigen::Vector3d offset = rest.col(j) - rest.col(i);
            const LineMotion::Moved &a = moved[i], &b = moved[j];
            const Eigen::Vector3d expected = 0.5 * (a.linear + b.linear) * offset;
            tears[j] |= (b.position - a.position - expected).norm() > 0.5 * ratio * offset.norm();
        }
    for (Index j = 0; j < k; ++j)
        if (tears[j])
            given.constrained[j] = false;
    ConstrainComponents(graph.graph.adjacency, line, rest, place, given.constrained);

    Deformer::Pose all = prepared.Solve(AllFree(0, world), param, progress.Slice(0, 0.1));
    RegionPose &pose = all.region[0];
    report.released = Index(std::count(given.constrained.begin(), given.constrained.end(), false));
    report.following = k - report.released;
    GraphPose solved;
    if (report.released > 0) {
        solved = PartsDeformer(graph, graph.area, given, param.shape.heldDepth, progress.Slice(0.1, 0.1))
                     .Solve(given, param, progress.Slice(0.1, 0.8));
        all.iterations = pose.iterations = solved.iterations;
    } else {
        solved = pose.solved;
        for (Index j = 0; j < k; ++j) {
            solved.position.col(j) = toWorld.Back(moved[j].position);
            solved.linear[j] = moved[j].turn;
        }
    }
    // A move by no more than rounding is none.
    solved.moves = farthest > 1e-12;
    solved.rests.assign(std::size_t(k), !solved.moves);
    MeasureEnergy(graph, param.smoothness * deformer.surface.area, solved);
    pose.solved = solved;
    pose.graph = solved;
    FitLinear(graph, given.constrained, pose.graph, param.shape.openness);
    for (Index j = 0; j < k; ++j)
        if (given.constrained[j])
            pose.graph.linear[j] = moved[j].linear;
    pose.nodeMotion = given.motion;

    ListReleased(place, given.constrained, graph, toWorld.scale, report);
    MeasureDifference(deformer, toWorld, motion, place, given.constrained, pose, progress.Slice(0.8, 0.9), report);
    report.isBeside = IsBeside(deformer, world, line, report, progress.Slice(0.9, 1));
    all.converged = solved.converged;
    all.energy = solved.energy * toWorld.scale * toWorld.scale;
    return all;
}

std::vector<float> PlacesOfVertices(const SurfaceView &mesh, const Deformer &prepared, const Eigen::Affine3d &world,
                                    const FramedLine &line, const Progress &progress) {
    const RegionDeformer &deformer = prepared.Whole();
    const ToWorld toWorld(deformer.surface.frame, world);
    const std::vector<double> place =
        detail::PlacesAlong(line, deformer.graph.graph.adjacency, detail::NodesOf(deformer, toWorld));
    std::vector<float> places(mesh.vertexSlots, 0);
    ParallelForEach(progress, "Following the line", places.size(), 1 << 12, [&](std::size_t i) {
        if (mesh.IsDeleted(i))
            return;
        const Eigen::Vector3d p = world * Eigen::Vector3d(mesh.At(i));
        const Index node = prepared.nodeOf[i];
        const bool isLoose = node < 0 || deformer.patches.patchOf[node] < 0;
        places[i] = float(isLoose ? line.Nearest(p, 0, line.Length())
                                  : detail::PlaceNear(line, deformer, toWorld, place, node, p));
    });
    return places;
}

} // namespace vcg::fcd
