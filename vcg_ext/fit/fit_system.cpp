// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/fit/fit_system.h>

#include <algorithm>

namespace vcg::fcd {

FitSystem::FitSystem(const RegionDeformer &deformer, const std::vector<char> &isFree, const FitSamples &samples,
                     double smoothness)
    : deformer(deformer), samples(samples), smoothness(smoothness), area(std::max(deformer.surface.area, 1e-12)) {
    const Index k = deformer.graph.Size();
    unknown.assign(std::size_t(k), -1);
    for (Index j = 0; j < k; ++j)
        if (isFree[std::size_t(j)]) {
            unknown[std::size_t(j)] = Index(node.size());
            node.push_back(j);
        }
    beside.resize(node.size());
    uses.resize(node.size());
    const auto join = [&](Index a, Index b) {
        if (a >= 0 && b >= a)
            beside[std::size_t(a)].push_back(b);
    };
    for (std::size_t s = 0; s < samples.Size(); ++s)
        for (std::uint32_t t = samples.begin[s]; t < samples.begin[s + 1]; ++t) {
            const Index a = unknown[std::size_t(samples.term[t].node)];
            if (a < 0)
                continue;
            uses[std::size_t(a)].push_back({std::uint32_t(s), t});
            for (std::uint32_t other = samples.begin[s]; other < samples.begin[s + 1]; ++other)
                join(a, unknown[std::size_t(samples.term[other].node)]);
            if (beside[std::size_t(a)].size() > 4096) {
                std::sort(beside[std::size_t(a)].begin(), beside[std::size_t(a)].end());
                beside[std::size_t(a)].erase(std::unique(beside[std::size_t(a)].begin(), beside[std::size_t(a)].end()),
                                             beside[std::size_t(a)].end());
            }
        }
    std::vector<int> entries;
    for (std::size_t a = 0; a < node.size(); ++a) {
        join(Index(a), Index(a));
        for (Index j : deformer.graph.graph.adjacency[node[a]])
            join(Index(a), unknown[std::size_t(j)]);
        std::sort(beside[a].begin(), beside[a].end());
        beside[a].erase(std::unique(beside[a].begin(), beside[a].end()), beside[a].end());
        for (int d = 0; d < 6; ++d)
            entries.push_back(int(6 * beside[a].size()) - d);
    }
    const Eigen::Index n = Eigen::Index(6 * node.size());
    matrix.resize(n, n);
    matrix.reserve(Eigen::Map<Eigen::VectorXi>(entries.data(), n));
    for (std::size_t a = 0; a < node.size(); ++a)
        for (int d = 0; d < 6; ++d)
            for (Index b : beside[a])
                for (int e = b == Index(a) ? d : 0; e < 6; ++e)
                    matrix.insert(6 * b + e, Eigen::Index(6 * a) + d) = 0;
    matrix.makeCompressed();
    if (n > 0)
        factor.analyzePattern(matrix);
}

/// x_s moves by weight (w x (R lever) + d).
void FitSystem::AddSamples(Index row, const std::vector<Pull> &pull, const std::vector<Index> &place,
                           std::vector<Matrix6> &block, Vector6 &gradient) const {
    for (const Use &use : uses[std::size_t(row)]) {
        const Pull &p = pull[use.sample];
        if (p.form.isZero(0))
            continue;
        const double weight = samples.term[use.term].weight;
        const Eigen::Vector3d &own = arm[use.term];
        gradient.head<3>() += weight * own.cross(p.gradient);
        gradient.tail<3>() += weight * p.gradient;
        // Its Jacobian is weight [-[arm]x, I]; the transposed times the form, column by column:
        Vector6 drawn[3];
        for (int d = 0; d < 3; ++d) {
            const Eigen::Vector3d column = weight * p.form.col(d);
            drawn[d] << own.cross(column), column;
        }
        for (std::uint32_t t = samples.begin[use.sample]; t < samples.begin[use.sample + 1]; ++t) {
            const FitSamples::Term &other = samples.term[t];
            const Index column = unknown[std::size_t(other.node)];
            if (column < row)
                continue;
            const double its = other.weight;
            const Eigen::Vector3d a = its * arm[t];
            Matrix6 &b = block[std::size_t(place[std::size_t(column)])];
            b.col(0) += a[1] * drawn[2] - a[2] * drawn[1];
            b.col(1) += a[2] * drawn[0] - a[0] * drawn[2];
            b.col(2) += a[0] * drawn[1] - a[1] * drawn[0];
            for (int d = 0; d < 3; ++d)
                b.col(3 + d) += its * drawn[d];
        }
    }
}

/// Eq. 2: of each edge, from both ends, |c_i + R_i e - c_j|^2, and alpha A |R_i - R_j|^2.
void FitSystem::AddEdges(Index row, const GraphPose &pose, const std::vector<double> &stiffness,
                         const std::vector<Index> &place, std::vector<Matrix6> &block, Vector6 &gradient) const {
    const DeformationGraph &graph = deformer.graph;
    const Index i = node[std::size_t(row)];
    const auto rest = [&](Index j) { return graph.graph.position.col(j).cast<double>(); };
    Matrix6 &own = block[std::size_t(place[std::size_t(row)])];
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    for (std::uint32_t item = graph.graph.adjacency.begin[std::size_t(i)];
         item < graph.graph.adjacency.begin[std::size_t(i) + 1]; ++item) {
        const Index j = graph.graph.adjacency.item[item];
        const double stiff = std::max(stiffness[std::size_t(i)], stiffness[std::size_t(j)]),
                     mu = stiff * double(graph.weight[item]) / area;
        const Eigen::Matrix3d &ri = pose.linear[std::size_t(i)], &rj = pose.linear[std::size_t(j)];
        const Eigen::Vector3d ci = pose.position.col(i), cj = pose.position.col(j), e = rest(j) - rest(i), a = ri * e,
                              b = -(rj * e);
        const Eigen::Vector3d here = ci + a - cj, there = cj + b - ci; // by the rotation of each end
        gradient.head<3>() += mu * a.cross(here);
        gradient.tail<3>() += mu * (here - there);
        const Eigen::Matrix3d ax = detail::CrossMatrix(a), bx = detail::CrossMatrix(b);
        own.topLeftCorner<3, 3>() += mu * (ax.transpose() * ax);
        own.topRightCorner<3, 3>() += mu * ax;
        own.bottomLeftCorner<3, 3>() -= mu * ax;
        own.bottomRightCorner<3, 3>() += 2 * mu * one;
        const double bend = mu * smoothness * area;
        Eigen::Matrix3d turns = Eigen::Matrix3d::Zero();
        for (int d = 0; d < 3; ++d) {
            gradient.head<3>() -= bend * ri.col(d).cross(rj.col(d));
            own.topLeftCorner<3, 3>() += bend * (ri.col(d).squaredNorm() * one - ri.col(d) * ri.col(d).transpose());
            turns += ri.col(d).dot(rj.col(d)) * one - rj.col(d) * ri.col(d).transpose();
        }
        const Index column = unknown[std::size_t(j)];
        if (column <= row)
            continue;
        Matrix6 &between = block[std::size_t(place[std::size_t(column)])];
        between.topLeftCorner<3, 3>() -= bend * turns;
        between.topRightCorner<3, 3>() -= mu * ax;   // (-[a]x)^T (-I)
        between.bottomLeftCorner<3, 3>() += mu * bx; // (-I)^T (-[b]x)
        between.bottomRightCorner<3, 3>() -= 2 * mu * one;
    }
}

/// From one step to the next the system changes little: a factor of an earlier one is the preconditioner of conjugate
/// gradients, until they take longer than a factorisation.
Eigen::VectorXd FitSystem::Solve(const Eigen::VectorXd &right) {
    const int most = 12;        // about the time of a factorisation
    const double enough = 1e-6; // square of the residual over that of the right side: a Gauss-Newton step is no better
    if (isFactored) {
        Eigen::VectorXd x = factor.solve(right), r = right - matrix.selfadjointView<Eigen::Lower>() * x,
                        z = factor.solve(r), p = z;
        double rz = r.dot(z);
        for (int i = 0; i < most; ++i) {
            if (r.squaredNorm() <= enough * right.squaredNorm())
                return x;
            const Eigen::VectorXd ap = matrix.selfadjointView<Eigen::Lower>() * p;
            const double alpha = rz / p.dot(ap);
            x += alpha * p;
            r -= alpha * ap;
            z = factor.solve(r);
            const double next = r.dot(z);
            p = z + (next / rz) * p;
            rz = next;
        }
    }
    Factorize();
    return factor.solve(right);
}

void FitSystem::Factorize() {
    factor.factorize(matrix);
    isNew = isFactored = factor.info() == Eigen::Success;
    if (!isFactored)
        throw Unsolvable("The fit has no solution in numbers. Take stiffness and smoothness nearer to their defaults, "
                         "or check the target for strays.");
}

void FitSystem::Take(const Eigen::Matrix<double, 6, Eigen::Dynamic> &step, GraphPose &pose) {
    for (Eigen::Index j = 0; j < step.cols(); ++j) {
        pose.linear[std::size_t(j)] = detail::RotationBy(step.col(j).head<3>()) * pose.linear[std::size_t(j)];
        pose.position.col(j) += step.col(j).tail<3>();
    }
}

Eigen::Matrix3d FitSystem::Compliance(std::size_t sample) {
    if (!isNew)
        Factorize();
    Eigen::MatrixXd force = Eigen::MatrixXd::Zero(matrix.rows(), 3);
    for (std::uint32_t t = samples.begin[sample]; t < samples.begin[sample + 1]; ++t)
        if (const Index a = unknown[std::size_t(samples.term[t].node)]; a >= 0) {
            force.middleRows<3>(6 * Eigen::Index(a)) += samples.term[t].weight * detail::CrossMatrix(arm[t]);
            force.middleRows<3>(6 * Eigen::Index(a) + 3) += samples.term[t].weight * Eigen::Matrix3d::Identity();
        }
    return force.transpose() * factor.solve(force);
}

Eigen::Matrix<double, 6, Eigen::Dynamic> FitSystem::Step(const GraphPose &pose, const std::vector<Pull> &pull,
                                                         const std::vector<double> &stiffness, unsigned threads) {
    Eigen::VectorXd gradient(Eigen::Index(6 * node.size()));
    arm.resize(samples.term.size());
    for (std::size_t t = 0; t < arm.size(); ++t)
        arm[t] = pose.linear[std::size_t(samples.term[t].node)] * samples.term[t].lever;
    ParallelFor(threads, node.size(), 8, [&](std::size_t first, std::size_t last) {
        std::vector<Matrix6> block;
        std::vector<Index> place(node.size(), 0); // of each unknown, among those of a row
        for (std::size_t a = first; a < last; ++a) {
            block.assign(beside[a].size(), Matrix6::Zero());
            for (std::size_t b = 0; b < beside[a].size(); ++b)
                place[std::size_t(beside[a][b])] = Index(b);
            Vector6 its = Vector6::Zero();
            AddSamples(Index(a), pull, place, block, its);
            AddEdges(Index(a), pose, stiffness, place, block, its);
            // Nodes that no edge and no sample draws stay.
            block[0].diagonal().array() += 1e-12;
            gradient.segment<6>(Eigen::Index(6 * a)) = its;
            for (int d = 0; d < 6; ++d) { // row a of blocks is column a of the lower half
                double *to = matrix.valuePtr() + matrix.outerIndexPtr()[6 * a + std::size_t(d)];
                for (std::size_t b = 0; b < beside[a].size(); ++b)
                    for (int e = b == 0 ? d : 0; e < 6; ++e)
                        *to++ = block[b](d, e);
            }
        }
    });
    Eigen::Matrix<double, 6, Eigen::Dynamic> step =
        Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, deformer.graph.Size());
    if (node.empty())
        return step;
    isNew = false;
    const Eigen::VectorXd x = Solve(-gradient);
    for (std::size_t a = 0; a < node.size(); ++a)
        step.col(node[a]) = x.segment<6>(Eigen::Index(6 * a));
    return step;
}

} // namespace vcg::fcd
