// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/fit_samples.h>
#include <vcg_ext/fit/one_sided.h>
#include <vcg_ext/map/normals.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

namespace vcg::fcd {

void FitSamples::Add(const RegionDeformer &deformer, const RegionPose &pose, Index node,
                     const Eigen::Vector3d &offset) {
    GraphMapping::Influences influences;
    deformer.mapping->InfluencesAt(node, influences);
    const Eigen::Vector3d p = deformer.surface.graph.position.col(node).cast<double>() + offset;
    const auto rest = [&](Index j) { return deformer.graph.graph.position.col(j).cast<double>(); };
    double sum = 0;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const auto &each : influences.nodes) {
        sum += double(each.second);
        middle += double(each.second) * rest(each.first);
    }
    middle /= sum;
    double all = sum; // 1 but for the rounding of floats, which would show far from the origin
    for (const auto &each : influences.held)
        all += double(each.second);
    for (const auto &each : influences.nodes)
        term.push_back({each.first, double(each.second) / all, p - 0.5 * (rest(each.first) + middle)});
    begin.push_back(std::uint32_t(term.size()));
    Eigen::Vector3d ofHeld = Eigen::Vector3d::Zero();
    for (const auto &each : influences.held)
        ofHeld += double(each.second) / all * (pose.motion.at(each.first) * p);
    fixed.push_back(ofHeld);
    normal.emplace_back(Eigen::Vector3d::Zero());
    weight.push_back(1);
    surfaceNode.push_back(node);
}

void FitSamples::Shrink(std::size_t size) {
    begin.resize(size + 1);
    term.resize(begin.back());
    fixed.resize(size);
    normal.resize(size);
    weight.resize(size);
    surfaceNode.resize(size);
}

FitSamples FitSamples::From(std::size_t first) const {
    FitSamples rest;
    rest.term.assign(term.begin() + begin[first], term.end());
    for (std::size_t s = first; s < Size(); ++s)
        rest.begin.push_back(begin[s + 1] - begin[first]);
    rest.fixed.assign(fixed.begin() + std::ptrdiff_t(first), fixed.end());
    rest.surfaceNode.assign(surfaceNode.begin() + std::ptrdiff_t(first), surfaceNode.end());
    rest.normal.assign(Size() - first, Eigen::Vector3d::Zero());
    rest.weight.assign(weight.begin() + std::ptrdiff_t(first), weight.end());
    rest.isAffine = isAffine;
    return rest;
}

Eigen::Vector3d FitSamples::At(std::size_t s, const GraphPose &pose) const {
    Eigen::Vector3d x = fixed[s];
    for (std::uint32_t t = begin[s]; t < begin[s + 1]; ++t)
        x +=
            term[t].weight * (pose.linear[std::size_t(term[t].node)] * term[t].lever + pose.position.col(term[t].node));
    return x;
}

std::vector<Eigen::Vector3d> FitSamples::Places(std::size_t count, const GraphPose &pose) const {
    std::vector<Eigen::Vector3d> places;
    places.reserve(count);
    for (std::size_t s = 0; s < count; ++s)
        places.push_back(At(s, pose));
    return places;
}

Eigen::Vector3d FitSamples::NormalAt(std::size_t s, const GraphPose &pose) const {
    Eigen::Vector3d n = Eigen::Vector3d::Zero();
    for (std::uint32_t t = begin[s]; t < begin[s + 1]; ++t)
        n += term[t].weight * (isAffine ? Cofactors(pose.linear[std::size_t(term[t].node)]) * normal[s]
                                        : pose.linear[std::size_t(term[t].node)] * normal[s]);
    const double length = n.norm();
    return length > 0 ? Eigen::Vector3d(n / length) : n;
}

