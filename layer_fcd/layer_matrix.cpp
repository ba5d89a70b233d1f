// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_labels.h"
#include "layer_matrix.h"

#include <Eigen/LU>

#include <cmath>
#include <string>

using vcg::fcd::Error;

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

namespace {

bool isInvertible(const Eigen::Matrix3d &linear) {
    return linear.allFinite() && Eigen::FullPivLU<Eigen::Matrix3d>(linear).isInvertible() &&
           std::isnormal(linear.determinant()); // neither overflow nor underflow
}

} // namespace

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
