// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HANDLE_FILE_H
#define VCG_FCD_HANDLE_FILE_H

#include <vcg_ext/handles/handles.h>

#include <cstdint>
#include <string>
#include <vector>

namespace vcg::fcd {

/// The bytes of a file. \param most bytes \throw BadInput it cannot be read, or is larger; names the file
std::string ReadFile(const std::string &path, std::size_t most = std::string::npos);

/// Reads the text of a `.sel` file: a tag per vertex, in the order of the vertices (0 fixed, 1 free, >= 2 handle,
/// negative = outside), separated by white space; comments from '#' to the end of the line. \param name of the text,
/// for messages \throw BadInput a word that is no whole number, or no tag at all; names text and line
std::vector<int> ReadTagText(const std::string &text, const std::string &name);

/// ReadTagText of a file. \param most bytes \throw BadInput as ReadTagText and ReadFile
std::vector<int> ReadTagFile(const std::string &path, std::size_t most = std::string::npos);

/// Reads the text of a `.def` file: 4 x 4 matrices that multiply column vectors, row by row, for the tags 2, 3, ... in
/// order; comments from '#' to the end of the line. \param name of the text, for messages
/// \throw BadInput a word that is no finite number, or an incomplete matrix; names text and line
std::vector<Eigen::Matrix4d> ReadTransformText(const std::string &text, const std::string &name);

/// ReadTransformText of a file. \param most bytes \throw BadInput as ReadTransformText and ReadFile
std::vector<Eigen::Matrix4d> ReadTransformFile(const std::string &path, std::size_t most = std::string::npos);

/// A point handle, as files and texts give it: a vertex or a start, and a target.
struct PointPair {
    std::int64_t vertex = -1; ///< index of the vertex, from 0; -1: start is given instead
    Eigen::Vector3d start = Eigen::Vector3d::Zero(), target = Eigen::Vector3d::Zero();
};

/// Reads a list of point handles. Each has a line with a vertex index (from 0) or the x, y and z of the start, then the
/// x, y and z of the target, separated by a comma, a semicolon or white space. Comments go from '#' to the end of the
/// line; a first line that does not begin like a number is skipped. \param name of the text, for messages
/// \throw BadInput another line, or no point at all; names text and line
std::vector<PointPair> ReadPointHandleText(const std::string &text, const std::string &name);

/// ReadPointHandleText of a file. \param most bytes \throw BadInput as ReadPointHandleText and ReadFile
std::vector<PointPair> ReadPointHandleFile(const std::string &path, std::size_t most = std::string::npos);

/// The text that ReadTagText reads.
std::string TagText(const std::vector<int> &tag);

/// The text that ReadTransformText reads, to the bit.
std::string TransformText(const std::vector<Eigen::Matrix4d> &matrix);

} // namespace vcg::fcd

#endif
