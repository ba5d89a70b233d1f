// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/lists.h>
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/base/rotation_vector.h>
#include <vcg_ext/fit/fit_system.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace vcg::fcd {

namespace {

// The least rigidity: it decides what data and smoothness leave open, as how a plane stretches across itself, and
// hardly anything else.
constexpr double leastRigidity = 1e-5;

} // namespace

FitSystem::FitSystem(const RegionDeformer &deformer, const std::vector<char> &isFree, const FitSamples &samples,
                     double smoothness, double rigidity)
    : deformer(deformer), samples(samples), smoothness(smoothness), area(std::max(deformer.surface.area, 1e-12)),
      rigidity(std::max(rigidity, leastRigidity) / std::max(1 - rigidity, 1e-6)), size(rigidity < 1 ? 12 : 6) {
    const Index k = deformer.graph.Size();
    unknown.assign(std::size_t(k), -1);
    for (Index j = 0; j < k; ++j)
        if (isFree[j]) {
            unknown[j] = Index(node.size());
            node.push_back(j);
        }
    beside.resize(node.size());
    uses.resize(node.size());
    const auto join = [&](Index a, Index b) {
        if (a >= 0 && b >= a)
            beside[a].push_back(b);
    };
    for (std::size_t s = 0; s < samples.Size(); ++s)
        for (std::uint32_t t = samples.begin[s]; t < samples.begin[s + 1]; ++t) {
            const Index a = unknown[std::size_t(samples.term[t].node)];
            if (a < 0)
                continue;
            uses[a].push_back({std::uint32_t(s), t});
            for (std::uint32_t other = samples.begin[s]; other < samples.begin[s + 1]; ++other)
                join(a, unknown[std::size_t(samples.term[other].node)]);
            if (beside[a].size() > 4096)
                SortUnique(beside[a]);
        }
    for (std::size_t a = 0; a < node.size(); ++a) {
        join(Index(a), Index(a));
        for (Index j : deformer.graph.graph.adjacency[node[a]])
            join(Index(a), unknown[j]);
        SortUnique(beside[a]);
    }
    if (size == 12)
        system.emplace<System<12>>();
    std::visit([&](auto &each) { MakePattern(each); }, system);
}

template <int N>
void FitSystem::MakePattern(System<N> &system) const {
    system.matrix.diagonal.resize(node.size());
    for (std::size_t a = 0; a < node.size(); ++a)
        for (std::size_t b = 1; b < beside[a].size(); ++b)
            system.matrix.where.emplace_back(Index(a), beside[a][b]);
    system.matrix.beside.resize(system.matrix.where.size());
    system.factor.Analyse(system.matrix, std::numeric_limits<double>::infinity());
}

/// Adds what samples contribute to a row: x_s moves by weight (w x (R lever) + d).
void FitSystem::AddSamples(Index row, const std::vector<Pull> &pull, const std::vector<Index> &place,
                           std::vector<MatrixOf<6>> &block, VectorOf<6> &gradient) const {
    for (const Use &use : uses[row]) {
        const Pull &p = pull[use.sample];
        if (p.form.isZero(0))
            continue;
        const double weight = samples.term[use.term].weight;
        const Eigen::Vector3d &own = arm[use.term];
        gradient.head<3>() += weight * own.cross(p.gradient);
        gradient.tail<3>() += weight * p.gradient;
        // Its Jacobian is weight [-[arm]x, I]; the transposed times the form, column by column:
        VectorOf<6> drawn[3];
        for (int d = 0; d < 3; ++d) {
            const Eigen::Vector3d column = weight * p.form.col(d);
            drawn[d] << own.cross(column), column;
        }
        for (std::uint32_t t = samples.begin[use.sample]; t < samples.begin[use.sample + 1]; ++t) {
            const FitSamples::Term &other = samples.term[t];
            const Index column = unknown[std::size_t(other.node)];
            if (column < row)
                continue;
            const double otherWeight = other.weight;
            const Eigen::Vector3d a = otherWeight * arm[t];
            MatrixOf<6> &b = block[std::size_t(place[column])];
            b.col(0) += a[1] * drawn[2] - a[2] * drawn[1];
            b.col(1) += a[2] * drawn[0] - a[0] * drawn[2];
            b.col(2) += a[0] * drawn[1] - a[1] * drawn[0];
            for (int d = 0; d < 3; ++d)
                b.col(3 + d) += otherWeight * drawn[d];
        }
    }
}

