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
#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace vcg::fcd {

/// Where the normals of two surfaces point to opposite sides, their distance counts so many times.
constexpr double wrongSide = 3;

/// Middle and principal axes of weighted points.
class Moments {
  public:
    void Add(const Eigen::Vector3d &p, double weight) {
        sum += weight;
        first += weight * p;
        second += weight * p * p.transpose();
    }
    Eigen::Vector3d Middle() const { return first / sum; }
    Eigen::Matrix3d Axes() const;    ///< unit columns, from the shortest to the longest extent
    Eigen::Vector3d Longest() const; ///< the axis of the longest extent, as long as the standard deviation along it
    double Radius() const;           ///< root mean square distance from the middle

  private:
    Eigen::Matrix3d Covariance() const;

    double sum = 0;
    Eigen::Vector3d first = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
};

/// The target of a fit: triangles, or points with or without normals. Const functions are safe for any number of
/// threads.
class FitTarget {
  public:
    /// The point of the target nearest to a given one, frame units.
    struct Match {
        Eigen::Vector3d point;
        Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< of length 1; 0: unknown
        bool isOriented = false;                          ///< false: the normal may point inwards
        bool onBorder = false;                            ///< the surface ends there, before the given point
        double weight = 1;                                ///< how much it counts, [0, 1]
        double reach = 0; ///< of a cloud that ends: the distance from the point to the farthest of those that it is the
                          ///< mean of

        /// The point of the surface nearest to \p p, for which this was found. Between the points of a cloud, this is
        /// on the plane through them: their mean is up to half a spacing off.
        Eigen::Vector3d Foot(const Eigen::Vector3d &p) const {
            const Eigen::Vector3d offset = p - point, beside = offset - normal.dot(offset) * normal;
            return normal.isZero(0) ? point
                                    : Eigen::Vector3d(point + beside * std::min(1., reach / (beside.norm() + 1e-300)));
        }
    };

    /// Reads the target. Vertices that are not finite are left out, with their triangles; so are points, and triangles
    /// with three corners, of weight 0.
    /// \param target triangles; points if it is a cloud \param normal of points, any length; may be empty, or 0 for
    /// some \param toFrame from mesh units of the target to the frame of the source \param isRead called as soon as \p
    /// target is no longer needed; may be empty \param weight of each vertex, [0, 1]; empty: 1 \param name of the
    /// target, for messages \throw BadInput nothing is left, or a weight is out of range \throw Cancelled
    FitTarget(const SurfaceView &target, const std::function<Eigen::Vector3d(std::size_t)> &normal,
              const Eigen::Affine3d &toFrame, const Progress &progress = {}, const std::function<void()> &isRead = {},
              const WeightOf &weight = {}, const std::string &name = "target");

    /// \param p frame units \param hint of a point nearby, for speed \param asksEnd false: whether a cloud ends there
    /// (Match::onBorder) is not asked, for speed
    Match Nearest(const Eigen::Vector3d &p, NearestPlace::Hint &hint, bool asksEnd = true) const;
    Match Nearest(const Eigen::Vector3d &p) const {
        NearestPlace::Hint none;
        return Nearest(p, none);
    }
    bool IsCloud() const { return isCloud; }
    const Moments &Spread() const { return moments; } ///< of the triangles' area, or of the points
    /// Its box, frame units.
    const Eigen::AlignedBox3d &Box() const { return box; }
    /// Rms extents across its main direction, and across its plane, over that along the main direction, [0, 1]; 0 for a
    /// point.
    struct Shape {
        static constexpr double none = 1e-6; ///< smaller extents are rounding
        double acrossLine = 0, acrossPlane = 0;
        bool IsLine() const { return !(acrossLine > none); } ///< or a point
    };
    Shape Spans() const;
    std::vector<Curve> curves;                      ///< as in FitGoal, but frame units
    bool reachesFarther = false;                    ///< as in FitGoal
    std::size_t LeftOut() const { return leftOut; } ///< vertices with a coordinate that is not finite

    /// About \p wanted points of the target: of triangles, points that stand for the same area each.
    std::vector<Match> Places(std::size_t wanted) const;

  private:
    std::vector<Corners> ReadTriangles(const SurfaceView &target, const Eigen::Affine3d &toFrame,
                                       const WeightOf &weightOf, const Progress &progress);
    void LookAround(const Progress &progress);
    void ReadPoints(const SurfaceView &target, const std::function<Eigen::Vector3d(std::size_t)> &normal,
                    const Eigen::Affine3d &toFrame, const WeightOf &weightOf);

    bool IsBorder(Index i) const { return flags[i] == border; }

    // These arrays are most of a fit's memory, so normals are floats.
    enum Flag : char { inside = 1, border = 2 };
    Eigen::Matrix3Xd position; // of nodes of triangles (in Morton order), or points; frame units
    Eigen::Matrix3Xf normal;   // of each, length 1 or 0; no columns: unknown
    std::vector<float> weight; // of each; empty: 1
    std::vector<char> flags;   // Flag of each; 0: not part of the target
    bool isCloud = false;
    const std::string name;
    std::size_t leftOut = 0;
    Eigen::AlignedBox3d box;
    std::unique_ptr<NearestPlace> place;
    Moments moments;
};

} // namespace vcg::fcd

#endif
