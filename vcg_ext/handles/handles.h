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

/// An affine motion, and the path to it: any percentage of the motion. Units are those of the matrix: mesh or world.
struct Motion {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity(); ///< the whole motion

    /// Rotation vector of a rotation by half a turn or more, which the matrix cannot tell. 0: the shortest rotation of
    /// the matrix.
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    Eigen::Vector3d pivot = Eigen::Vector3d::Zero(); ///< a point on the axis of turn, at rest

    Motion() = default;

    /// \throw BadInput \p m is not affine or not finite, mirrors or flattens
    explicit Motion(const Eigen::Matrix4d &m);

    /// A motion that rotates by the rotation vector \p wholeTurn, with any number of full turns, about an axis through
    /// \p point. If \p wholeTurn is less than half a turn, not finite, or not the rotation of \p m, it is ignored.
    /// \throw BadInput as above
    Motion(const Eigen::Matrix4d &m, const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point);

    /// The rotation vector of the whole motion, with full turns.
    Eigen::Vector3d Rotation() const;
    /// Whether it is more than a translation.
    bool Turns() const { return matrix.topLeftCorner<3, 3>() != Eigen::Matrix3d::Identity() || !turn.isZero(0); }

    /// The motion at \p percent of its path. \p center moves along a screw; the rotation has the fraction of the angle,
    /// the scaling is raised to the power of the fraction. With a turn, \p center turns about the pivot's axis by the
    /// fraction of the turn, and the rest of its path is straight. 0 is the identity, 100 the motion to the bit; the
    /// path goes on beyond 100.
    Eigen::Matrix4d At(double percent, const Eigen::Vector3d &center) const;

  private:
    void SetTurn(const Eigen::Vector3d &wholeTurn, const Eigen::Vector3d &point);
};

/// Several motions of one handle at once, each at a percentage of its path, in no order (after M. Alexa, Linear
/// Combination of Transformations, 2002). These add up over the motions:
/// - the rotation vectors, with full turns;
/// - the logarithms of the scalings;
/// - how far each motion moves \p center (Motion::At).
///
/// While one motion moves the center, the other motions turn it, too, by a share of their turns: 2 a b / (a^2 + b^2),
/// at least 0. The vectors a and b lead from the center to the nearest places on both axes. So turns about one axis
/// keep the center on its circle. A shift, or a turn about the center itself, has no share. One motion alone is what At
/// gives.
/// \param motions with their percentages \param center of the handle at rest, mesh units
/// \return the blended motion, whole; only its end is meant: At of less than 100 percent is no blend
/// \throw BadInput a number is no longer finite
Motion Blend(const std::vector<std::pair<Motion, double>> &motions, const Eigen::Vector3d &center);

/// A point handle: a single vertex with a given position, where the surface turns freely.
struct PointHandle {
    std::size_t vertex;     ///< slot of a free vertex
    Eigen::Vector3d target; ///< its position, mesh units
};

/// The vertices that are held, and their motions.
struct Handles {
    /// One per vertex slot: 0 fixed, 1 free, >= 2 handle, negative: outside the region of influence.
    std::vector<int> tag;
    std::map<int, Motion> motion;   ///< by the tag of the handle, world units; a handle without one stays in place
    std::vector<PointHandle> point; ///< in addition to the tags
    /// The matrix of the layer, from mesh units to world units. Lengths are measured in world units.
    Eigen::Affine3d world = Eigen::Affine3d::Identity();

    /// \param motion world units \return the same motion in mesh units
    Eigen::Matrix4d ToMesh(const Eigen::Matrix4d &motion) const;
};

/// The tag of a deleted vertex slot.
constexpr int noVertex = std::numeric_limits<int>::min();

/// The number of vertices with each kind of tag, without deleted ones.
struct TagCount {
    Index fixed = 0, handle = 0, free = 0, outside = 0;
};

/// \throw BadInput \p tag does not have \p slots values
void ExpectTags(const std::vector<int> &tag, std::size_t slots);

/// \param tag one per vertex slot \param deleted flags of slots that do not count; null: none
TagCount CountTags(const std::vector<int> &tag, const char *deleted);

} // namespace vcg::fcd

#endif
