// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/base/error.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/graph/coarse_graph.h>
#include <vcg_ext/solve/discretisation_error.h>
#include <vcg_ext/solve/graph_parts.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace vcg::fcd {

namespace {

/// Moves the nodes of the fine graph by a pose of the coarse one.
class CoarseMapping {
  public:
    CoarseMapping(const CoarseGraph &coarse, const NodeConstraints &constraints, const GraphPose &pose)
        : graph(coarse.graph), constraints(constraints), pose(pose) {}

    /// Like GraphMapping: blends the node's group and that group's neighbours, with the mean of the rotations at both
    /// ends. \param g the group \param x its position at rest, frame units
    Eigen::Vector3d operator()(Index g, const Eigen::Vector3d &x) const {
        const auto begin = graph.graph.adjacency.begin[g], end = graph.graph.adjacency.begin[g + 1];
        double reach = 0; // squared
        for (std::uint32_t e = begin; e < end; ++e)
            reach = std::max(reach, (x - PlaceOf(g, e)).squaredNorm());
        const Eigen::Vector3d own = At(g);
        const auto weightAt = [&](const Eigen::Vector3d &place) {
            const double r = std::min(1.0, (x - place).squaredNorm() / reach);
            return reach > 0 ? (1 - r) * (1 - r) * (1 - r) + 1e-6 : 1;
        };
        Eigen::Matrix3d turn = weightAt(own) * pose.linear[g];
        double sum = weightAt(own);
        for (std::uint32_t e = begin; e < end; ++e) {
            const double w = weightAt(PlaceOf(g, e));
            turn += w * pose.linear[graph.graph.adjacency.item[e]];
            sum += w;
        }
        turn /= sum;
        const auto taken = [&](const Eigen::Vector3d &place, const Eigen::Vector3d &to, Index j) {
            return Eigen::Vector3d(to + 0.5 * ((pose.linear[j] + turn) * (x - place)));
        };
        Eigen::Vector3d moved = weightAt(own) * taken(own, pose.position.col(g), g);
        for (std::uint32_t e = begin; e < end; ++e) {
            const Index j = graph.graph.adjacency.item[e];
            const Eigen::Vector3d place = PlaceOf(g, e);
            const Eigen::Vector3d to = graph.IsHeld(j) ? Eigen::Vector3d(constraints.motion[j] * place)
                                                       : Eigen::Vector3d(pose.position.col(j));
            moved += weightAt(place) * taken(place, to, j);
        }
        return moved / sum;
    }

  private:
    Eigen::Vector3d At(Index g) const { return graph.graph.position.col(g).cast<double>(); }
    /// The neighbour's position at rest or, if it is held, the border of its patch.
    Eigen::Vector3d PlaceOf(Index g, std::uint32_t e) const {
        const Index j = graph.graph.adjacency.item[e];
        return graph.IsHeld(j) ? Eigen::Vector3d(At(g) - graph.edge.col(e).cast<double>()) : At(j);
    }

    const DeformationGraph &graph;
    const NodeConstraints &constraints;
    const GraphPose &pose;
};

} // namespace

double DiscretisationError(const DeformationGraph &graph, const std::vector<double> &area,
                           const NodeConstraints &constraints, const GraphPose &pose, GraphWeights weights,
                           const SolverParam &solver, const ShapeConstants &shape, const Progress &progress) {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    if (!pose.moves)
        return 0;
    const CoarseGraph coarse = Coarsen(graph, area, constraints.constrained, weights, shape);
    const Index k = coarse.graph.Size();
    if (k == graph.Size()) // nothing was merged, as in parts of one node
        return unknown;
    NodeConstraints ofGroups{std::vector<bool>(k), std::vector<bool>(k), std::vector<double>(k), {}};
    GraphPose begin;
    begin.position.resize(3, k);
    begin.rests.assign(std::size_t(k), 0);
    for (Index g = 0; g < k; ++g) {
        const Index i = coarse.leader[g];
        ofGroups.constrained[g] = constraints.constrained[i];
        ofGroups.compliant[g] = constraints.compliant[i];
        ofGroups.heldArea[g] = constraints.heldArea[i];
        ofGroups.motion.push_back(constraints.motion[i]);
        const Eigen::Vector3f offset = coarse.graph.graph.position.col(g) - graph.graph.position.col(i);
        begin.position.col(g) = pose.position.col(i) + pose.linear[i] * offset.cast<double>();
        begin.linear.push_back(pose.linear[i]);
        if (!pose.rests.empty())
            begin.rests[g] = pose.rests[i];
    }
    std::vector<double> areas(std::size_t(k), 0);
    std::vector<Index> count(std::size_t(k), 0);
    for (Index i = 0; i < graph.Size(); ++i) {
        areas[std::size_t(coarse.groupOf[i])] += area[i];
        ++count[std::size_t(coarse.groupOf[i])];
    }
    GraphPose found;
    try {
        found = PartsDeformer(coarse.graph, areas, ofGroups, shape.heldDepth, progress.Slice(0, 0), solver)
                    .Solve(ofGroups, solver, progress, &begin, ofGroups.motion);
    } catch (const Unsolvable &) {
        return unknown;
    }
    const CoarseMapping mapping(coarse, ofGroups, found);
    double sum = 0, weight = 0, nodes = 0, groups = 0;
    for (Index i = 0; i < graph.Size(); ++i) {
        const Index g = coarse.groupOf[i];
        const Csr::Row row = coarse.graph.graph.adjacency[g];
        const bool isAlone = count[g] == 1 && // its part was not merged
                             std::all_of(row.begin(), row.end(), [&](Index j) { return ofGroups.constrained[j]; });
        if (constraints.constrained[i] || isAlone)
            continue;
        const Eigen::Vector3d x = graph.graph.position.col(i).cast<double>();
        sum += area[i] * (mapping(g, x) - pose.position.col(i)).squaredNorm();
        weight += area[i];
        ++nodes;
        groups += coarse.leader[g] == i;
    }
    const double coarser =
        detail::Power(nodes / groups, errorOrder / 2); // error of the coarse pose over the fine one's
    return weight > 0 && coarser > 1 ? std::sqrt(sum / weight) / (coarser - 1) : unknown;
}

} // namespace vcg::fcd
