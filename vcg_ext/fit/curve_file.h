// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CURVE_FILE_H
#define VCG_FCD_CURVE_FILE_H

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace vcg::fcd {

/// A curve of two surfaces: a polyline on each, closed if its last corner is its first.
struct CurvePair {
    std::string name;                            ///< UTF-8, not empty
    std::vector<Eigen::Vector3d> source, target; ///< corners in order, world units, finite, at least two different ones
    std::vector<std::size_t> sourceLine; ///< of each corner of the source: its line in the file, from 1; or empty
    std::string file;                    ///< name of the file, for messages
};

/// Reads a table of curves: a row for each corner, in order along its polyline. Rows of several curves may alternate,
/// and the two polylines of a curve may have different numbers of corners. Cells are separated by commas, semicolons or
/// tabs (the one after the first word), and may be quoted. Lines that begin with # are comments.
///
///     curve, surface, x, y, z
///     NAME, source, 1.5, 2, 3     a corner on the surface that is fitted
///     NAME, target, 1.6, 2, 3.2   a corner on the target
///
/// \param name of the text, for messages \return the curves, in the order of their first rows
/// \throw BadInput with the line: another kind of row, a curve without two different corners on each surface, no curve,
/// or more than a hundred thousand corners
std::vector<CurvePair> ReadCurveText(const std::string &text, const std::string &name);

/// ReadCurveText of a file. \throw BadInput as ReadCurveText and ReadFile
std::vector<CurvePair> ReadCurveFile(const std::string &path);

} // namespace vcg::fcd

#endif
