// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_PAIRS_H
#define FCD_FIT_PAIRS_H

#include <layer_fcd/layer_state.h> // before Qt
#include <layer_fcd/parameters.h>

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

#endif
