// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_QUALITY_REFERENCE_H
#define FCD_QUALITY_REFERENCE_H

#include "quality_cases.h"

#include <filesystem>

namespace benchmark {

/// What CGAL's SR-ARAP makes of a problem.
struct Reference {
    Eigen::Matrix3Xd position; ///< a column per vertex
    int iterations = 0;
    double moved = 0;     ///< what moved most in the last iteration, fraction of the diagonal
    double remaining = 0; ///< about what the iterations to come would still move, fraction of the diagonal
    double seconds = 0;
};

/// Computes the reference, or takes it from \p cache when it was computed before; with alpha times the area of the
/// region that deforms, whatever is held around it. \throw vcg::fcd::Error
Reference MakeReference(const Problem &problem, const std::filesystem::path &cache);

} // namespace benchmark

#endif
