// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/patches/given_nodes.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace vcg::fcd::detail {

/// The median distance of positions from the nearest other one; infinite for a single one.
static float SpacingOf(const PointTree<float> &tree, const Eigen::Matrix3Xf &position) {
    if (position.cols() < 2)
        return std::numeric_limits<float>::infinity();
    std::vector<float> spacing;
    spacing.reserve(std::size_t(position.cols()));
    for (Eigen::Index i = 0; i < position.cols(); ++i)
        spacing.push_back(tree.DistanceOf(position.col(i), 2));
    std::nth_element(spacing.begin(), spacing.begin() + spacing.size() / 2, spacing.end());
    return spacing[spacing.size() / 2];
}

std::vector<Index> NearestNodes(const PositionsRef &rest, const SurfaceGraph &surface, const std::vector<int> &tag,
                                const std::vector<Index> &nodeTag, const Eigen::Matrix3Xd &centers, Index &placed) {
    const Index k = Index(centers.cols());
    Eigen::Matrix3Xf position(3, k);
    for (Index i = 0; i < k; ++i) {
        if (!centers.col(i).allFinite())
            throw BadInput("A node of the deformation graph has a coordinate that is not a finite number.");
        const double most = 1e15; // its square is still a float
        position.col(i) =
            surface.frame.ToFrame(Eigen::Vector3d(centers.col(i))).cwiseMin(most).cwiseMax(-most).cast<float>();
    }
    // Distances from the nodes of the free surface; those from other held vertices follow below.
    std::vector<float> distance(k, std::numeric_limits<float>::infinity());
    std::vector<Index> nearest(k, -1);
    if (surface.graph.Size() > 0) {
        const PointTree<float> tree(surface.graph.position);
        for (Index i = 0; i < k; ++i) {
            nearest[i] = tree.Nearest(position.col(i));
            distance[i] = (surface.graph.position.col(nearest[i]) - position.col(i)).norm();
        }
    }
    // The radius of a patch: half-way to the next centre, or that of k patches that share the surface.
    const double shared = std::sqrt(surface.area / (double(EIGEN_PI) * double(k)));
    const double patchRadius =
        std::min(0.25, std::max(shared, 0.5 * double(SpacingOf(PointTree<float>(position), position))));
    const float tooFar = float(std::max(patchRadius, surface.averageEdge) + 1e-5); // of the frame's diagonal, 1
    if (std::any_of(distance.begin(), distance.end(), [&](float d) { return d > tooFar; })) {
        std::vector<Eigen::Vector3f> held;
        for (std::size_t i = 0; i < tag.size(); ++i)
            if (tag[i] != 1 && surface.nodeOf[i] < 0 && tag[i] != noVertex) {
                const Eigen::Vector3d p = surface.frame.ToFrame(Eigen::Vector3d(rest.col(Eigen::Index(i))));
                if (p.cwiseAbs().maxCoeff() < 1e15)
                    held.emplace_back(p.cast<float>());
            }
        if (!held.empty()) {
            const PointTree<float> heldTree(held);
            for (Index i = 0; i < k; ++i) {
                const Eigen::Vector3f p = position.col(i);
                const float here = (held[std::size_t(heldTree.Nearest(p))] - p).norm();
                if (here < distance[i]) {
                    distance[i] = here;
                    nearest[i] = -1;
                }
            }
        }
    }
    placed = 0;
    std::vector<bool> taken(surface.graph.Size(), false);
    std::vector<Index> node;
    for (Index i = 0; i < k; ++i) {
        if (distance[i] > tooFar)
            continue;
        ++placed;
        const Index u = nearest[i];
        if (u < 0 || taken[u] || nodeTag[u] != 1)
            continue;
        taken[u] = true;
        node.push_back(u);
    }
    if (2 * placed < k) {
        std::ostringstream message;
        message << "Only " << placed << " of the " << k << " given nodes lie on the surface (within "
                << tooFar * surface.frame.scale
                << " of a vertex): they seem to belong to another mesh, or to this one in another place. Give the "
                   "graph of this mesh, move it to where the mesh is, or give none.";
        throw BadInput(message.str());
    }
    return node;
}

} // namespace vcg::fcd::detail