/// Adds Eq. 2 to a row: of each edge, from both ends, |p'_i + R_i e - p'_j|^2, and alpha A |R_i - R_j|^2.
void FitSystem::AddEdges(Index row, const GraphPose &pose, const std::vector<double> &stiffness,
                         const std::vector<Index> &place, std::vector<MatrixOf<6>> &block,
                         VectorOf<6> &gradient) const {
    const DeformationGraph &graph = deformer.graph;
    const Index i = node[row];
    const auto rest = [&](Index j) { return graph.graph.position.col(j).cast<double>(); };
    MatrixOf<6> &own = block[std::size_t(place[row])];
    const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
    for (std::uint32_t item = graph.graph.adjacency.begin[i]; item < graph.graph.adjacency.begin[std::size_t(i) + 1];
         ++item) {
        const Index j = graph.graph.adjacency.item[item];
        const double stiff = std::max(stiffness[i], stiffness[j]), mu = stiff * double(graph.weight[item]) / area;
        const Eigen::Matrix3d &ri = pose.linear[i], &rj = pose.linear[j];
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
        const Index column = unknown[j];
        if (column <= row)
            continue;
        MatrixOf<6> &between = block[std::size_t(place[column])];
        between.topLeftCorner<3, 3>() -= bend * turns;
        between.topRightCorner<3, 3>() -= mu * ax;   // (-[a]x)^T (-I)
        between.bottomLeftCorner<3, 3>() += mu * bx; // (-I)^T (-[b]x)
        between.bottomRightCorner<3, 3>() -= 2 * mu * one;
    }
}

/// The same for affine maps: x_s moves by weight (dA lever + d), so with l = (lever, 1) each entry of l l^T multiplies
/// the form.
void FitSystem::AddSamples(Index row, const std::vector<Pull> &pull, const std::vector<Index> &place,
                           std::vector<MatrixOf<12>> &block, VectorOf<12> &gradient) const {
    for (const Use &use : uses[row]) {
        const Pull &p = pull[use.sample];
        if (p.form.isZero(0))
            continue;
        const double weight = samples.term[use.term].weight;
        const Eigen::Vector4d own = weight * arm[use.term].homogeneous();
        Eigen::Matrix<double, 12, 3> drawn;
        for (Eigen::Index d = 0; d < 4; ++d) {
            gradient.segment<3>(3 * d) += own[d] * p.gradient;
            drawn.middleRows<3>(3 * d) = own[d] * p.form;
        }
        for (std::uint32_t t = samples.begin[use.sample]; t < samples.begin[use.sample + 1]; ++t) {
            const Index column = unknown[std::size_t(samples.term[t].node)];
            if (column < row)
                continue;
            const Eigen::Vector4d otherArm = samples.term[t].weight * arm[t].homogeneous();
            MatrixOf<12> &b = block[std::size_t(place[column])];
            for (Eigen::Index e = 0; e < 4; ++e)
                b.middleCols<3>(3 * e) += otherArm[e] * drawn;
        }
    }
}

