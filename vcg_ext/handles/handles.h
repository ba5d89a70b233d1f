// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HANDLES_H
#define VCG_FCD_HANDLES_H

#include <vcg_ext/base/graph.h>

#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace vcg::fcd {

/// An affine motion, and the way there: any percentage of it.
struct Motion {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity(); ///< the whole motion, mesh units

    /// The rotation where it goes half a turn or further, which the matrix cannot tell: along its axis, as long as its
    /// angle in radians. 0: the shortest rotation to the matrix.
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero(); ///< a point on the axis of turn, mesh units at rest

    Motion() = default;

    /// \throw BadInput when \p m is not affine, not finite, mirrors or flattens
    explicit Motion(const Eigen::Matrix4d &m);

    /// A motion that rotates by \p wholeTurn (along the axis, as long as the angle in radians, any number of full
    /// turns) about an axis through \p point. The shortest rotation is taken instead where \p wholeTurn is less than
    /// half a turn, not finite, or not the rotation of \p m. \throw BadInput as above
    Motion(const Eigen::Matrix4d &m, const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point);

    /// The rotation of the whole way: along its axis, as long as its angle in radians.
    Eigen::Vector3d Rotation() const;
    /// Whether it does more than shift.
    bool Turns() const { return matrix.topLeftCorner<3, 3>() != Eigen::Matrix3d::Identity() || !turn.isZero(0); }

    /// The motion at \p percent of its way, seen from \p center: the point goes along a screw, the rotation by the
    /// fraction of its angle, scaling by the power. With a turn, the point goes about the pivot's axis by the fraction
    /// of the turn, and straight by the fraction of what that leaves. 100 is the motion itself, to the bit; 0 the
    /// identity; beyond 100 it goes on.
    Eigen::Matrix4d At(double percent, const Eigen::Vector3d &center) const;

  private:
    void SetTurn(const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point);
};

/// Several motions of one handle at once, each at \p percent of its way, in no order (after M. Alexa, Linear
/// Combination of Transformations, 2002): their rotations, along the axes and as long as the angles, with full turns,
/// add up, and so do the logarithms of what they scale by, and how far each moves \p center, as Motion::At tells, but
/// that the center also turns by the others on its way, as far as these turn it about the same axis or joint: 2 a b /
/// (a^2 + b^2) of it for the vectors a and b from the center to the nearest places on both axes, and 0 where their
/// product is negative. So turns about one axis keep the center on its circle, and neither a shift nor a turn about the
/// center itself changes the way of another. One motion alone is what At gives. \param motions with percent \param
/// center of the handle at rest, mesh units \return the blended motion, at 100 percent; parts of it mean nothing \throw
/// BadInput a number that is no longer finite
Motion Blend(const std::vector<std::pair<Motion, double>> &motions, const Eigen::Vector3d &center);

/// A landmark: a single vertex that is put somewhere, while the surface turns freely there.
struct PointHandle {
    std::size_t vertex;     ///< slot of a free vertex
    Eigen::Vector3d target; ///< where it goes, mesh units
};

/// Which vertices are held and how they move.
struct Handles {
    std::vector<int>
        tag; ///< one per vertex slot: 0 fixed, 1 free, >= 2 handle, negative = outside the region of influence
    std::map<int, Motion> motion;   ///< by handle tag, in the world; a handle without one stays where it is
    std::vector<PointHandle> point; ///< in addition to the tags
    /// The matrix of the layer: from mesh units to the world, in which motions are given and lengths are measured.
    Eigen::Affine3d world = Eigen::Affine3d::Identity();

    /// \param motion in the world \return the same motion in mesh units
    Eigen::Matrix4d ToMesh(const Eigen::Matrix4d &motion) const;
};

/// The tag of a deleted vertex slot, in arrays of tags without a mesh beside them.
constexpr int noVertex = std::numeric_limits<int>::min();

/// Live vertices by their tag.
struct TagCount {
    Index fixed = 0, handle = 0, free = 0, outside = 0;
};

/// \throw BadInput when \p tag has not one value for each of \p slots
void ExpectTags(const std::vector<int> &tag, std::size_t slots);

/// \param tag one per vertex slot \param deleted flags of slots that do not count; null: none
TagCount CountTags(const std::vector<int> &tag, const char *deleted, unsigned threads = 0);

} // namespace vcg::fcd

#endif
