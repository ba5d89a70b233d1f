// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/graph/border_weights.h>
#include <vcg_ext/graph/common_motion.h>
#include <vcg_ext/graph/held_nodes.h>

#include <algorithm>
#include <limits>

namespace vcg::fcd {

HeldNodes HoldNodes(const SurfaceGraph &surface, const std::vector<int> &slotTag, const std::vector<std::size_t> &point,
                    const Progress &progress) {
    HeldNodes held;
    held.tag = surface.tag;
    const std::vector<Index> alone = NumbersThat(progress, "Reading the handles", surface.graph.Size(), [&](Index u) {
        bool isBesideFree = false;
        for (Index v : surface.graph.adjacency[u]) {
            if (held.tag[v] == held.tag[u])
                return false;
            isBesideFree |= held.tag[v] == 1;
        }
        return isBesideFree && held.tag[u] != 1;
    });
    std::map<std::size_t, std::size_t> isolated; // point handles where there is no surface, by slot
    for (std::size_t i = 0; i < point.size(); ++i) {
        const std::string name = "Point handle " + std::to_string(i + 1);
        const Index node = surface.nodeOf[point[i]];
        std::size_t other = i;
        if (node >= 0 && HeldNodes::IsSingle(held.tag[node]))
            other = std::size_t(std::find(held.pointTag.begin(), held.pointTag.end(), held.tag[node]) -
                                held.pointTag.begin());
        else if (node < 0)
            other = isolated.emplace(point[i], i).first->second;
        if (other != i)
            throw BadInput(name + " is at the same place as point handle " + std::to_string(other + 1) +
                           "; leave one of them out.");
        if ((node < 0 ? slotTag[point[i]] : held.tag[node]) != 1)
            throw BadInput(name + " is at vertex " + std::to_string(point[i]) +
                           ", which is held already; point handles belong where the surface is free.");
        held.pointTag.push_back(node < 0 ? 1 : held.HoldAlone(node, -1));
    }
    for (Index u : alone)
        held.HoldAlone(u, held.tag[u]);
    return held;
}

namespace detail {

void ExpectNear(const Frame &frame, const Eigen::Matrix4d &motion, const std::string &name) {
    const double most = 1e30; // frame units; the largest float is 3e38
    if (!(frame.ToFrame(motion).matrix().cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= most))
        throw BadInput(name +
                       " moves too far: beyond 1e30 times the size of the mesh. Check its motion, and the pose.");
}

void TurnTogether(const DeformationGraph &graph, const std::vector<Index> &tag, const Patches &patches,
                  NodeConstraints &given) {
    std::vector<Eigen::Affine3d> &motion = given.motion;
    const Eigen::Matrix3d rotation = CommonMotion(graph, given.constrained, motion).Rotation();
    for (Index j = 0; j < graph.Size(); ++j)
        if (given.compliant[j] && HeldNodes::IsSingle(tag[patches.center[j]])) {
            const Eigen::Vector3d x = graph.graph.position.col(j).cast<double>(), y = motion[j] * x;
            motion[j].linear() = rotation;
            motion[j].translation() = y - rotation * x;
        }
}

SmallParts FindSmallParts(const Graph &surface, const std::vector<Index> &tag, double D, const ShapeConstants &shape) {
    SmallParts small;
    small.isIn.assign(tag.size(), 0);
    std::vector<char> seen(tag.size(), 0);
    std::vector<Index> part;
    for (Index seed = 0; seed < Index(tag.size()); ++seed) {
        if (tag[seed] == 1 || seen[seed])
            continue;
        seen[seed] = 1;
        part.assign(1, seed);
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < part.size(); ++i) {
            mean += surface.position.col(part[i]).cast<double>();
            for (Index v : surface.adjacency[part[i]])
                if (!seen[v] && tag[v] == tag[seed]) {
                    seen[v] = 1;
                    part.push_back(v);
                }
        }
        const Eigen::Vector3f middle = (mean / double(part.size())).cast<float>();
        Index center = seed;
        for (Index u : part)
            if ((surface.position.col(u) - middle).norm() < (surface.position.col(center) - middle).norm())
                center = u;
        float radius = 0;
        for (Index u : part)
            radius = std::max(radius, (surface.position.col(u) - surface.position.col(center)).norm());
        if (!(radius <= shape.smallHeldPart * D))
            continue;
        Eigen::Vector3d flow = Eigen::Vector3d::Zero();
        double border = 0;
        bool isFree = false;
        for (Index u : part)
            for (Index v : surface.adjacency[u])
                if (tag[v] == 1) {
                    const double w = CotangentWeight(surface, u, v);
                    const Eigen::Vector3d offset = (surface.position.col(v) - surface.position.col(u)).cast<double>();
                    flow += w * offset;
                    border += w * offset.norm();
                    isFree = true;
                }
        if (!isFree || (part.size() > 1 && flow.norm() >= shape.surrounded * border))
            continue;
        small.center.push_back(center);
        small.radius.push_back(radius);
        for (Index u : part)
            small.isIn[u] = 1;
    }
    return small;
}

NodeConstraints ConstrainNodes(const DeformationGraph &graph, const std::vector<Index> &tag, const Patches &patches,
                               const SmallParts &small, const HeldMotions &motions,
                               const std::map<Index, Eigen::Affine3d> &motion) {
    const Index k = graph.Size();
    NodeConstraints given{std::vector<bool>(k), std::vector<bool>(k), std::vector<double>(k, 0),
                          std::vector<Eigen::Affine3d>(k, Eigen::Affine3d::Identity())};
    for (Index j = 0; j < k; ++j) {
        const Index t = tag[patches.center[j]];
        if (t == 1)
            continue;
        const auto rotates = motions.rotates.find(t);
        given.constrained[j] = true;
        given.compliant[j] = !(HeldNodes::IsSingle(t) && rotates != motions.rotates.end() && rotates->second);
        given.heldArea[j] = HeldNodes::IsSingle(t) ? 0 : std::numeric_limits<double>::infinity();
        given.motion[j] = motion.at(t);
    }
    for (std::size_t i = 0; i < small.center.size(); ++i)
        given.heldArea[patches.patchOf[small.center[i]]] = double(EIGEN_PI) * small.radius[i] * small.radius[i];
    return given;
}

void OpenSmallParts(const Graph &surface, const std::vector<Index> &tag, const SmallParts &small, Patches &patches,
                    const Progress &progress) {
    if (small.center.empty())
        return;
    std::vector<Index> open(tag), center;
    for (std::size_t u = 0; u < tag.size(); ++u)
        if (small.isIn[u])
            open[u] = 1;
    std::vector<char> dropped(patches.Size(), 0); // patches with a small part near their centre
    for (Index c : small.center)
        for (Index v : surface.adjacency[c]) {
            const Index p = patches.patchOf[v];
            if (p >= 0)
                dropped[p] |= (surface.position.col(c) - surface.position.col(patches.center[p])).norm() <
                              0.5f * patches.radius[p];
        }
    for (Index p = 0; p < patches.Size(); ++p)
        if (!dropped[p])
            center.push_back(patches.center[p]);
    center.insert(center.end(), small.center.begin(), small.center.end());
    patches = GrowPatches(surface, open, center, progress);
}

} // namespace detail
} // namespace vcg::fcd
