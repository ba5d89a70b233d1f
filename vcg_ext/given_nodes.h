// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GIVEN_NODES_H
#define VCG_FCD_GIVEN_NODES_H

#include "handles.h"
#include "node_tree.h"
#include "surface_graph.h"

#include <sstream>

namespace vcg {
namespace fcd {

namespace detail {

/// The median distance of positions to the nearest other one; infinite for a single one.
inline float SpacingOf(NodeTree &tree, const Eigen::Matrix3Xf &position) {
    if (position.cols() < 2)
        return std::numeric_limits<float>::infinity();
    std::vector<float> spacing;
    vcg::KdTree<float>::PriorityQueue nearest;
    for (Eigen::Index i = 0; i < position.cols(); ++i) {
        tree->doQueryK(tree.Point(position.col(i)), 2, nearest);
        spacing.push_back(std::sqrt(nearest.getTopWeight()));
    }
    std::nth_element(spacing.begin(), spacing.begin() + spacing.size() / 2, spacing.end());
    return spacing[spacing.size() / 2];
}

/// The nodes of \p surface nearest to \p centers (3 x k, mesh units), each once, without those that are held. Left out
/// are centres further from the mesh than centres are from each other: they belong elsewhere.
/// \param rest 3 x vertex slots \param tag one per vertex slot \param nodeTag n, 1 where free \param placed how many
/// centres are not left out \throw Error when these are less than half of them
inline std::vector<Index> NearestNodes(const Eigen::Matrix3Xd &rest, const SurfaceGraph &surface,
                                       const std::vector<int> &tag, const std::vector<Index> &nodeTag,
                                       const Eigen::Matrix3Xd &centers, Index &placed) {
    const Index k = Index(centers.cols());
    Eigen::Matrix3Xf position(3, k);
    for (Index i = 0; i < k; ++i) {
        if (!centers.col(i).allFinite())
            throw Error("A node of the deformation graph has a coordinate that is not a finite number.");
        const double most = 1e15; // squares of it are floats
        position.col(i) =
            surface.frame.ToFrame(Eigen::Vector3d(centers.col(i))).cwiseMin(most).cwiseMax(-most).cast<float>();
    }
    // What lies beside held vertices alone is on the mesh, too.
    std::vector<float> distance(k, std::numeric_limits<float>::infinity());
    std::vector<Index> nearest(k, -1);
    if (surface.graph.Size() > 0) {
        NodeTree tree(surface.graph.position);
        for (Index i = 0; i < k; ++i) {
            unsigned found = 0;
            float d = 0;
            tree->doQueryClosest(tree.Point(position.col(i)), found, d);
            nearest[i] = Index(found);
            distance[i] = (surface.graph.position.col(found) - position.col(i)).norm();
        }
    }
    NodeTree centerTree(position);
    // As far as patches reach: half-way to the next centre, or as k of them do that share the surface.
    const double shared = std::sqrt(surface.area / (double(EIGEN_PI) * double(k)));
    const double patchRadius = std::min(0.25, std::max(shared, 0.5 * double(SpacingOf(centerTree, position))));
    const float tooFar = float(std::max(patchRadius, surface.averageEdge) + 1e-5); // of the frame's diagonal, 1
    if (std::any_of(distance.begin(), distance.end(), [&](float d) { return d > tooFar; })) {
        std::vector<vcg::Point3f> held;
        for (std::size_t i = 0; i < tag.size(); ++i)
            if (tag[i] != 1 && surface.nodeOf[i] < 0 && tag[i] != noVertex) {
                const Eigen::Vector3d p = surface.frame.ToFrame(Eigen::Vector3d(rest.col(Eigen::Index(i))));
                if (p.cwiseAbs().maxCoeff() < 1e15)
                    held.push_back(NodeTree::Point(p.cast<float>()));
            }
        if (!held.empty()) {
            vcg::KdTree<float> heldTree(vcg::ConstDataWrapper<vcg::Point3f>(held.data(), int(held.size())));
            for (Index i = 0; i < k; ++i) {
                unsigned found = 0;
                float d = 0;
                heldTree.doQueryClosest(NodeTree::Point(position.col(i)), found, d);
                const float here = vcg::Distance(held[found], NodeTree::Point(position.col(i)));
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
        message
            << "Only " << placed << " of the " << k << " given nodes lie on the surface (within "
            << tooFar * surface.frame.scale
            << " of a vertex): they seem to belong to another mesh, or to this one in another place. Give the graph "
               "of this mesh, move it to where the mesh is, or let a graph be built.";
        throw Error(message.str());
    }
    return node;
}

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
