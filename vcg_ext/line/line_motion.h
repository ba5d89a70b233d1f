// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_MOTION_H
#define VCG_FCD_LINE_MOTION_H

#include <vcg_ext/line/framed_line.h>

#include <Eigen/Core>
#include <functional>

namespace vcg::fcd {

/// The motion of space from a line to another one. Each cross-section, at right angles to the line, moves rigidly from
/// its frame to the frame on the other line. Beyond an end, space moves as the last cross-section.
class LineMotion {
  public:
    /// An additional turn of a cross-section about the line: radians, and their derivative along the line.
    struct Twist {
        double angle = 0, slope = 0;
    };
    using TwistAt = std::function<Twist(double s)>;

    /// A moved point.
    struct Moved {
        Eigen::Vector3d position;
        Eigen::Matrix3d turn;   ///< rotation of the cross-section
        Eigen::Matrix3d linear; ///< linear map of space there
        double stretch;         ///< along the line, over that of the line itself
        bool isFolded;          ///< it lies beyond the centre of curvature of one of the lines
    };

    /// \param length of \p from on \p to, > 0; \p to is extended straight if it is shorter. The frames of \p to are
    /// turned so that the middle cross-section turns as little as possible.
    LineMotion(FramedLine from, FramedLine to, double length);

    /// \param s the place on the line whose cross-section has \p p
    Moved At(double s, const Eigen::Vector3d &p) const;

    const FramedLine &From() const { return from; }
    double Length() const { return length; } ///< on the other line

    TwistAt twist; ///< empty: none

  private:
    FramedLine from, to;
    double length;
};

/// Points of an arc, or of a straight line. \param middle of the arc \param direction along it in the middle, a unit
/// vector \param towards the side to which it bends, a unit vector across \param length of the arc \param degrees by
/// which it bends, in (-360, 360); 0: straight
Eigen::Matrix3Xd ArcPoints(const Eigen::Vector3d &middle, const Eigen::Vector3d &direction,
                           const Eigen::Vector3d &towards, double length, double degrees);

/// How a line is bent to an arc.
struct ArcParam {
    double degrees = 0;                                  ///< 0: straight; (-360, 360)
    Eigen::Vector3d direction = Eigen::Vector3d::Zero(); ///< in its middle; 0: from end to end of the line
    Eigen::Vector3d towards = Eigen::Vector3d::Zero();   ///< the side to which it bends; 0: as the line does
};

/// The arc of \p length > 0 around the mean point of \p line. \throw BadInput 360 degrees or more, a direction that is
/// not finite, or a side along the direction
FramedLine ArcInPlaceOf(const FramedLine &line, double length, const ArcParam &param);

/// A line, and where it is moved to; world units.
struct LineGoal {
    Eigen::Matrix3Xd line;   ///< 3 x n, points in order
    double smoothing = 0;    ///< as in FramedLine; of both lines
    Eigen::Matrix3Xd target; ///< 3 x m, points of the other line; empty: an arc
    ArcParam arc;
    double length = 0;    ///< on the other line; 0: as before
    bool middle = false;  ///< use the line through the middles of the surface's cross-sections instead
    bool isFound = false; ///< LineOf has found the line already
    bool untwist = false; ///< remove the twist of the surface about the line
};

/// The motion from one line to the other, without middle and untwist, which need the surface. \throw BadInput a length
/// that is negative or not finite; as FramedLine, of either line, and as ArcInPlaceOf
LineMotion MotionTo(const LineGoal &goal);

} // namespace vcg::fcd

#endif
