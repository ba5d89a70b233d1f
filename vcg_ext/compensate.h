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
/// What to make so that the nominal part comes out: turns round the warp of a printed, sintered or pressed part, which
/// its scan tells.

namespace vcg::fcd {

/// How a part is compensated.
struct CompensateParam {
    int degree = 5;      ///< of the warp, 1 to 7
    int samples = 12000; ///< places of the nominal surface that are matched, 100 to a million
    double largestDistance = std::numeric_limits<double>::infinity(); ///< of matches, > 0
};

/// How far the part was warped, and what is made of it. Lengths are in units of the vertices.
struct CompensateReport {
    double before = 0, left = 0; ///< distance of the scan from the nominal surface laid onto it, root mean square where
                                 ///< that is scanned: as it is, and after the warp
    double scanned = 0;          ///< share of the nominal surface that is matched, [0, 1]
    double change = 0, changeMost = 0; ///< of the vertices: root mean square, most
    double missed = 0;                 ///< largest distance of the predicted print from the nominal vertices
    double rounding = 0;               ///< distances below this are rounding, not warp
    double spacing = 0;                ///< of a cloud's points, if they are all over the part; 0: triangles
    double thickness = 0;              ///< of the part, mean; infinity where normals tell its sides
    Eigen::Affine3d placed = Eigen::Affine3d::Identity(); ///< the rigid motion from the nominal part to the scan

    /// A sentence for each thing that is not to be trusted.
    std::vector<std::string> Warnings() const;
};

/// The way from a nominal part to what to make.
class Compensation {
  public:
    Compensation() = default; ///< moves nothing
    /// Finds the warp. \pre the scan lies on the nominal part, up to the warp and what matching finds
    /// \param nominal triangles \param scan triangles or points \param scanNormal of points; may be empty
    /// \throw BadInput a nominal surface without area, a scan without vertices, nothing matched, a parameter out of
    /// range \throw Cancelled
    Compensation(const SurfaceView &nominal, const SurfaceView &scan, const NormalOf &scanNormal,
                 const CompensateParam &param, const Progress &progress = {});

    /// Where to make a place of the nominal part.
    Eigen::Vector3d operator()(const Eigen::Vector3d &p) const;
    /// The derivative of that. \param made its value
    Eigen::Matrix3d LinearAt(const Eigen::Vector3d &made) const;
    /// Where a place that is made comes to lie in the print, aligned with the nominal part.
    Eigen::Vector3d Predicted(const Eigen::Vector3d &p) const;

    CompensateReport report;   ///< of all vertices
    Eigen::Matrix3Xd position; ///< what to make, a column for each vertex slot of the nominal part

    /// All that it is, but position. \param take gets the fields
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
    SmoothWarp warp;                                      // of the frame
    Eigen::Affine3d placed = Eigen::Affine3d::Identity(); // the rigid part of it
};

} // namespace vcg::fcd

#endif
