// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_COMMON_MOTION_H
#define VCG_FCD_COMMON_MOTION_H

#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/graph/deformation_graph.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cstddef>
#include <vector>

namespace vcg::fcd::detail {

/// How the constrained nodes of a graph move together.
class CommonMotion {
  public:
    /// \param constrained flags of the nodes: at least one \param motion of these
    template <class Flags>
    CommonMotion(const DeformationGraph &graph, const Flags &constrained, const std::vector<Eigen::Affine3d> &motion) {
        double count = 0;
        const auto forConstrained = [&](const auto &body) {
            for (Index i = 0; i < graph.Size(); ++i)
                if (constrained[i]) {
                    const Eigen::Vector3d x = graph.graph.position.col(i).cast<double>();
                    body(x, Eigen::Vector3d(motion[i] * x));
                }
        };
        forConstrained([&](const Eigen::Vector3d &x, const Eigen::Vector3d &y) {
            before += x;
            after += y;
            ++count;
        });
        before /= count;
        after /= count;
        forConstrained([&](const Eigen::Vector3d &x, const Eigen::Vector3d &y) {
            rest += (x - before) * (x - before).transpose();
            posed += (y - after) * (x - before).transpose();
        });
    }

    /// The rotation that fits their motions best. Where few points leave it open, no rotation is preferred.
    Eigen::Matrix3d Rotation() const {
        const Eigen::Matrix3d s = posed.transpose();
        return FitRotation(s + 1e-3 * s.norm() * Eigen::Matrix3d::Identity());
    }

    /// The affine motion that fits their motions best. In directions that their positions leave open, it is the
    /// rotation.
    Eigen::Affine3d Affine() const {
        const Eigen::Matrix3d rotation = Rotation();
        const double open = 1e-9 * rest.trace(); // flatter sets of points are flat for floats
        Eigen::Affine3d common = Eigen::Affine3d::Identity();
        const Eigen::Matrix3d fitted =
            (posed - rotation * rest) * (rest + open * Eigen::Matrix3d::Identity()).inverse();
        common.linear() = rotation;
        if (fitted.allFinite())
            common.linear() += fitted;
        common.translation() = after - common.linear() * before;
        return common;
    }

  private:
    Eigen::Vector3d before = Eigen::Vector3d::Zero(), after = before; // means of their positions
    Eigen::Matrix3d rest = Eigen::Matrix3d::Zero(), posed = rest;     // sums of products about these
};

} // namespace vcg::fcd::detail

#endif
