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

/// The cotangent weight of the edge u, v of a triangulated surface: half the sum of the two cotangents opposite to it
/// (Pinkall and Polthier 1993), or 0 if that is negative, since ARAP needs weights >= 0. The triangles at the edge are
/// found as the common neighbours of u and v; flat ones count as 0.
///
/// If there are more than two, or in a cloud, only the triangle with the widest angle on either side counts, as in a
/// Delaunay triangulation, and an edge with a common neighbour on it has the weight 0. An edge of a mesh without a
/// triangle counts as one between two equilateral triangles.
double CotangentWeight(const Graph &g, Index u, Index v);

/// The flux of the position, as a field, through the common border of two patches. Sums are over the edges u, v from
/// the patch with the smaller number to the other one.
struct Flux {
    Eigen::Vector3d flow = Eigen::Vector3d::Zero();   ///< f: the sum of w_uv (x_v - x_u)
    Eigen::Matrix3d moment = Eigen::Matrix3d::Zero(); ///< sum of w_uv (x_v - x_u) m^T, m the edge's middle or held end
    Eigen::Vector4d held = Eigen::Vector4d::Zero();   ///< weighted sum of the held ends, and of their weights

    /// Adds an edge of the weight \p w from \p x, in the patch with the smaller number, to \p y. At most one of the
    /// patches is held.
    void Add(double w, const Eigen::Vector3d &x, const Eigen::Vector3d &y, bool heldX, bool heldY) {
        const Eigen::Vector3d along = w * (y - x);
        flow += along;
        moment += along * (heldX ? x : heldY ? y : Eigen::Vector3d(0.5 * (x + y))).transpose();
        if (heldX || heldY) // an edge of weight 0, as across a square, still tells where the border is
            held += std::max(1e-6, w) * (x - y).norm() * (heldX ? x : y).homogeneous();
    }

    Flux &operator+=(const Flux &o) {
        flow += o.flow;
        moment += o.moment;
        held += o.held;
        return *this;
    }
};

/// A symmetric tensor as a vector; the inner product of two vectors is that of the tensors.
using TensorVector = Eigen::Matrix<double, 6, 1>;
TensorVector ToVector(const Eigen::Matrix3d &t);

/// Corrects the weights of a graph of k nodes, so that in every direction a node's edges carry as much as its surface.
///
/// A weight stands for the flux along its edge. If a border stands askew to its edge, this is wrong: patches of a few
/// vertices lie like bricks in a wall, and get too much along the bricks and too little across. The right amount
/// follows from the whole border of patch i: G_i = sum_j f_ij (m_ij - c_i)^T is the integral of the projector to the
/// surface over the patch (divergence theorem). It should be 1/2 sum_j w_ij e_ij e_ij^T, which holds exactly with one
/// vertex a patch. (An edge to a held patch counts in full, since it ends at the border.) Each node asks for the
/// weights w (1 + e^T M e / |e|^2); its symmetric M makes the two sums equal. An edge gets the mean of the weights that
/// its ends ask for. This is done once: G_i of a single patch is noisy, and further rounds would fit the noise.
/// \param edge 3 x adjacency items, from neighbour j to i \param held k flags
/// \param weight of each adjacency item, symmetric; in, out
void MatchTensors(const Graph &graph, const Eigen::Matrix3Xf &edge, const std::vector<char> &held,
                  const std::vector<Flux> &flux, const ShapeConstants &shape, std::vector<float> &weight);

/// Sets adjacency, edges and weights of \p d, whose positions and held flags are set.
/// \param dual the dual graph of its k patches
void WeighBorders(const Quotient<Flux> &dual, GraphWeights weights, const ShapeConstants &shape, DeformationGraph &d);

} // namespace vcg::fcd::detail

#endif
