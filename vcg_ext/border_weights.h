// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_BORDER_WEIGHTS_H
#define VCG_FCD_BORDER_WEIGHTS_H

#include "graph.h"
#include "shape_constants.h"

#include <Eigen/Core>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace vcg {
namespace fcd {
namespace detail {

/// The weight of an edge of a triangulated surface in the discrete Laplacian: half the sum of the two cotangents
/// opposite to it (Pinkall and Polthier 1993), 0 where that is negative: the rotations of ARAP and its energy need
/// weights that are not. Triangles are told by the neighbours that its ends share, and those that cover nothing do not
/// count. Where there are more than two, and in a cloud, those of the Delaunay triangulation do: the ones with the
/// widest angle on either side; an edge that is none of it has no weight. An edge without any triangle is one between
/// two equilateral ones.
inline double CotangentWeight(const Graph &g, Index u, Index v) {
    const Csr::Row a = g.adjacency[u], b = g.adjacency[v];
    const Eigen::Vector3d xu = g.position.col(u).cast<double>(), xv = g.position.col(v).cast<double>();
    const Eigen::Vector3d edge = xv - xu;
    const auto forShared = [&](const auto &body) {  // body(cotangent, across): the angle's, and from the edge to there
        const bool isShorter = a.size() < b.size(); // a hub has as many edges as neighbours: look up what is shared
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
            // Below this height over base, a triangle's float coordinates say nothing about its shape.
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

/// What flows over the border of two patches where the field that flows is the position itself.
struct Flux {
    Eigen::Vector3d flow = Eigen::Vector3d::Zero();   ///< f, out of the patch of the smaller number: the sum of
                                                      ///< w_uv (x_v - x_u) over the edges u, v from it to the other
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< sum of w_uv (x_v - x_u) m^T, m the edge's middle or held end
    Eigen::Vector4d held = Eigen::Vector4d::Zero();   ///< weighted sum of the held ends, and of their weights

    Flux &operator+=(const Flux &o) {
        flow += o.flow;
        moment += o.moment;
        held += o.held;
        return *this;
    }
};

/// A symmetric tensor as a vector, so that the product of two is that of the tensors.
using TensorVector = Eigen::Matrix<double, 6, 1>;
inline TensorVector ToVector(const Eigen::Matrix3d &t) {
    const double root2 = std::sqrt(2.0);
    TensorVector v;
    v << t.diagonal(), root2 * t(0, 1), root2 * t(0, 2), root2 * t(1, 2);
    return v;
}

/// Lets the weights of a graph of k nodes carry in each direction what the surface does.
///
/// The weight of an edge stands for what flows along it. Where borders stand askew to the edges, as those of patches of
/// a few vertices do, which lie like bricks in a wall, there is then too much along the bricks and too little across.
/// How much there should be, the flow over the whole border of a patch tells: G_i = sum_j f_ij (m_ij - c_i)^T, the
/// integral of the projector to the surface over the patch (divergence theorem), should be
/// 1/2 sum_j w_ij e_ij e_ij^T, and is where each patch is one vertex. (An edge to a held patch counts whole, since it
/// ends at the border.) Each node asks for the change w (1 + e^T M e / |e|^2) of its edges that makes it so, and edges
/// take the mean of what their ends ask for. This is done once: a single patch's tensor scatters about what its edges
/// can be expected to carry, and to follow it to the end is to fit that.
/// \param edge 3 x adjacency items, to i \param held k flags \param weight of each adjacency item, symmetric; in, out
inline void MatchTensors(const Graph &graph, const Eigen::Matrix3Xf &edge, const std::vector<char> &held,
                         const std::vector<Flux> &flux, const ShapeConstants &shape, std::vector<float> &weight) {
    const Csr &adjacency = graph.adjacency;
    const auto directionOf = [&](std::uint32_t e) {
        const Eigen::Vector3d way = edge.col(e).cast<double>();
        return ToVector(way * way.transpose() / way.squaredNorm());
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
            const double ends = held[i] || held[j] ? 1 : 2; // that ask
            const double asked = 1 + directionOf(e).dot(change[i] + change[j]) / ends;
            weight[e] *= float(std::min(shape.mostTensorChange, std::max(1 / shape.mostTensorChange, asked)));
        }
}

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
