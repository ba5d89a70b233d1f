// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HANDLE_FILE_H
#define VCG_FCD_HANDLE_FILE_H

#include <vcg_ext/handles/handles.h>

#include <cstdint>
#include <string>
#include <vector>

namespace vcg::fcd {

/// The bytes of a file. \param most how many there may be; of a larger file no more are read \throw BadInput naming it
std::string ReadFile(const std::string &path, std::size_t most = std::string::npos);

/// Reads the text of a `.sel` file: one tag per vertex in vertex order (0 fixed, 1 free, >= 2 handle, negative =
/// outside), whitespace or line breaks between them, comments from '#' to the end of the line. \param name what
/// messages call the text \throw BadInput not a whole number, or none at all, with name and line
std::vector<int> ReadTagText(const std::string &text, const std::string &name);

/// ReadTagText of a file. \param most bytes \throw BadInput also when it is not readable, or larger
std::vector<int> ReadTagFile(const std::string &path, std::size_t most = std::string::npos);

/// Reads the text of a `.def` file: 4 x 4 matrices, row by row, column vectors to their right; the first belongs to
/// tag 2, the second to tag 3 and so on. Comments from '#' to the end of the line. \param name what messages call the
/// text \throw BadInput not a finite number, or an incomplete matrix, with name and line
std::vector<Eigen::Matrix4d> ReadTransformText(const std::string &text, const std::string &name);

/// ReadTransformText of a file. \param most bytes \throw BadInput also when it is not readable, or larger
std::vector<Eigen::Matrix4d> ReadTransformFile(const std::string &path, std::size_t most = std::string::npos);

/// A point that goes somewhere.
struct PointPair {
    std::int64_t vertex = -1; ///< number of the vertex, from 0; -1 where start is given instead
    Eigen::Vector3d start = Eigen::Vector3d::Zero(), target = Eigen::Vector3d::Zero();
};

/// Reads a list of correspondences: a line for each point with the number of a vertex (from 0) or the x, y and z of the
/// start, and the x, y and z of the target. Between the numbers a comma, a semicolon or white space; comments from '#'
/// to the end of the line, and a first line that does not begin like a number names the columns. \param name what
/// messages call the text \throw BadInput a line that is not of this kind, or none at all, with name and line
std::vector<PointPair> ReadPointHandleText(const std::string &text, const std::string &name);

/// ReadPointHandleText of a file. \param most bytes \throw BadInput also when it is not readable, or larger
std::vector<PointPair> ReadPointHandleFile(const std::string &path, std::size_t most = std::string::npos);

/// What ReadTagText reads.
std::string TagText(const std::vector<int> &tag);

/// What ReadTransformText reads, to the bit.
std::string TransformText(const std::vector<Eigen::Matrix4d> &matrix);

} // namespace vcg::fcd

#endif
