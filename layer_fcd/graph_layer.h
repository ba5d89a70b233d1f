// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_GRAPH_LAYER_H
#define FCD_GRAPH_LAYER_H

#include "parameters.h"

#include <Eigen/Core>

/// The vertices of \p graph in the coordinates of \p layer, 3 x k.
/// \throw vcg::fcd::Error \p graph is null, is \p layer itself or has no vertex
Eigen::Matrix3Xd readNodes(const MeshModel &layer, const MeshModel *graph);

/// FCD: Build Deformation Graph: adds layers with the graph of \p layer, first its nodes, then those of \p param.
/// \throw vcg::fcd::Error \throw vcg::fcd::Cancelled; the document is then as it was
vcg::fcd::CentroidalGraph addGraphLayers(MeshDocument &document, MeshModel &layer, const BuildGraphParam &param,
                                         const Remark &remark, const vcg::fcd::Progress &progress);

#endif
