// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FRAMED_LINE_H
#define VCG_FCD_FRAMED_LINE_H

#include <Eigen/Core>
#include <vector>

namespace vcg::fcd {

/// The largest smoothing, a share of the line's length.
constexpr double mostSmoothing = 0.25;

/// A smooth line through points, by arc length, with rotation-minimising frames (double reflection; W. Wang, B.
/// Juettler, D. Zheng, Y. Liu: Computation of rotation minimizing frames, 2008).
///
/// Between two points it is a cubic. The tangent at a point is that of the circle through it and its two neighbours:
/// points on a circle give this circle, however spaced. Beyond its ends, the line is straight.
class FramedLine {
  public:
    /// The line at one place.
    struct Frame {
        Eigen::Vector3d point;
        Eigen::Matrix3d axes; ///< orthonormal columns: the tangent and the two directions across, right-handed
        Eigen::Vector3d bend; ///< the curvature vector, 1 / length
    };

    /// \param points 3 x n, in order, any unit
    /// \param smoothing in [0, mostSmoothing], a share of the length: wiggles of four times that are halved, shorter
    /// ones vanish; 0: the line goes through its points \throw BadInput fewer than two points, one that is not finite,
    /// two in a row at one position, a line that is closed or turns back on itself, a smoothing out of range
    explicit FramedLine(const Eigen::Matrix3Xd &points, double smoothing = 0);

    double Length() const { return length; }
    /// \param s arc length from the beginning; may lie beyond the ends
    Frame At(double s) const;
    /// The s of the place nearest to \p p, within [from, to] or a step beside it. If that is an end of the line, s may
    /// lie beyond it.
    double Nearest(const Eigen::Vector3d &p, double from, double to) const;
    /// The mean of its points, by arc length.
    Eigen::Vector3d Middle() const;
    /// Turns all frames about their tangents by one angle, so that at \p s the first direction across is as near to
    /// \p across as possible. \pre \p across is not along the tangent there
    void TurnTo(double s, const Eigen::Vector3d &across);

  private:
    void Resample(const Eigen::Matrix3Xd &dense);
    void Smooth(double sigma);
    void FindFrames();

    double length = 0, step = 0;     // step: arc length between points
    Eigen::Matrix3Xd point;          // at equal steps of arc length
    Eigen::Matrix3Xd tangent, bend;  // at these
    std::vector<Eigen::Vector3d> up; // the first direction across
};

} // namespace vcg::fcd

#endif
