// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_BORDER_WEIGHTS_H
#define VCG_FCD_BORDER_WEIGHTS_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/shape_constants.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace vcg::fcd::detail {

/// The weight of an edge of a triangulated surface in the discrete Laplacian: half the sum of the two cotangents
/// opposite to it (Pinkall and Polthier 1993), 0 where that is negative: the rotations of ARAP and its energy need
/// weights that are not. Triangles are told by the neighbours that its ends share, and those that cover nothing do not
/// count. Where there are more than two, and in a cloud, those of the Delaunay triangulation do: the ones with the
/// widest angle on either side; an edge that is none of it has no weight. An edge without any triangle is one between
/// two equilateral ones.
double CotangentWeight(const Graph &g, Index u, Index v);

/// What flows over the border of two patches where the field that flows is the position itself.
struct Flux {
    Eigen::Vector3d flow = Eigen::Vector3d::Zero();   ///< f, out of the patch of the smaller number: the sum of
                                                      ///< w_uv (x_v - x_u) over the edges u, v from it to the other
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< sum of w_uv (x_v - x_u) m^T, m the edge's middle or held end
    Eigen::Vector4d held = Eigen::Vector4d::Zero();   ///< weighted sum of the held ends, and of their weights

    /// What flows along an edge of the weight \p w, from \p x in the patch of the smaller number to \p y; one of the
    /// patches may be held.
    void Add(double w, const Eigen::Vector3d &x, const Eigen::Vector3d &y, bool heldX, bool heldY) {
        const Eigen::Vector3d along = w * (y - x);
        flow += along;
        moment += along * (heldX ? x : heldY ? y : Eigen::Vector3d(0.5 * (x + y))).transpose();
        if (heldX || heldY) // an edge that carries nothing, as across a square, still tells where the border is
            held += std::max(1e-6, w) * (x - y).norm() * (heldX ? x : y).homogeneous();
    }

    Flux &operator+=(const Flux &o) {
        flow += o.flow;
        moment += o.moment;
        held += o.held;
        return *this;
    }
};

/// A symmetric tensor as a vector, so that the product of two is that of the tensors.
using TensorVector = Eigen::Matrix<double, 6, 1>;
TensorVector ToVector(const Eigen::Matrix3d &t);

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
void MatchTensors(const Graph &graph, const Eigen::Matrix3Xf &edge, const std::vector<char> &held,
                  const std::vector<Flux> &flux, const ShapeConstants &shape, std::vector<float> &weight);

/// Gives a graph of k patches, of which positions and held flags are known, its edges and their weights.
void WeighBorders(const Quotient<Flux> &dual, GraphWeights weights, const ShapeConstants &shape, DeformationGraph &d);

} // namespace vcg::fcd::detail

#endif
