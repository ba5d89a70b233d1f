// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <vcg/space/index/kdtree/kdtree.h>
#include <vcg/space/point3.h>

namespace vcg {
namespace fcd {

namespace {

template <class Scalar>
vcg::Point3<Scalar> ToVcg(const Eigen::Matrix<Scalar, 3, 1> &p) {
    return {p[0], p[1], p[2]};
}

template <class Scalar>
std::unique_ptr<vcg::KdTree<Scalar>> MakeTree(const std::vector<Eigen::Matrix<Scalar, 3, 1>> &points) {
    assert(!points.empty());
    std::vector<vcg::Point3<Scalar>> copy;
    copy.reserve(points.size());
    for (const auto &p : points)
        copy.push_back(ToVcg<Scalar>(p));
    return std::make_unique<vcg::KdTree<Scalar>>(
        vcg::ConstDataWrapper<vcg::Point3<Scalar>>(copy.data(), int(copy.size())));
}

} // namespace

template <class Scalar>
PointTree<Scalar>::PointTree(const std::vector<Point> &points) : tree(MakeTree<Scalar>(points)), size(points.size()) {}

template <class Scalar>
PointTree<Scalar>::~PointTree() = default;

template <class Scalar>
Index PointTree<Scalar>::Nearest(const Point &p, Scalar *distance) const {
    unsigned nearest = 0;
    Scalar d = 0;
    tree->doQueryClosest(ToVcg<Scalar>(p), nearest, d);
    if (distance)
        *distance = d;
    return Index(nearest);
}

template <class Scalar>
void PointTree<Scalar>::Nearest(const Point &p, std::size_t count, std::vector<Found> &found) const {
    typename vcg::KdTree<Scalar>::PriorityQueue queue; // of its own: one that is used again frees twice without memory
    tree->doQueryK(ToVcg<Scalar>(p), int(std::min(count, size)), queue);
    found.clear();
    for (int i = 0; i < queue.getNofElements(); ++i)
        found.push_back({Index(queue.getIndex(i)), queue.getWeight(i)});
}

template <class Scalar>
Scalar PointTree<Scalar>::DistanceOf(const Point &p, std::size_t count) const {
    typename vcg::KdTree<Scalar>::PriorityQueue queue;
    tree->doQueryK(ToVcg<Scalar>(p), int(std::min(count, size)), queue);
    return std::sqrt(queue.getTopWeight());
}

template <class Scalar>
void PointTree<Scalar>::Within(const Point &p, Scalar distance, std::vector<Index> &found) const {
    std::vector<unsigned> inside;
    std::vector<Scalar> squares;
    tree->doQueryDist(ToVcg<Scalar>(p), distance, inside, squares);
    found.assign(inside.begin(), inside.end());
}

std::unique_ptr<PointTree<float>> TreeOf(const Eigen::Matrix3Xf &position, const std::vector<Index> &node) {
    std::vector<Eigen::Vector3f> points;
    points.reserve(node.size());
    for (Index i : node)
        points.emplace_back(position.col(i));
    return std::make_unique<PointTree<float>>(points);
}

std::unique_ptr<PointTree<float>> TreeOf(const Eigen::Matrix3Xf &position) {
    std::vector<Index> all(std::size_t(position.cols()));
    std::iota(all.begin(), all.end(), 0);
    return TreeOf(position, all);
}

template class PointTree<float>;
template class PointTree<double>;

} // namespace fcd
} // namespace vcg
