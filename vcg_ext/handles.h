// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HANDLES_H
#define VCG_FCD_HANDLES_H

#include "graph.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace vcg {
namespace fcd {

/// An affine motion, and the way there: any percentage of it.
struct Motion {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity(); ///< the whole motion, mesh units

    /// The rotation where it goes half a turn or further, which the matrix cannot tell: along its axis, as long as its
    /// angle in radians. 0: the shortest rotation to the matrix.
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero(); ///< a point on the axis of turn, mesh units at rest

    Motion() = default;

    /// \throw Error when \p m is not affine, not finite, mirrors or flattens
    explicit Motion(const Eigen::Matrix4d &m) : matrix(m) {
        ExpectFinite(m);
        if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
            throw Error("A transform is not affine: the last row of its 4 x 4 matrix must be 0 0 0 1.");
        // Of a matrix of size one: the determinants of large and small ones leave the range of numbers.
        const Eigen::Matrix3d linear = m.topLeftCorner<3, 3>(), unit = linear / linear.cwiseAbs().maxCoeff();
        if (!(unit.determinant() > 1e-12 * std::pow(unit.norm(), 3)))
            throw Error(
                "A transform mirrors or flattens its handle (determinant <= 0); give a rotation, a translation, "
                "a scaling, or a combination of them.");
    }

    /// A motion that rotates by \p wholeTurn (along the axis, as long as the angle in radians, any number of full
    /// turns) about an axis through \p point. The shortest rotation is taken instead where \p wholeTurn is less than
    /// half a turn, not finite, or not the rotation of \p m. \throw Error as above
    Motion(const Eigen::Matrix4d &m, const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point) : Motion(m) {
        SetTurn(wholeTurn, point);
    }

    /// The motion at \p percent of its way, seen from \p center: the point goes along a screw, the rotation by the
    /// fraction of its angle, scaling by the power. With a turn, the point goes about the pivot's axis by the fraction
    /// of the turn, and straight by the fraction of what that leaves. 100 is the motion itself, to the bit; 0 the
    /// identity; beyond 100 it goes on.
    Eigen::Matrix4d At(double percent, const Eigen::Vector3d &center) const {
        if (percent == 100)
            return matrix;
        if (percent == 0)
            return Eigen::Matrix4d::Identity();
        const double t = percent / 100;
        const Eigen::Matrix3d linear = matrix.topLeftCorner<3, 3>();
        const Polar polar(linear);
        // Motion of the center with the rotation.
        Eigen::Matrix4d rigid = Eigen::Matrix4d::Identity();
        rigid.topLeftCorner<3, 3>() = polar.rotation;
        rigid.topRightCorner<3, 1>() = linear * center + matrix.topRightCorner<3, 1>() - polar.rotation * center;
        const Eigen::Matrix4d part = turn.isZero(0) ? Screw(rigid, t) : Turned(rigid, center, t);
        Eigen::Matrix4d result = part;
        result.topLeftCorner<3, 3>() = part.topLeftCorner<3, 3>() * polar.Stretch(t);
        const Eigen::Vector3d moved = (part * center.homogeneous()).head<3>();
        result.topRightCorner<3, 1>() = moved - result.topLeftCorner<3, 3>() * center;
        return result;
    }

  private:
    static void ExpectFinite(const Eigen::Matrix4d &m) {
        if (!m.allFinite())
            throw Error("A transform holds a number that is not finite.");
    }

    void SetTurn(const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point) {
        const double angle = wholeTurn.norm();
        if (!std::isfinite(angle) || !point.allFinite() || angle < 3.14159)
            return;
        // The tolerance is for layers placed in single precision.
        const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, wholeTurn / angle).toRotationMatrix();
        if ((Polar(matrix.topLeftCorner<3, 3>()).rotation - rotation).norm() > 1e-5)
            return;
        turn = wholeTurn;
        pivot = point;
    }

    /// linear = rotation * Stretch(1)
    struct Polar {
        Eigen::JacobiSVD<Eigen::Matrix3d> svd;
        Eigen::Matrix3d rotation;

        explicit Polar(const Eigen::Matrix3d &linear)
            : svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV),
              rotation(svd.matrixU() * svd.matrixV().transpose()) {} // det > 0, as linear's

