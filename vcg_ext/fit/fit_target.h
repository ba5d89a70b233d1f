// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_TARGET_H
#define VCG_FCD_FIT_TARGET_H

#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/fit/fit_curves.h>
#include <vcg_ext/fit/fit_samples.h>
#include <vcg_ext/fit/one_sided.h>
#include <vcg_ext/surface/nearest_place.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace vcg::fcd {

/// Middle and principal axes of what is spread in space.
class Moments {
  public:
    void Add(const Eigen::Vector3d &p, double weight) {
        sum += weight;
        first += weight * p;
        second += weight * p * p.transpose();
    }
    Eigen::Vector3d Middle() const { return first / sum; }
    Eigen::Matrix3d Axes() const; ///< columns, from the shortest to the longest; of length 1
    double Radius() const;        ///< root mean square distance from the middle

  private:
    double sum = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/// What a surface is fitted to: triangles, or points with or without normals. Any number of threads may ask.
class FitTarget {
  public:
    /// Where it is nearest to a point.
    struct Match {
        Eigen::Vector3d point;
        Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< of length 1; 0 where it is not known
        bool isOriented = false;                          ///< the normal points outwards, and not perhaps inwards
        bool onBorder = false;                            ///< of triangles: the surface ends there
        double weight = 1;                                ///< how much it counts, [0, 1]
    };

    /// \param target triangles, or points where it has none; in mesh units of its own, as \p toWorld says
    /// \param normal of points, any length; may be empty, or 0 for some
    /// \param toFrame from mesh units of the target to the frame that all is computed in
    /// \param isRead called as soon as nothing of \p target is needed any more; may be empty
    /// \param weight of each vertex, [0, 1]; may be empty: 1. Points and triangles of which it is 0 all over are left
    /// out \param name what messages call it. What is not finite is left out, with the triangles at it. \throw BadInput
    /// nothing is left \throw Cancelled
    FitTarget(const SurfaceView &target, const std::function<Eigen::Vector3d(std::size_t)> &normal,
              const Eigen::Affine3d &toFrame, const Progress &progress = {}, const std::function<void()> &isRead = {},
              const WeightOf &weight = {}, const std::string &name = "target");

    /// \param hint of a point that is near, or the same one earlier; changes no bit
    Match Nearest(const Eigen::Vector3d &p, NearestPlace::Hint &hint) const;
    Match Nearest(const Eigen::Vector3d &p) const {
        NearestPlace::Hint none;
        return Nearest(p, none);
    }
    const Moments &Spread() const { return moments; } ///< of the triangles' area, or of the points
    /// Its box, frame units.
    const Eigen::AlignedBox3d &Box() const { return box; }
    /// How far it spreads across its line and across its plane, of how far along, [0, 1]; 0, 0 for a point.
    struct Shape {
        double acrossLine = 0, acrossPlane = 0;
    };
    Shape Spans() const;
    std::vector<Curve> curves;                      ///< that vertices of the source slide along, frame units
    std::size_t LeftOut() const { return leftOut; } ///< vertices with a coordinate that is not finite

    /// Some places of it, about so many, that stand for the same area each; or some of its points, evenly among all.
    std::vector<Match> Places(std::size_t wanted) const;

  private:
    std::vector<Corners> ReadTriangles(const SurfaceView &target, const Eigen::Affine3d &toFrame,
                                       const WeightOf &weightOf, const Progress &progress);
    void LookAround(const Progress &progress);
    void ReadPoints(const SurfaceView &target, const std::function<Eigen::Vector3d(std::size_t)> &normal,
                    const Eigen::Affine3d &toFrame, const WeightOf &weightOf);

    bool IsBorder(Index i) const { return flags[std::size_t(i)] == border; }

    // What is kept of each node is most of what a fit takes, so normals are of single precision.
    enum Flag : char { inside = 1, border = 2 };
    Eigen::Matrix3Xd position; // of nodes, in an order along a curve that fills space, or points
    Eigen::Matrix3Xf normal;   // of each, of length 1 or 0; 0 columns where there are none
    std::vector<float> weight; // of each; empty: 1
    std::vector<char> flags;   // of each: 0 where there is none; border only of nodes of triangles
    bool isCloud = false;
    const std::string name;
    std::size_t leftOut = 0;
    Eigen::AlignedBox3d box;
    std::unique_ptr<NearestPlace> place;
    Moments moments;
};

} // namespace vcg::fcd

#endif
