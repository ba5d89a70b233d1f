// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_CAMERA_H
#define FCD_CAMERA_H

#include <Eigen/Geometry>

/// Maps world to window coordinates (pixels of the device, y up; depth 0 to 1) and back.
struct Camera {
    Eigen::Matrix4d toClip = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d fromClip = Eigen::Matrix4d::Identity();
    int width = 1, height = 1;

    Eigen::Vector3d toWindow(const Eigen::Vector3d &world) const; ///< depth > 1: behind the eye
    Eigen::Vector3d toWorld(const Eigen::Vector3d &window) const;
    /// The direction from \p at to the eye, of length 1, world.
    Eigen::Vector3d towardsEye(const Eigen::Vector3d &at) const;
    /// The size of a pixel at \p at, world units.
    double pixelAt(const Eigen::Vector3d &at) const;
};

/// The distance of \p p from the segment from \p a to \p b.
double distanceToSegment(const Eigen::Vector2d &p, const Eigen::Vector2d &a, const Eigen::Vector2d &b);

const double oneDegree = EIGEN_PI / 180;

#endif
