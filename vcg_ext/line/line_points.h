// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_LINE_POINTS_H
#define VCG_FCD_LINE_POINTS_H

#include <vcg_ext/base/graph.h>

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

/// \file
/// Where the points of a line come from.

namespace vcg::fcd {

/// The vertices of the one path that edges form, in its order; it begins at the end with the smaller number.
/// \param edge pairs of vertices; an edge may be there twice, or the other way round \param name what messages call it
/// \throw BadInput no edges, a branch, a ring, or several paths
std::vector<Index> PathOfEdges(std::vector<std::array<Index, 2>> edge, const std::string &name);

/// Reads a list of points: a line for each with x, y and z. Between the numbers a comma, a semicolon or white space;
/// comments from '#' to the end of the line, and a first line that does not begin like a number names the columns.
/// \param name what messages call the text \return 3 x n
/// \throw BadInput a line that is not of this kind, or none at all, with name and line
Eigen::Matrix3Xd ReadLineText(const std::string &text, const std::string &name);

} // namespace vcg::fcd

#endif
