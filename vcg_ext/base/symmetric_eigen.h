// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SYMMETRIC_EIGEN_H
#define VCG_FCD_SYMMETRIC_EIGEN_H

#include <vcg_ext/base/elementary.h>

#include <Eigen/Geometry>

namespace vcg::fcd::detail {

/// The sum of squares of points about their mean: how far they extend in each direction. \param at the place of point k
template <class At>
Eigen::Matrix3d ScatterOf(std::size_t count, const At &at) {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < count; ++k)
        middle += at(k) / double(count);
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (std::size_t k = 0; k < count; ++k) {
        const Eigen::Vector3d offset = at(k) - middle;
        scatter += offset * offset.transpose();
    }
    return scatter;
}

/// Eigenvalues and eigenvectors of a symmetric 3 x 3 matrix in closed form, about as good as Eigen's computeDirect, but
/// with the same bits everywhere (O. K. Smith, Eigenvalues of a symmetric 3 x 3 matrix, 1961).
class SymmetricEigen {
  public:
    explicit SymmetricEigen(const Eigen::Matrix3d &m) : even(m) {
        const double mean = m.trace() / 3;
        even.diagonal().array() -= mean;
        const double scale = even.cwiseAbs().maxCoeff();
        if (scale > 0)
            even /= scale;
        const double p = even.squaredNorm() / 6, q = even.determinant() / 2;
        const double angle = ArcTangent(std::sqrt(std::max(0., p * p * p - q * q)), q) / 3;
        const double cosine = std::sqrt(p) * Cosine(angle), sine = std::sqrt(3 * p) * Sine(angle);
        root = {-cosine - sine, -cosine + sine, 2 * cosine};
        values = (scale * root).array() + mean;
    }

    /// The eigenvectors as columns: orthonormal, in the order of the values.
    Eigen::Matrix3d Vectors() const {
        if (!(root[2] > root[0]))
            return Eigen::Matrix3d::Identity();
        const int alone = root[2] - root[1] > root[1] - root[0] ? 2 : 0; // the root farthest from the others
        Eigen::Matrix3d flat = even;
        flat.diagonal().array() -= root[alone];
        Eigen::Matrix3d vectors, across;
        across << flat.col(0).cross(flat.col(1)), flat.col(1).cross(flat.col(2)), flat.col(2).cross(flat.col(0));
        int largest;
        across.colwise().squaredNorm().maxCoeff(&largest);
        vectors.col(alone) = across.col(largest).normalized();
        // In the plane perpendicular to it, a 2 x 2 matrix is left.
        const Eigen::Vector3d u = vectors.col(alone).unitOrthogonal(), w = vectors.col(alone).cross(u);
        const double half = 0.5 * (u.dot(even * u) - w.dot(even * w)), beside = u.dot(even * w);
        const double length = std::sqrt(half * half + beside * beside);
        Eigen::Vector2d upper(half > 0 ? half + length : beside, half > 0 ? beside : length - half);
        if (upper.isZero(0))
            upper = {1, 0};
        upper.normalize();
        vectors.col(alone == 2 ? 1 : 2) = upper[0] * u + upper[1] * w;
        vectors.col(alone == 2 ? 0 : 1) = upper[0] * w - upper[1] * u;
        return vectors;
    }

    Eigen::Vector3d values; ///< ascending

  private:
    Eigen::Matrix3d even; ///< the matrix, shifted to trace 0 and scaled to entries of 1 at most
    Eigen::Vector3d root; ///< its eigenvalues
};

} // namespace vcg::fcd::detail

#endif
