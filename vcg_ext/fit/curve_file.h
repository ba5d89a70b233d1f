// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CURVE_FILE_H
#define VCG_FCD_CURVE_FILE_H

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

namespace vcg::fcd {

/// A curve of two surfaces, as a file has it: a polyline on each, closed where its last corner is its first.
struct CurvePair {
    std::string name;                            ///< UTF-8, not empty
    std::vector<Eigen::Vector3d> source, target; ///< corners in order, finite, two different ones at least; world
    std::vector<std::size_t> sourceLine;         ///< from 1: where the file has each corner of the source; or empty
    std::string file;                            ///< what messages call it
};

/// Reads a table of curves, a row for each corner, in order along its polyline; rows of several may alternate. Its
/// cells have commas, semicolons or tabs between (that which follows the first word) and may be quoted, and lines that
/// begin with # are comments:
///
///     curve, surface, x, y, z
///     NAME, source, 1.5, 2, 3     a corner on the surface that is fitted
///     NAME, target, 1.6, 2, 3.2   and one where that belongs: as many or others
///
/// \param name what messages call the text \return in the order of their first rows
/// \throw BadInput what is wrong, with the line: a cell that is not of this kind, a curve without two different corners
/// on each surface, no curve, or more than a hundred thousand corners
std::vector<CurvePair> ReadCurveText(const std::string &text, const std::string &name);

/// ReadCurveText of a file. \throw BadInput also when it is not readable, or larger than that needs
std::vector<CurvePair> ReadCurveFile(const std::string &path);

} // namespace vcg::fcd

#endif
