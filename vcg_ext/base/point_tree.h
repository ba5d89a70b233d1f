// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_POINT_TREE_H
#define VCG_FCD_POINT_TREE_H

#include <vcg_ext/base/graph.h>

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace vcg {

template <class Scalar>
class KdTree;

namespace fcd {

/// Finds the nearest of some points: VCG's k-d tree, compiled once for float and double. Any number of threads may ask.
template <class Scalar>
class PointTree {
  public:
    using Point = Eigen::Matrix<Scalar, 3, 1>;
    struct Found {
        Index point;   ///< its number
        Scalar square; ///< of its distance
    };

    /// \param points at least one
    explicit PointTree(const std::vector<Point> &points);
    ~PointTree();
    PointTree(const PointTree &) = delete;
    PointTree &operator=(const PointTree &) = delete;

    /// \return the number of the point nearest to \p p \param distance of it, if given
    Index Nearest(const Point &p, Scalar *distance = nullptr) const;
    /// The \p count points nearest to \p p, or all where there are fewer, in no order.
    void Nearest(const Point &p, std::size_t count, std::vector<Found> &found) const;
    /// The distance of the farthest of these.
    Scalar DistanceOf(const Point &p, std::size_t count) const;
    /// The points no farther than \p distance from \p p, in no order.
    void Within(const Point &p, Scalar distance, std::vector<Index> &found) const;

  private:
    const std::unique_ptr<vcg::KdTree<Scalar>> tree;
    const std::size_t size;
};

/// Over some nodes of a graph. \param position 3 x n \param node which of them, at least one; the tree numbers them in
/// this order
std::unique_ptr<PointTree<float>> TreeOf(const Eigen::Matrix3Xf &position, const std::vector<Index> &node);
/// Over all of them.
std::unique_ptr<PointTree<float>> TreeOf(const Eigen::Matrix3Xf &position);

extern template class PointTree<float>;
extern template class PointTree<double>;

} // namespace fcd
} // namespace vcg

#endif
