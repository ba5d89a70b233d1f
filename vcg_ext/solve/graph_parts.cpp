// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/solve/affine_deformer.h>
#include <vcg_ext/solve/graph_deformer.h>
#include <vcg_ext/solve/graph_parts.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace vcg::fcd {

std::vector<std::vector<Index>> SeparateParts(const DeformationGraph &graph, const std::vector<bool> &constrained) {
    const Index k = graph.Size();
    std::vector<std::vector<Index>> parts;
    std::vector<Index> seen(k, -1);
    for (Index seed = 0; seed < k; ++seed) {
        if (seen[seed] >= 0 || graph.IsHeld(seed))
            continue;
        const Index number = seed;
        std::vector<Index> part(1, seed);
        seen[seed] = number;
        bool isConstrained = false;
        for (std::size_t i = 0; i < part.size(); ++i) {
            isConstrained |= constrained[part[i]];
            if (!graph.IsHeld(part[i]))
                for (Index j : graph.graph.adjacency[part[i]])
                    if (seen[j] != number) {
                        seen[j] = number;
                        part.push_back(j);
                    }
        }
        std::sort(part.begin(), part.end());
        if (isConstrained)
            parts.push_back(std::move(part));
    }
    return parts;
}

DeformationGraph PartOf(const DeformationGraph &graph, const std::vector<Index> &nodes) {
    const auto forCommon = [](const auto &few, const auto &many, const auto &body) { // both ascending
        for (std::size_t i = 0; i < few.size(); ++i) {
            const auto found = std::lower_bound(many.begin(), many.end(), few[i]);
            if (found != many.end() && *found == few[i])
                body(i, std::size_t(found - many.begin()));
        }
    };
    DeformationGraph part;
    std::vector<std::uint32_t> item;
    part.graph.position.resize(3, Eigen::Index(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Index node = nodes[i];
        part.graph.position.col(Eigen::Index(i)) = graph.graph.position.col(node);
        part.radius.push_back(graph.radius[node]);
        part.held.push_back(graph.IsHeld(node));
        const auto take = [&](std::size_t r, std::size_t neighbour) {
            const std::uint32_t e = graph.graph.adjacency.begin[node] + std::uint32_t(r);
            part.graph.adjacency.item.push_back(Index(neighbour));
            part.weight.push_back(graph.weight[e]);
            item.push_back(e);
        };
        const Csr::Row row = graph.graph.adjacency[node];
        if (row.size() <= nodes.size())
            forCommon(row, nodes, take);
        else // a held node beside very many parts
            forCommon(nodes, row, [&](std::size_t neighbour, std::size_t r) { take(r, neighbour); });
        part.graph.adjacency.begin.push_back(std::uint32_t(item.size()));
    }
    part.edge.resize(3, Eigen::Index(item.size()));
    for (std::size_t e = 0; e < item.size(); ++e)
        part.edge.col(Eigen::Index(e)) = graph.edge.col(item[e]);
    return part;
}

struct PartsDeformer::Part {
    std::vector<Index> nodes;
    DeformationGraph graph;
    std::unique_ptr<GraphDeformer> deformer; // with rigidity 1
    std::unique_ptr<AffineDeformer> affine;  // with a rigidity below 1
};

PartsDeformer::PartsDeformer(const DeformationGraph &graph, const std::vector<double> &area,
                             const NodeConstraints &constraints, double heldDepth, const Progress &progress,
                             const SolverParam &solver)
    : rest(graph.graph.position.cast<double>()) {
    for (Index i = 0; i < graph.Size(); ++i)
        isHeld.push_back(graph.IsHeld(i));
    for (std::vector<Index> &nodes : SeparateParts(graph, constraints.constrained)) {
        auto part = std::make_unique<Part>();
        std::vector<bool> constrained, compliant;
        std::vector<double> heldArea;
        double A = 0;
        for (Index i : nodes) {
            constrained.push_back(constraints.constrained[i]);
            compliant.push_back(constraints.compliant[i]);
            heldArea.push_back(constraints.heldArea[i]);
            A += area[i];
        }
        part->graph = PartOf(graph, nodes);
        part->nodes = std::move(nodes);
        if (solver.rigidity < 1)
            part->affine = std::make_unique<AffineDeformer>(part->graph, constrained, A, compliant, heldArea, heldDepth,
                                                            solver, progress);
        else
            part->deformer = std::make_unique<GraphDeformer>(part->graph, constrained, A, compliant, heldArea,
                                                             heldDepth, progress, solver);
        parts.push_back(std::move(part));
    }
}

PartsDeformer::~PartsDeformer() = default;

Eigen::VectorXd PartsDeformer::Spread(const Eigen::VectorXd &pressure) const {
    Eigen::VectorXd displacement = Eigen::VectorXd::Zero(pressure.size());
    for (const auto &part : parts) {
        Eigen::VectorXd values(Eigen::Index(part->nodes.size()));
        for (std::size_t i = 0; i < part->nodes.size(); ++i)
            values[Eigen::Index(i)] = pressure[part->nodes[i]];
        values = part->deformer->Spread(values);
        for (std::size_t i = 0; i < part->nodes.size(); ++i)
            displacement[part->nodes[i]] += values[Eigen::Index(i)]; // 0 for nodes of several parts
    }
    return displacement;
}

GraphPose PartsDeformer::Solve(const NodeConstraints &constraints, const SolverParam &param, const Progress &progress,
                               const GraphPose *last, const std::vector<Eigen::Affine3d> &lastMotion) const {
    const Index k = Index(rest.cols());
    GraphPose pose;
    pose.position = rest;
    pose.linear.assign(k, Eigen::Matrix3d::Identity());
    pose.nodeEnergy.assign(k, 0);
    pose.rests.assign(k, 0);
    for (Index i = 0; i < k; ++i)
        if (constraints.constrained[i]) {
            pose.position.col(i) = constraints.motion[i] * Eigen::Vector3d(pose.position.col(i));
            pose.linear[i] = constraints.motion[i].linear();
        }
    std::vector<bool> solved(k, false); // a held node beside several parts gets the rotation of the first of them
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::vector<Index> &nodes = parts[p]->nodes;
        const bool moves = std::any_of(nodes.begin(), nodes.end(), [&](Index i) {
            return constraints.constrained[i] ? !constraints.motion[i].matrix().isIdentity(0)
                                              : last && !last->rests.empty() && !last->rests[i];
        });
        pose.moves |= moves;
        if (!moves) {
            for (Index i : nodes)
                pose.rests[i] = !isHeld[i];
            continue;
        }
        std::vector<Eigen::Affine3d> motion, motionBefore;
        GraphPose before;
        before.position.resize(3, last ? Eigen::Index(nodes.size()) : 0);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            motion.push_back(constraints.motion[nodes[i]]);
            if (!last)
                continue;
            motionBefore.push_back(lastMotion[nodes[i]]);
            before.position.col(Eigen::Index(i)) = last->position.col(nodes[i]);
            before.linear.push_back(last->linear[nodes[i]]);
        }
        const Progress share = progress.Slice(double(p) / double(parts.size()), double(p + 1) / double(parts.size()));
        const GraphPose *const from = last ? &before : nullptr;
        const GraphPose found = parts[p]->affine ? parts[p]->affine->Solve(motion, param, share, from, motionBefore)
                                                 : parts[p]->deformer->Solve(motion, param, share, from, motionBefore);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            pose.nodeEnergy[nodes[i]] += found.nodeEnergy[i];
            if (solved[nodes[i]])
                continue;
            solved[nodes[i]] = true;
            pose.position.col(nodes[i]) = found.position.col(Eigen::Index(i));
            pose.linear[nodes[i]] = found.linear[i];
        }
        pose.affine = pose.affine || found.affine;
        pose.energy += found.energy;
        pose.iterations = std::max(pose.iterations, found.iterations);
        pose.converged = pose.converged && found.converged;
        pose.followed = pose.followed && found.followed;
        pose.unstable = pose.unstable || found.unstable;
    }
    return pose;
}

} // namespace vcg::fcd
