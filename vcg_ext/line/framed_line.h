// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FRAMED_LINE_H
#define VCG_FCD_FRAMED_LINE_H

#include <Eigen/Core>
#include <vector>

namespace vcg::fcd {

/// The most that a line is smoothed over, of its length.
constexpr double mostSmoothing = 0.25;

/// A smooth line through some points, by its length, with rotation-minimising frames (double reflection; W. Wang,
/// B. Juettler, D. Zheng, Y. Liu: Computation of rotation minimizing frames, 2008).
///
/// Between two points it is a cubic; its tangent at a point is that of the circle through it and its two neighbours, so
/// that points of a circle give this circle, however they are spaced. Beyond its ends it goes on straight.
class FramedLine {
  public:
    /// What is at one place of the line.
    struct Frame {
        Eigen::Vector3d point;
        Eigen::Matrix3d axes; ///< orthonormal columns: the tangent and the two directions across, right-handed
        Eigen::Vector3d bend; ///< the curvature vector, 1 over a length: how the tangent changes along the line
    };

    /// \param points 3 x n, in their order, any unit \param smoothing in [0, mostSmoothing]: wiggles that are shorter
    /// than some
    ///        six times this share of the length are smoothed away; 0: it goes through its points
    /// \throw BadInput fewer than two points, one that is not finite, two in a row at one place, a line that is closed
    ///        or turns back on itself, a smoothing out of range
    explicit FramedLine(const Eigen::Matrix3Xd &points, double smoothing = 0);

    double Length() const { return length; }
    /// \param s from its beginning, along it
    Frame At(double s) const;
    /// The s of the place nearest to \p p. Only [from, to] is searched at first. At an end of the line it may lie
    /// beyond.
    double Nearest(const Eigen::Vector3d &p, double from, double to) const;
    /// The mean of its places.
    Eigen::Vector3d Middle() const;
    /// Turns all frames about the tangents, by one angle, so that at \p s the first direction across is as near to
    /// \p across as it may be. \pre \p across is not along the tangent there
    void TurnTo(double s, const Eigen::Vector3d &across);

  private:
    void Resample(const Eigen::Matrix3Xd &dense);
    void Smooth(double sigma);
    void FindFrames();

    double length = 0, step = 0;     // step: between places
    Eigen::Matrix3Xd point;          // at equal lengths
    Eigen::Matrix3Xd tangent, bend;  // at these
    std::vector<Eigen::Vector3d> up; // the first direction across
};

} // namespace vcg::fcd

#endif
