// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NODE_TREE_H
#define VCG_FCD_NODE_TREE_H

#include "graph.h"

#include <Eigen/Core>
#include <numeric>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>
#include <vector>

namespace vcg {
namespace fcd {

/// Finds the nearest of some nodes.
class NodeTree {
  public:
    /// \param position 3 x n \param node which of them, at least one; the tree numbers them in this order
    NodeTree(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) : NodeTree(PointsOf(position, node)) {}
    /// Of all nodes.
    explicit NodeTree(const Eigen::Matrix3Xf &position) : NodeTree(position, All(Index(position.cols()))) {}

    static vcg::Point3f Point(const Eigen::Vector3f &p) { return vcg::Point3f(p[0], p[1], p[2]); }
    vcg::KdTree<float> *operator->() { return &tree; }

  private:
    explicit NodeTree(const std::vector<vcg::Point3f> &point)
        : tree(vcg::ConstDataWrapper<vcg::Point3f>(point.data(), int(point.size()))) {}

    static std::vector<Index> All(Index n) {
        std::vector<Index> all(n);
        std::iota(all.begin(), all.end(), 0);
        return all;
    }

    static std::vector<vcg::Point3f> PointsOf(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) {
        std::vector<vcg::Point3f> point;
        point.reserve(node.size());
        for (Index i : node)
            point.push_back(Point(position.col(i)));
        return point;
    }

    vcg::KdTree<float> tree;
};

} // namespace fcd
} // namespace vcg

#endif