        Eigen::Matrix3d Stretch(double power) const {
            return svd.matrixV() * svd.singularValues().array().pow(power).matrix().asDiagonal() *
                   svd.matrixV().transpose();
        }
    };

    /// The fraction t of \p rigid by way of the turn, for \p center.
    Eigen::Matrix4d Turned(const Eigen::Matrix4d &rigid, const Eigen::Vector3d &center, double t) const {
        // Axis and angle are those of the matrix, so that the way ends there, but near the identity, which has no axis.
        const double fullTurn = 2 * std::acos(-1.0);
        const Eigen::AngleAxisd shortest(Eigen::Matrix3d(rigid.topLeftCorner<3, 3>()));
        Eigen::Vector3d axis = turn.normalized();
        const double side = shortest.axis().dot(axis);
        double angle = shortest.angle() * side;
        if (shortest.angle() > 1e-6) {
            axis = side < 0 ? Eigen::Vector3d(-shortest.axis()) : shortest.axis();
            angle = side < 0 ? -shortest.angle() : shortest.angle();
        }
        angle += fullTurn * std::round((turn.norm() - angle) / fullTurn);

        const Eigen::Matrix3d rotation = Eigen::AngleAxisd(t * angle, axis).toRotationMatrix();
        const Eigen::Vector3d arm = center - pivot;
        const Eigen::Vector3d rest =
            (rigid * center.homogeneous()).head<3>() - rigid.topLeftCorner<3, 3>() * arm - pivot;
        Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
        result.topLeftCorner<3, 3>() = rotation;
        result.topRightCorner<3, 1>() = pivot + rotation * arm + t * rest - rotation * center;
        return result;
    }

    /// exp(t log(rigid)) on SE(3).
    static Eigen::Matrix4d Screw(const Eigen::Matrix4d &rigid, double t) {
        const Eigen::AngleAxisd turn(Eigen::Matrix3d(rigid.topLeftCorner<3, 3>()));
        const Eigen::Vector3d &axis = turn.axis();
        const Eigen::Vector3d d = rigid.topRightCorner<3, 1>();
        const double angle = turn.angle();
        Eigen::Matrix4d result = Eigen::Matrix4d::Identity();
        result.topLeftCorner<3, 3>() = Eigen::AngleAxisd(t * angle, axis).toRotationMatrix();
        // d = along the axis + across it; the part across is a rotation about a parallel axis through q.
        const Eigen::Vector3d along = axis * axis.dot(d), across = d - along;
        if (angle < 1e-9) {
            result.topRightCorner<3, 1>() = t * d;
            return result;
        }
        const Eigen::Vector3d q = 0.5 * (across + axis.cross(across) / std::tan(angle / 2));
        result.topRightCorner<3, 1>() = t * along + q - result.topLeftCorner<3, 3>() * q;
        return result;
    }
};

/// A single vertex that is put somewhere; how the surface turns there is left to it.
struct PointHandle {
    std::size_t vertex;     ///< slot of a free vertex
    Eigen::Vector3d target; ///< where it goes, mesh units
};

/// Which vertices are held and how they move.
struct Handles {
    std::vector<int>
        tag; ///< one per vertex slot: 0 fixed, 1 free, >= 2 handle, negative = outside the region of influence
    std::map<int, Motion> motion;   ///< of the handle tags, in the world; a handle tag without one stays where it is
    std::vector<PointHandle> point; ///< in addition to the tags
    /// From mesh units to the world that motions are given in and lengths are measured in: the matrix of the layer.
    Eigen::Affine3d world = Eigen::Affine3d::Identity();

    /// A motion in the world in mesh units.
    Eigen::Matrix4d ToMesh(const Eigen::Matrix4d &motion) const {
        if (world.matrix().isIdentity(0) || motion.isIdentity(0))
            return motion;
        Eigen::Matrix4d m = (world.inverse() * Eigen::Affine3d(motion) * world).matrix();
        m.row(3) << 0, 0, 0, 1;
        return m;
    }
};

/// The tag of a vertex slot that is deleted, where tags stand for themselves without a mesh.
constexpr int noVertex = std::numeric_limits<int>::min();

/// Live vertices by their tag.
struct TagCount {
    Index fixed = 0, handle = 0, free = 0, outside = 0;
};

} // namespace fcd

namespace tri {

/// \param tag one per vertex slot \throw fcd::Error when there are fewer or more
template <class MeshType>
fcd::TagCount CountTags(const MeshType &m, const std::vector<int> &tag, unsigned threads = 0) {
    if (tag.size() != m.vert.size())
        throw fcd::Error("There are " + std::to_string(tag.size()) + " tags for " + std::to_string(m.vert.size()) +
                         " vertices; give one tag per vertex.");
    const std::size_t grain = 1 << 16;
    std::vector<fcd::TagCount> counts((tag.size() + grain - 1) / grain);
    const bool isCompact = std::size_t(m.vn) == m.vert.size(); // then no vertex need be looked at
    fcd::ParallelFor(threads, tag.size(), grain, [&](std::size_t first, std::size_t last) {
        fcd::TagCount here;
        for (std::size_t i = first; i < last; ++i)
            if (isCompact || !m.vert[i].IsD())
                ++(tag[i] < 0 ? here.outside : tag[i] == 0 ? here.fixed : tag[i] == 1 ? here.free : here.handle);
        counts[first / grain] = here;
    });
    fcd::TagCount count;
    for (const fcd::TagCount &here : counts) {
        count.fixed += here.fixed;
        count.handle += here.handle;
        count.free += here.free;
        count.outside += here.outside;
    }
    return count;
}

} // namespace tri

} // namespace vcg

#endif
