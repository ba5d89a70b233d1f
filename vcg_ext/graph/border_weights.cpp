// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/graph/border_weights.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace vcg::fcd::detail {

double CotangentWeight(const Graph &g, Index u, Index v) {
    const Csr::Row a = g.adjacency[u], b = g.adjacency[v];
    const Eigen::Vector3d xu = g.position.col(u).cast<double>(), xv = g.position.col(v).cast<double>();
    const Eigen::Vector3d edge = xv - xu;
    // Calls body(cotangent of the angle, is flat, from the edge to the vertex, dot product) for each common neighbour.
    const auto forShared = [&](const auto &body) {
        const bool isShorter = a.size() < b.size(); // a hub has very many neighbours: do not walk through them
        const Csr::Row &few = isShorter ? a : b, &many = isShorter ? b : a;
        const bool isHub = many.size() > 16 * few.size();
        const Index *j = many.begin();
        for (Index i : few) {
            if (isHub)
                j = std::lower_bound(j, many.end(), i);
            while (j != many.end() && *j < i)
                ++j;
            if (j == many.end())
                break;
            if (*j != i)
                continue;
            const Eigen::Vector3d x = g.position.col(i).cast<double>(), p = xu - x, q = xv - x;
            const double twice = p.cross(q).norm();
            // At less height over base, float coordinates do not tell the shape of a triangle.
            const bool isFlat = !(twice > 1e-5 * std::max(p.squaredNorm(), q.squaredNorm()));
            body(isFlat ? 0 : p.dot(q) / twice, isFlat,
                 Eigen::Vector3d(-p - edge * (edge.dot(-p) / edge.squaredNorm())), p.dot(q));
        }
    };
    double sum = 0, widest = std::numeric_limits<double>::infinity(), opposite = widest;
    Eigen::Vector3d side = Eigen::Vector3d::Zero();
    int shared = 0;
    bool isCrossed = false; // a neighbour lies on the edge
    forShared([&](double cotangent, bool isFlat, const Eigen::Vector3d &across, double dot) {
        ++shared;
        sum += cotangent;
        isCrossed |= isFlat && dot < 0;
        if (!isFlat && cotangent < widest) {
            widest = cotangent;
            side = across;
        }
    });
    if (shared <= 2 && !g.isCloud)
        return shared ? std::max(0.0, 0.5 * sum) : std::sqrt(1.0 / 3);
    if (isCrossed || std::isinf(widest))
        return 0;
    forShared([&](double cotangent, bool isFlat, const Eigen::Vector3d &across, double) {
        if (!isFlat && across.dot(side) < 0)
            opposite = std::min(opposite, cotangent);
    });
    return std::max(0.0, 0.5 * (widest + (std::isinf(opposite) ? 0 : opposite)));
}

TensorVector ToVector(const Eigen::Matrix3d &t) {
    const double root2 = std::sqrt(2.0);
    TensorVector v;
    v << t.diagonal(), root2 * t(0, 1), root2 * t(0, 2), root2 * t(1, 2);
    return v;
}

void MatchTensors(const Graph &graph, const Eigen::Matrix3Xf &edge, const std::vector<char> &held,
                  const std::vector<Flux> &flux, const ShapeConstants &shape, std::vector<float> &weight) {
    const Csr &adjacency = graph.adjacency;
    const auto directionOf = [&](std::uint32_t e) {
        const Eigen::Vector3d offset = edge.col(e).cast<double>();
        return ToVector(offset * offset.transpose() / offset.squaredNorm());
    };
    std::vector<TensorVector> change(adjacency.Size(), TensorVector::Zero()); // M
    for (Index i = 0; i < adjacency.Size(); ++i) {
        if (held[i])
            continue;
        const Eigen::Vector3d center = graph.position.col(i).cast<double>();
        Eigen::Matrix3d wanted = Eigen::Matrix3d::Zero();
        TensorVector carried = TensorVector::Zero();
        Eigen::Matrix<double, 6, 6> response = Eigen::Matrix<double, 6, 6>::Zero();
        for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e) {
            const Index j = adjacency.item[e];
            wanted += (i < j ? 1 : -1) * (flux[e].moment - flux[e].flow * center.transpose());
            const double carries = (held[j] ? 1 : 0.5) * weight[e] * edge.col(e).cast<double>().squaredNorm();
            if (!(carries > 0))
                continue;
            const TensorVector direction = directionOf(e);
            carried += carries * direction;
            response += carries * direction * direction.transpose();
        }
        if (!(response.trace() > 0))
            continue;
        response.diagonal().array() += shape.tensorRidge * response.trace() / 6;
        change[i] = response.ldlt().solve(ToVector(0.5 * (wanted + wanted.transpose())) - carried);
    }
    for (Index i = 0; i < adjacency.Size(); ++i)
        for (std::uint32_t e = adjacency.begin[i]; e < adjacency.begin[i + 1]; ++e) {
            const Index j = adjacency.item[e];
            if (!(weight[e] > 0))
                continue;
            const double ends = held[i] || held[j] ? 1 : 2; // held nodes ask for nothing
            const double asked = 1 + directionOf(e).dot(change[i] + change[j]) / ends;
            weight[e] *= float(std::min(shape.mostTensorChange, std::max(1 / shape.mostTensorChange, asked)));
        }
}

} // namespace vcg::fcd::detail