void FitSystem::AddEdges(Index row, const GraphPose &pose, const std::vector<double> &stiffness,
                         const std::vector<Index> &place, std::vector<MatrixOf<12>> &block,
                         VectorOf<12> &gradient) const {
    const DeformationGraph &graph = deformer.graph;
    const Index i = node[row];
    const auto rest = [&](Index j) { return graph.graph.position.col(j).cast<double>(); };
    const Eigen::Matrix3d &ai = pose.linear[i];
    MatrixOf<12> &own = block[std::size_t(place[row])];
    double rigid = 0;
    for (std::uint32_t item = graph.graph.adjacency.begin[i]; item < graph.graph.adjacency.begin[std::size_t(i) + 1];
         ++item) {
        const Index j = graph.graph.adjacency.item[item];
        const double stiff = std::max(stiffness[i], stiffness[j]), mu = stiff * double(graph.weight[item]) / area,
                     bend = mu * smoothness * area;
        const Eigen::Vector3d ci = pose.position.col(i), cj = pose.position.col(j), e = rest(j) - rest(i);
        const Eigen::Matrix3d &aj = pose.linear[j];
        const Eigen::Vector3d here = ci + ai * e - cj, there = cj - aj * e - ci; // by the map of each end
        for (Eigen::Index d = 0; d < 3; ++d)
            gradient.segment<3>(3 * d) += mu * e[d] * here + bend * (ai.col(d) - aj.col(d));
        gradient.tail<3>() += mu * (here - there);
        rigid += mu * e.squaredNorm();
        // Coefficients between the columns of maps and shifts; each multiplies the identity.
        Eigen::Matrix4d mine = Eigen::Matrix4d::Zero(), other = Eigen::Matrix4d::Zero();
        mine.topLeftCorner<3, 3>() = mu * e * e.transpose() + bend * Eigen::Matrix3d::Identity();
        mine.topRightCorner<3, 1>() = mu * e;
        mine.bottomLeftCorner<1, 3>() = mu * e.transpose();
        mine(3, 3) = 2 * mu;
        other.topLeftCorner<3, 3>() = -bend * Eigen::Matrix3d::Identity();
        other.topRightCorner<3, 1>() = -mu * e;
        other.bottomLeftCorner<1, 3>() = mu * e.transpose();
        other(3, 3) = -2 * mu;
        const Index column = unknown[j];
        for (Eigen::Index d = 0; d < 4; ++d)
            for (Eigen::Index f = 0; f < 4; ++f) {
                own.block<3, 3>(3 * d, 3 * f).diagonal().array() += mine(d, f);
                if (column > row)
                    block[std::size_t(place[column])].block<3, 3>(3 * d, 3 * f).diagonal().array() += other(d, f);
            }
    }
    // |A - R(A)|^2 does not change if A turns.
    const Eigen::Matrix3d turn = detail::RotationOf(ai), off = ai - turn;
    Eigen::Matrix<double, 9, 9> across = Eigen::Matrix<double, 9, 9>::Identity();
    for (int d = 0; d < 3; ++d) {
        const Eigen::Matrix3d turned = detail::CrossMatrix(Eigen::Vector3d::Unit(d)) * turn / std::sqrt(2);
        const Eigen::Map<const VectorOf<9>> direction(turned.data());
        across -= direction * direction.transpose();
    }
    own.topLeftCorner<9, 9>() += rigidity * rigid * across;
    gradient.head<9>() += rigidity * rigid * Eigen::Map<const VectorOf<9>>(off.data());
}

/// Solves the system by conjugate gradients, with the factor of an earlier step as preconditioner, since the system
/// changes little from step to step. Factorises again if that would take longer.
template <int N>
Eigen::VectorXd FitSystem::Solve(System<N> &system, const Eigen::VectorXd &right) {
    const int most = 12;        // about the time of a factorisation
    const double enough = 1e-6; // squared residual over squared right side: a Gauss-Newton step is no more exact
    if (isFactored) {
        Eigen::VectorXd x = system.factor.Solve(right), r = right - system.matrix * x, z = system.factor.Solve(r),
                        p = z;
        double rz = r.dot(z);
        for (int i = 0; i < most; ++i) {
            if (r.squaredNorm() <= enough * right.squaredNorm())
                return x;
            const Eigen::VectorXd ap = system.matrix * p;
            const double alpha = rz / p.dot(ap);
            x += alpha * p;
            r -= alpha * ap;
            z = system.factor.Solve(r);
            const double next = r.dot(z);
            p = z + (next / rz) * p;
            rz = next;
        }
    }
    Factorise(system);
    return system.factor.Solve(right);
}

template <int N>
void FitSystem::Factorise(System<N> &system) {
    isNew = isFactored = system.factor.Factorise(system.matrix, {}, "") && system.factor.Negative() == 0;
    if (!isFactored)
        throw Unsolvable("The fit cannot be solved in double precision. Take stiffness and smoothness nearer to their "
                         "defaults, remove stray points, or, if the surface is as thin as a line, take "
                         "its vertices alone, as a cloud.");
}

