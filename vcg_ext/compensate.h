// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_COMPENSATE_H
#define VCG_FCD_COMPENSATE_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/deformer.h>
#include <vcg_ext/surface/surface_arrays.h>
#include <vcg_ext/warp/smooth_warp.h>

#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <vector>

/// \file
/// Compensates the warp of a printed, sintered or pressed part: finds the warp from a scan, and the shape to make so
/// that the nominal part comes out.

namespace vcg::fcd {

/// How a part is compensated.
struct CompensateParam {
    int degree = 5;      ///< of the warp, 1 to 7
    int samples = 12000; ///< points of the nominal surface that are matched, 100 to a million
    double largestDistance = std::numeric_limits<double>::infinity(); ///< of matches, units of the vertices, > 0
};

/// How far the part was warped, and how it was changed. Lengths are in units of the vertices.
struct CompensateReport {
    double before = 0, left = 0; ///< rms distance of the scan from the nominal surface laid onto it, where it is
                                 ///< scanned: rigidly, and after the warp
    double doubt = 0;   ///< standard deviation of the warp where the part is not scanned, rms over all of it; 0 if less
                        ///< than where it is
    double scanned = 0; ///< share of the nominal surface that is matched, [0, 1]
    double larger = 1;  ///< the scan's size over that of the nominal part
    double change = 0, changeMost = 0; ///< displacement of the vertices: rms, and the largest
    double missed = 0;                 ///< largest distance of the predicted print from the nominal vertices
    double rounding = 0;               ///< distances below this are rounding, not warp
    double spacing = 0;                ///< of a cloud's points, if they cover the part; 0: triangles
    double thickness = 0;              ///< of the part, mean; infinity if normals tell its sides
    Eigen::Affine3d placed = Eigen::Affine3d::Identity(); ///< the rigid motion from the nominal part to the scan

    /// Warnings for users, a sentence each.
    std::vector<std::string> Warnings() const;
};

/// The map from a nominal part to the shape to make.
class Compensation {
  public:
    Compensation() = default; ///< the identity
    /// Finds the warp. \pre the scan lies about where the nominal part does
    /// \param nominal triangles \param scan triangles or points \param scanNormal of points; may be empty
    /// \throw BadInput a nominal surface without area, a scan of few points or on one line, nothing matched, a
    /// parameter out of range \throw Cancelled
    Compensation(const SurfaceView &nominal, const SurfaceView &scan, const NormalOf &scanNormal,
                 const CompensateParam &param, const Progress &progress = {});

    /// Where to make the point \p p of the nominal part.
    Eigen::Vector3d operator()(const Eigen::Vector3d &p) const;
    /// The derivative of operator() where its value is \p made.
    Eigen::Matrix3d LinearAt(const Eigen::Vector3d &made) const;
    /// Where a made point \p p comes to lie in the print, aligned with the nominal part.
    Eigen::Vector3d Predicted(const Eigen::Vector3d &p) const;

    CompensateReport report;   ///< of all vertices
    Eigen::Matrix3Xd position; ///< the shape to make, 3 x vertex slots of the nominal part

    /// Calls take(fields ...) with all fields except position, to save and load them.
    template <class Take>
    void Fields(const Take &take) {
        take(report.before, report.left, report.scanned, report.change, report.changeMost, report.missed,
             report.rounding, report.spacing, report.thickness, report.placed, middle, scale, placed);
        warp.Fields(take);
    }

  private:
    void MakeVertices(const SurfaceView &nominal, const Eigen::AlignedBox3d &box, const Progress &progress);

    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    double scale = 1;
    SmoothWarp warp;                                      // in units of scale, about middle
    Eigen::Affine3d placed = Eigen::Affine3d::Identity(); // the rigid part of the warp
};

} // namespace vcg::fcd

#endif
