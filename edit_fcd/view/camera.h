// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_CAMERA_H
#define FCD_CAMERA_H

#include <Eigen/Geometry>

/// How the world is seen: from world to window coordinates (pixels of the device, y up; depth 0 to 1) and back.
struct Camera {
    Eigen::Matrix4d toClip = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d fromClip = Eigen::Matrix4d::Identity();
    int width = 1, height = 1;

    Eigen::Vector3d toWindow(const Eigen::Vector3d &world) const; ///< behind the eye: a depth above 1
    Eigen::Vector3d toWorld(const Eigen::Vector3d &window) const;
    /// A world direction at \p at that leads to the eye, of length 1.
    Eigen::Vector3d towardsEye(const Eigen::Vector3d &at) const;
    /// How many world units a pixel is at \p at.
    double pixelAt(const Eigen::Vector3d &at) const;
};

/// How far \p p is from the way from \p a to \p b.
double distanceToSegment(const Eigen::Vector2d &p, const Eigen::Vector2d &a, const Eigen::Vector2d &b);

const double oneDegree = EIGEN_PI / 180;

#endif
