// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_PAIRS_H
#define FCD_FIT_PAIRS_H

#include <vcg_ext/fit/curve_file.h> // before Qt

#include <layer_fcd/layer_state.h>
#include <layer_fcd/parameters.h>

#include <memory>
#include <string>
#include <vector>

#include <QStringList>

/// Reads pairs as 'landmarks_file' does: from a .csv, a .pp with both ends of each pair, or two .pp files with the same
/// names. Of two, the file whose points are nearer to the layer is the layer's. \param rest positions of vertex slots
/// \param files one or two \throw vcg::fcd::Error they cannot be read as pairs
std::vector<FitPair> loadPairs(const MeshModel &layer, const Point3m *rest, const QStringList &files);

/// Writes a file for loadPairs: a .pp file, or else a list. \param rest positions of vertex slots
/// \throw vcg::fcd::Error as expectSavable; or the file cannot be written
void savePairs(const MeshModel &layer, const Point3m *rest, const std::vector<FitPair> &pairs, const QString &file);

/// \throw vcg::fcd::Error there is no pair, or one lacks an end
void expectSavable(const std::vector<FitPair> &pairs);
/// \throw vcg::fcd::Error a pair lacks an end, with its name
void expectWhole(const std::vector<FitPair> &pairs);

/// Adds a pair without a place on the target. Its name is the first unused number. \throw vcg::fcd::Error as setSource
void addPair(std::vector<FitPair> &pairs, std::size_t slot);
/// Moves a pair's end on the layer. \throw vcg::fcd::Error another pair has that vertex
void setSource(std::vector<FitPair> &pairs, std::size_t pair, std::size_t slot);

/// The curves of a file for a fit, and the vertices with which those on the layer move.
struct FitLines {
    std::string file;
    std::vector<vcg::fcd::CurvePair> curves;
    std::vector<std::vector<std::size_t>> nearest; ///< slot of the vertex nearest to each source corner of each curve
};

/// \param rest positions of vertex slots, at least one of them live \throw vcg::fcd::Error as ReadCurveFile
std::shared_ptr<const FitLines> loadLines(const MeshModel &layer, const Point3m *rest, const std::string &file);

#endif
