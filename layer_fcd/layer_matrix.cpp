// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_labels.h"
#include "layer_matrix.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <string>

using vcg::fcd::Error;

namespace {

bool isInvertible(const Eigen::Matrix3d &linear) {
    return linear.allFinite() && Eigen::FullPivLU<Eigen::Matrix3d>(linear).isInvertible() &&
           std::isnormal(linear.determinant()); // neither overflow nor underflow
}

/// Whether the smallest of three sizes is below \p least of the largest.
bool isFlat(const Eigen::Vector3d &descending, double least) { return !(descending[2] > least * descending[0]); }

Eigen::Vector3d singularValues(const Eigen::Matrix3d &matrix) {
    return Eigen::JacobiSVD<Eigen::Matrix3d>(matrix).singularValues();
}

Eigen::Vector3d middleOf(const std::vector<Eigen::Vector3d> &points) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d &point : points)
        sum += point;
    return sum / double(points.size());
}

} // namespace

Eigen::Affine3d matrixOf(const MeshModel &layer) {
    Eigen::Matrix4d matrix;
    layer.cm.Tr.ToEigenMatrix(matrix);
    const std::string name = "The matrix of the layer " + inQuotes(layer) + " ";
    if (!matrix.allFinite())
        throw Error(name + "holds a number that is not finite. Reset the matrix.");
    if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
        throw Error(name + "is a projection: its last row is not 0 0 0 1. Reset the matrix.");
    return Eigen::Affine3d(matrix);
}

Eigen::Matrix3d metricOf(const MeshModel &layer) {
    Eigen::Matrix4d matrix;
    layer.cm.Tr.ToEigenMatrix(matrix);
    const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
    return isInvertible(linear) ? linear : Eigen::Matrix3d::Identity();
}

Eigen::Affine3d invertibleMatrixOf(const MeshModel &layer) {
    const Eigen::Affine3d matrix = matrixOf(layer);
    if (!isInvertible(matrix.linear()))
        throw Error("The matrix of the layer " + inQuotes(layer) +
                    " cannot be inverted, so its world coordinates have no way back. Reset the matrix, or freeze it.");
    return matrix;
}

Eigen::Matrix4d motionTo(const MeshModel &other, const MeshModel &layer) {
    return (matrixOf(other) * invertibleMatrixOf(layer).inverse()).matrix();
}

Eigen::Matrix3Xd positionsIn(const Eigen::Affine3d &to, const MeshModel &layer) {
    const Eigen::Affine3d from = matrixOf(layer);
    const bool same = from.matrix() == to.matrix();
    const Eigen::Affine3d change = to.inverse() * from;
    Eigen::Matrix3Xd positions(3, layer.cm.vn);
    Eigen::Index next = 0;
    for (const CVertexO &vertex : layer.cm.vert)
        if (!vertex.IsD()) {
            const Eigen::Vector3d position = vcg::tri::PositionOf(vertex);
            positions.col(next++) = same ? position : change * position;
        }
    return positions;
}

std::optional<Eigen::Affine3d> affineMapOf(const std::vector<Eigen::Vector3d> &from,
                                           const std::vector<Eigen::Vector3d> &to, double rounding) {
    if (from.empty())
        return {};
    const Eigen::Vector3d middle = middleOf(from), newMiddle = middleOf(to);
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero(), both = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < from.size(); ++i) {
        spread += (from[i] - middle) * (from[i] - middle).transpose();
        both += (to[i] - newMiddle) * (from[i] - middle).transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> axes(spread, Eigen::ComputeFullU);
    Eigen::Affine3d map;
    Eigen::Matrix3d inverse = spread.inverse(); // in the plane of the points, if they lie in one
    // A thousandth, squared: beside points that are thinner, the map would be off by thousands of roundings.
    const double thin = 1e-6;
    if (!isFlat(axes.singularValues(), thin)) {
        map.linear() = both * inverse;
    } else if (axes.singularValues()[1] > thin * axes.singularValues()[0]) {
        // Points in a plane tell the map beside it if they were turned, moved and scaled as a whole, not mirrored.
        const Eigen::Vector3d u = axes.matrixU().col(0), v = axes.matrixU().col(1),
                              a = both * u / axes.singularValues()[0], b = both * v / axes.singularValues()[1],
                              normal = a.cross(b);
        const double alike = 1e-3;
        if (!(std::abs(a.norm() - b.norm()) <= alike * a.norm() && std::abs(a.dot(b)) <= alike * normal.norm()))
            return {};
        inverse = u * u.transpose() / axes.singularValues()[0] + v * v.transpose() / axes.singularValues()[1];
        map.linear() = a * u.transpose() + b * v.transpose() +
                       normal * (std::sqrt(normal.norm()) / normal.norm()) * u.cross(v).transpose();
    } else {
        return {};
    }
    map.translation() = newMiddle - map.linear() * middle;
    // Sums over many points are rounded by more than a point is, so what they leave is fitted again.
    for (int again = 0; again < 2; ++again) {
        Eigen::Vector3d off = Eigen::Vector3d::Zero();
        Eigen::Matrix3d left = Eigen::Matrix3d::Zero();
        for (std::size_t i = 0; i < from.size(); ++i) {
            off += to[i] - map * from[i];
            left += (to[i] - map * from[i]) * (from[i] - middle).transpose();
        }
        map.linear() += left * inverse;
        map.translation() += off / double(from.size()) - left * inverse * middle;
    }
    if (isFlat(singularValues(map.linear()), 1e-3))
        return {};
    double largest = 0, off = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
        largest =
            std::max(largest, (map.linear().cwiseAbs() * from[i].cwiseAbs() + map.translation().cwiseAbs()).maxCoeff());
        off = std::max(off, (map * from[i] - to[i]).cwiseAbs().maxCoeff());
    }
    if (!(off <= rounding * largest))
        return {};
    return map;
}
