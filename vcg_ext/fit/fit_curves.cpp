// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/error.h>
#include <vcg_ext/fit/fit_curves.h>

#include <algorithm>
#include <limits>
#include <set>
#include <string>

namespace vcg::fcd {

namespace {

// Weight of all curves together: as that of all landmarks together, ten times that of all matches.
constexpr double curvesCount = 10;

// Frame units: a shorter line is a point, for floats.
constexpr double noLength = 1e-6;

struct Foot {
    Eigen::Vector3d place, along; // the nearest point, and the curve's direction there: length 1, or 0 beyond an end
};

// Segments a box: of n segments, a point looks at n / 64 boxes, and at the segments of one or two of these.
constexpr std::size_t boxed = 64;

std::vector<Eigen::AlignedBox3d> BoxesOf(const std::vector<Eigen::Vector3d> &line) {
    std::vector<Eigen::AlignedBox3d> boxes((line.size() + boxed - 2) / boxed);
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
        boxes[k / boxed].extend(line[k]).extend(line[k + 1]);
    return boxes;
}

/// Sets \p best if some segments of a polyline have a point nearer to \p x. \param least in, out: squared distance
void LookAt(const std::vector<Eigen::Vector3d> &line, std::size_t begin, std::size_t end, const Eigen::Vector3d &x,
            double &least, Foot &best) {
    const bool isClosed = line.front() == line.back();
    for (std::size_t k = begin; k < end; ++k) {
        const Eigen::Vector3d offset = line[k + 1] - line[k];
        const double square = offset.squaredNorm(), at = square > 0 ? offset.dot(x - line[k]) / square : 0,
                     t = std::clamp(at, 0.0, 1.0);
        const Eigen::Vector3d place = line[k] + t * offset;
        if (const double far = (x - place).squaredNorm(); far < least) {
            least = far;
            const bool isBeyond = !isClosed && ((k == 0 && at < 0) || (k + 2 == line.size() && at > 1));
            best = {place, isBeyond || square == 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(offset.normalized())};
        }
    }
}

/// The point of a polyline nearest to \p x.
Foot NearestOn(const std::vector<Eigen::Vector3d> &line, const std::vector<Eigen::AlignedBox3d> &boxes,
               const Eigen::Vector3d &x) {
    Foot best{line[0], Eigen::Vector3d::Zero()};
    double least = std::numeric_limits<double>::infinity();
    const auto nearer = [&x](const Eigen::AlignedBox3d &a, const Eigen::AlignedBox3d &b) {
        return a.squaredExteriorDistance(x) < b.squaredExteriorDistance(x);
    };
    const auto first = std::size_t(std::min_element(boxes.begin(), boxes.end(), nearer) - boxes.begin());
    const auto look = [&](std::size_t b) {
        LookAt(line, b * boxed, std::min((b + 1) * boxed, line.size() - 1), x, least, best);
    };
    look(first);
    for (std::size_t b = 0; b < boxes.size(); ++b)
        if (b != first && boxes[b].squaredExteriorDistance(x) < least)
            look(b);
    return best;
}

} // namespace

FitCurves::FitCurves(const std::vector<Curve> &curves, const std::vector<Index> &nodeOf, const RegionDeformer &deformer,
                     const RegionPose &pose, FitSamples &samples)
    : curves(curves), first(samples.Size()) {
    for (std::size_t c = 0; c < curves.size(); ++c) {
        const std::string name = "Curve " + std::to_string(c + 1);
        if (curves[c].target.size() < 2)
            throw BadInput(name + " has fewer than two points. Give at least two on the target, in their order.");
        for (const Eigen::Vector3d &corner : curves[c].target)
            if (!corner.allFinite())
                throw BadInput(name + " has a point that is not finite.");
        boxes.push_back(BoxesOf(curves[c].target));
        Eigen::AlignedBox3d box;
        for (const Eigen::AlignedBox3d &each : boxes.back())
            box.extend(each);
        if (!(box.diagonal().norm() > noLength))
            throw BadInput(
                name +
                " has all its points on the target at one place. Give more of the line, or that place as a landmark.");
        std::set<Index> taken;
        const std::vector<Eigen::Vector3d> &offset = curves[c].offset;
        if (!offset.empty() && offset.size() != curves[c].vertex.size())
            throw BadInput(name + " has " + std::to_string(offset.size()) +
                           " offsets. Give one for each vertex, or none at all.");
        for (std::size_t v = 0; v < curves[c].vertex.size(); ++v) {
            const std::size_t vertex = curves[c].vertex[v];
            const Index node = vertex < nodeOf.size() ? nodeOf[vertex] : -1;
            if (node < 0 || deformer.held.tag[node] != 1)
                throw BadInput(name + " has vertex " + std::to_string(vertex) +
                               ", which does not exist, is not free, or belongs to a loose part. Leave it out.");
            if (!taken.insert(node).second)
                continue;
            samples.Add(deformer, pose, node, offset.empty() ? Eigen::Vector3d::Zero() : offset[v]);
            curveOf.push_back(c);
        }
    }
}

void FitCurves::Find(const FitSamples &samples, const GraphPose &pose, std::vector<FitSystem::Pull> &pull) const {
    for (std::size_t s = 0; s < curveOf.size(); ++s) {
        const Eigen::Vector3d x = samples.At(first + s, pose);
        const Foot foot = NearestOn(curves[curveOf[s]].target, boxes[curveOf[s]], x);
        FitSystem::Pull &each = pull[first + s];
        each.form =
            curvesCount / double(curveOf.size()) * (Eigen::Matrix3d::Identity() - foot.along * foot.along.transpose());
        each.gradient = each.form * (x - foot.place);
    }
}

double FitCurves::Farthest(const FitSamples &samples, const GraphPose &pose) const {
    double most = 0;
    for (std::size_t s = 0; s < curveOf.size(); ++s) {
        const Eigen::Vector3d x = samples.At(first + s, pose);
        most = std::max(most, (x - NearestOn(curves[curveOf[s]].target, boxes[curveOf[s]], x).place).norm());
    }
    return most;
}

} // namespace vcg::fcd
