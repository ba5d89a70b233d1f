// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_WEIGHT_SOURCES_H
#define FCD_WEIGHT_SOURCES_H

#include "parameters.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// The numbers of a per-vertex scalar attribute of \p layer, by slot; read as long as the layer is as it is.
/// \param use of the numbers, and the parameter that names them, for messages: "with a tag per vertex, or ..."
/// \throw vcg::fcd::Error there is none of that name, or it holds something else
std::function<double(std::size_t)> attributeNumbers(const MeshModel &layer, const QString &name,
                                                    const std::string &use);

/// How much each vertex of \p layer counts in a fit, by slot; empty: all counts. \throw vcg::fcd::Error
std::vector<float> readWeights(const MeshModel &layer, FitMeshParam::Weights source, const QString &attribute);
/// Those that were painted on \p layer, as paintWeights wrote them, each from 0 to 1; empty: none.
std::vector<float> paintedWeights(const MeshModel &layer);
/// They are its attribute FitMeshParam::paintedAttribute from now on. \param weights one per vertex slot; empty: the
/// layer has none
void paintWeights(MeshModel &layer, const std::vector<float> &weights);
/// The same as the method asks for them; empty where all counts. \param weights must outlive it
vcg::fcd::WeightOf weightOf(const std::vector<float> &weights);

#endif
