// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_WEIGHT_SOURCES_H
#define FCD_WEIGHT_SOURCES_H

#include "parameters.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// The numbers of a per-vertex scalar attribute of \p layer, by slot; valid until the layer changes.
/// \param use of the numbers, and the parameter that names them, for messages: "with a tag per vertex, or ..."
/// \throw vcg::fcd::Error there is none of that name, or it is no scalar
std::function<double(std::size_t)> attributeNumbers(const MeshModel &layer, const QString &name,
                                                    const std::string &use);

/// The weights of \p layer's vertices in a fit, by slot; empty: all are 1. \throw vcg::fcd::Error they cannot be read
std::vector<float> readWeights(const MeshModel &layer, FitMeshParam::Weights source, const QString &attribute);
/// The weights painted on \p layer (paintWeights), one per vertex slot, each from 0 to 1; empty: none.
std::vector<float> paintedWeights(const MeshModel &layer);
/// Sets the attribute FitMeshParam::paintedAttribute. \param weights one per vertex slot; empty: removes it
void paintWeights(MeshModel &layer, const std::vector<float> &weights);
/// The weights as a function for Fitter; empty if \p weights is. \param weights must outlive it
vcg::fcd::WeightOf weightOf(const std::vector<float> &weights);

#endif