float CheckedWeight(const WeightOf &weight, std::size_t slot, const char *what) {
    const double given = weight(slot);
    if (!(given >= 0 && given <= 1))
        throw BadInput(std::string("The weight of vertex ") + std::to_string(slot) + " of the " + what + " is " +
                       (std::isnan(given) ? "no number" : std::to_string(given)) +
                       ". Give each vertex a weight from 0 to 1; what has 0 is carried along.");
    return float(given);
}

std::vector<float> WeightsAtNodes(const SurfaceView &mesh, const WeightOf &weight, const Deformer &deformer) {
    std::vector<float> least(std::size_t(deformer.Whole().surface.graph.Size()), 1.f);
    for (std::size_t i = 0; i < mesh.vertexSlots; ++i)
        if (!mesh.IsDeleted(i)) {
            const float own = CheckedWeight(weight, i, "surface");
            if (const Index u = deformer.nodeOf[i]; u >= 0)
                least[u] = std::min(least[u], own);
        }
    return least;
}

void ValidateSamples(int samples) {
    // Each takes up to 2 kB, and the error by noise falls with the square root of their number.
    if (samples < 100 || samples > 1000000)
        throw BadInput("At least 100 places have to be matched, and at most 1000000; not " + std::to_string(samples) +
                       ".");
}

std::vector<Index> EvenSample(const RegionDeformer &deformer, std::size_t wanted, const std::vector<float> &weight) {
    const SurfaceGraph &surface = deformer.surface;
    double area = 0;
    std::size_t count = 0;
    const auto isFree = [&](Index u) {
        return deformer.held.tag[u] == 1 && deformer.patches.patchOf[u] >= 0 && (weight.empty() || weight[u] > 0);
    };
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (isFree(u)) {
            area += double(surface.nodeArea[u]);
            ++count;
        }
    std::vector<Index> sample;
    double passed = 0;
    for (Index u = 0; u < surface.graph.Size(); ++u)
        if (isFree(u)) {
            // Along the nodes' order, a space-filling curve: a sample each time that its share of the area has passed.
            passed += area > 0 ? double(surface.nodeArea[u]) / area : 1 / double(count);
            if (passed * double(wanted) >= double(sample.size()) + 0.5 || count <= wanted)
                sample.push_back(u);
        }
    return sample;
}

std::vector<Eigen::Vector3d> NormalsAtNodes(const SurfaceView &mesh, const NormalOf &normal, const Deformer &deformer,
                                            const std::vector<Index> &node, const Progress &progress) {
    const SurfaceGraph &surface = deformer.Whole().surface;
    std::vector<Index> number(std::size_t(surface.graph.Size()), -1);
    for (std::size_t i = 0; i < node.size(); ++i)
        number[std::size_t(node[i])] = Index(i);
    std::vector<Eigen::Vector3d> sum(node.size(), Eigen::Vector3d::Zero());
    if (mesh.isCloud) {
        const Eigen::Matrix3d turn = surface.frame.inverseMetric.transpose();
        for (std::size_t i = 0; normal && i < mesh.vertexSlots; ++i)
            if (const Index u = deformer.nodeOf[i]; u >= 0 && number[u] >= 0)
                sum[std::size_t(number[u])] = turn * normal(i);
    }
    std::vector<Corners> triangle;
    ForTriangles(mesh, deformer.nodeOf, progress.Slice(0, 0.2), [&](const Corners &c) { triangle.push_back(c); });
    const Eigen::Matrix3Xd position = surface.graph.position.cast<double>();
    MakeOneSided(position, triangle, progress.Slice(0.2, 0.9));
    for (const Corners &c : triangle) {
        const Eigen::Vector3d p = position.col(c[0]), a = position.col(c[1]) - p, b = position.col(c[2]) - p;
        for (Index each : c)
            if (const Index i = number[each]; i >= 0)
                sum[i] += a.cross(b);
    }
    for (Eigen::Vector3d &n : sum) {
        const double length = n.stableNorm();
        n = length > 0 ? Eigen::Vector3d(n / length) : Eigen::Vector3d::Zero();
    }
    return sum;
}

} // namespace vcg::fcd
