// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_MOTION_H
#define VCG_FCD_LINE_MOTION_H

#include <vcg_ext/line/framed_line.h>

#include <Eigen/Core>
#include <functional>

namespace vcg::fcd {

/// The motion of space along a line to another one: each cross-section, at right angles to the line, goes rigidly from
/// the frame of its place to that of the place on the other line; beyond the ends all goes with the last one.
class LineMotion {
  public:
    /// How far it turns the cross-sections about the line, beyond what the frames do: an angle in radians at a place
    /// s, and how it changes there.
    struct Twist {
        double angle = 0, slope = 0;
    };
    using TwistAt = std::function<Twist(double s)>;

    /// Where it takes a point.
    struct Moved {
        Eigen::Vector3d position;
        Eigen::Matrix3d turn;   ///< that of the cross-section
        Eigen::Matrix3d linear; ///< how space turns and stretches there
        double stretch;         ///< along the line, against that of the line itself
        bool isFolded;          ///< it lies behind the centre about which one of the lines turns there
    };

    /// \param length of \p from on \p to, > 0; where that is shorter, it goes on straight. In the middle of it the
    ///        frames of \p to are turned so that the cross-section there turns as little as it may.
    LineMotion(FramedLine from, FramedLine to, double length);

    /// \param s the place of \p p on the line \param p a point of its cross-section there
    Moved At(double s, const Eigen::Vector3d &p) const;

    const FramedLine &From() const { return from; }
    double Length() const { return length; } ///< of it on the other line

    TwistAt twist; ///< empty: none

  private:
    FramedLine from, to;
    double length;
};

/// The points of an arc of a circle, or of a straight line, of a length. \param middle of it \param direction along it
/// in its middle, a unit vector \param towards in whose direction it bends, a unit vector across \param degrees by
/// which it bends, below 360
Eigen::Matrix3Xd ArcPoints(const Eigen::Vector3d &middle, const Eigen::Vector3d &direction,
                           const Eigen::Vector3d &towards, double length, double degrees);

/// How a line is bent to an arc.
struct ArcParam {
    double degrees = 0;                                  ///< 0: straight; (-360, 360)
    Eigen::Vector3d direction = Eigen::Vector3d::Zero(); ///< of its middle; 0: from end to end of the line
    Eigen::Vector3d towards = Eigen::Vector3d::Zero();   ///< where it bends to; 0: where the line does
};

/// The arc of \p length (positive) whose middle is that of \p line.
/// \throw BadInput an angle of 360 degrees or more, or a direction that is none
FramedLine ArcInPlaceOf(const FramedLine &line, double length, const ArcParam &param);

/// Which line goes where.
struct LineGoal {
    Eigen::Matrix3Xd line;   ///< 3 x n, its points in their order
    double smoothing = 0;    ///< as FramedLine takes it; of the target, too
    Eigen::Matrix3Xd target; ///< 3 x m, the points of the line that it goes to; empty: to an arc
    ArcParam arc;
    double length = 0;    ///< that it is to have; 0: it keeps its own
    bool middle = false;  ///< whether it goes through the middles of the surface's cross-sections instead
    bool isFound = false; ///< whether LineOf has found the line already
    bool untwist = false; ///< whether the twist of the surface about it is taken out
};

/// The motion from one line to the other, without what only the surface tells: middle and untwist.
/// \throw BadInput what is wrong with one of the lines, naming the target as such
LineMotion MotionTo(const LineGoal &goal);

} // namespace vcg::fcd

#endif
