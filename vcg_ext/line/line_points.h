// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_POINTS_H
#define VCG_FCD_LINE_POINTS_H

#include <vcg_ext/base/graph.h>

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

/// \file
/// Reads the points of a line.

namespace vcg::fcd {

/// The vertices of the path that edges form, in order, from the end with the smaller number.
/// \param edge pairs of vertices; may be repeated or reversed \param name of the line, for messages \throw BadInput no
/// edges, a branch, a ring, or several paths
std::vector<Index> PathOfEdges(std::vector<std::array<Index, 2>> edge, const std::string &name);

/// Reads a list of points, a line with x, y and z for each. Numbers are separated by a comma, a semicolon or white
/// space. Comments go from '#' to the end of the line. A first line that does not begin with a number is skipped: it
/// names the columns. \param name of the text, for messages \return 3 x n \throw BadInput another line, or no points,
/// with name and line
Eigen::Matrix3Xd ReadLineText(const std::string &text, const std::string &name);

} // namespace vcg::fcd

#endif