void FitSystem::Take(const Change &step, GraphPose &pose) {
    for (Eigen::Index j = 0; j < step.cols(); ++j) {
        Eigen::Matrix3d &linear = pose.linear[j];
        if (step.rows() == 6) {
            linear = detail::RotationBy(step.col(j).head<3>()) * linear;
        } else {
            const Eigen::Matrix<double, 9, 1> change = step.col(j).head<9>();
            linear += Eigen::Map<const Eigen::Matrix3d>(change.data());
        }
        pose.position.col(j) += step.col(j).tail<3>();
    }
}

Eigen::Matrix3d FitSystem::Compliance(std::size_t sample) {
    auto &turning = std::get<System<6>>(system);
    if (!isNew)
        Factorise(turning);
    Eigen::MatrixX3d force = Eigen::MatrixX3d::Zero(6 * Eigen::Index(node.size()), 3);
    for (std::uint32_t t = samples.begin[sample]; t < samples.begin[sample + 1]; ++t)
        if (const Index a = unknown[std::size_t(samples.term[t].node)]; a >= 0) {
            force.middleRows<3>(6 * Eigen::Index(a)) += samples.term[t].weight * detail::CrossMatrix(arm[t]);
            force.middleRows<3>(6 * Eigen::Index(a) + 3) += samples.term[t].weight * Eigen::Matrix3d::Identity();
        }
    return force.transpose() * turning.factor.Solve(force);
}

template <int N>
void FitSystem::Assemble(const GraphPose &pose, const std::vector<Pull> &pull, const std::vector<double> &stiffness,
                         unsigned threads, System<N> &system, Eigen::VectorXd &gradient) const {
    std::vector<std::size_t> begin(node.size() + 1, 0); // of the blocks beside the diagonal
    for (std::size_t a = 0; a < node.size(); ++a)
        begin[a + 1] = begin[a] + beside[a].size() - 1;
    ParallelFor(threads, node.size(), 8, [&](std::size_t first, std::size_t last) {
        std::vector<MatrixOf<N>> block;
        std::vector<Index> place(node.size(), 0); // of each unknown, among those of a row
        for (std::size_t a = first; a < last; ++a) {
            block.assign(beside[a].size(), MatrixOf<N>::Zero());
            for (std::size_t b = 0; b < beside[a].size(); ++b)
                place[std::size_t(beside[a][b])] = Index(b);
            VectorOf<N> ownGradient = VectorOf<N>::Zero();
            AddSamples(Index(a), pull, place, block, ownGradient);
            AddEdges(Index(a), pose, stiffness, place, block, ownGradient);
            // Nodes without edges and samples stay.
            block[0].diagonal().array() += 1e-12;
            gradient.segment<N>(Eigen::Index(N * a)) = ownGradient;
            system.matrix.diagonal[a] = block[0];
            std::copy(block.begin() + 1, block.end(), system.matrix.beside.begin() + std::ptrdiff_t(begin[a]));
        }
    });
}

FitSystem::Change FitSystem::Step(const GraphPose &pose, const std::vector<Pull> &pull,
                                  const std::vector<double> &stiffness, unsigned threads) {
    Eigen::VectorXd gradient(size * Eigen::Index(node.size()));
    arm.resize(samples.term.size());
    for (std::size_t t = 0; t < arm.size(); ++t)
        arm[t] = size == 6 ? Eigen::Vector3d(pose.linear[std::size_t(samples.term[t].node)] * samples.term[t].lever)
                           : samples.term[t].lever;
    Change step = Change::Zero(size, deformer.graph.Size());
    if (node.empty())
        return step;
    isNew = false;
    const Eigen::VectorXd x = std::visit(
        [&](auto &each) {
            Assemble(pose, pull, stiffness, threads, each, gradient);
            return Solve(each, -gradient);
        },
        system);
    for (std::size_t a = 0; a < node.size(); ++a)
        step.col(node[a]) = x.segment(size * Eigen::Index(a), size);
    return step;
}

} // namespace vcg::fcd
