// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_FIT_LINES_H
#define FCD_FIT_LINES_H

#include <vcg_ext/fit/curve_file.h> // before Qt

#include <layer_fcd/parameters.h>

#include <memory>
#include <string>
#include <vector>

#include <QString>

/// Curves of a file that lead a fit, and where those of the layer go with it.
struct FitLines {
    std::string file;
    std::vector<vcg::fcd::CurvePair> curves;
    std::vector<std::vector<std::size_t>> nearest; ///< of each, of each corner of the source: slot of a vertex
};

/// \param rest of each vertex slot, at least one of which is live \throw vcg::fcd::Error as ReadCurveFile
std::shared_ptr<const FitLines> loadLines(const MeshModel &layer, const Point3m *rest, const std::string &file);

#endif
