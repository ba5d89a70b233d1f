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

/// Pairs as 'landmarks_file' reads them: a .csv, or a .pp with both ends of each; or two .pp files with the same names,
/// of which the one whose points are nearer to the layer is that of the layer.
/// \param rest of each vertex slot \param files one or two \throw vcg::fcd::Error each message says what to do
std::vector<FitPair> loadPairs(const MeshModel &layer, const Point3m *rest, const QStringList &files);

/// Writes what loadPairs reads, a .pp file or else a list. \param rest of each vertex slot
/// \throw vcg::fcd::Error as expectSavable; or the file cannot be written
void savePairs(const MeshModel &layer, const Point3m *rest, const std::vector<FitPair> &pairs, const QString &file);

/// \throw vcg::fcd::Error no pair, or one that lacks one of its ends
void expectSavable(const std::vector<FitPair> &pairs);
/// \throw vcg::fcd::Error naming a pair that lacks one of its ends
void expectWhole(const std::vector<FitPair> &pairs);

/// A pair whose place on the target is not known yet; its name is the first number that none has. \throw as setSource
void addPair(std::vector<FitPair> &pairs, std::size_t slot);
/// \throw vcg::fcd::Error another pair is at that vertex
void setSource(std::vector<FitPair> &pairs, std::size_t pair, std::size_t slot);

/// Curves of a file that lead a fit, and where those of the layer go with it.
struct FitLines {
    std::string file;
    std::vector<vcg::fcd::CurvePair> curves;
    std::vector<std::vector<std::size_t>> nearest; ///< of each, of each corner of the source: slot of a vertex
};

/// \param rest of each vertex slot, at least one of which is live \throw vcg::fcd::Error as ReadCurveFile
std::shared_ptr<const FitLines> loadLines(const MeshModel &layer, const Point3m *rest, const std::string &file);

#endif
