// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_COLORS_H
#define FCD_COLORS_H

#include <layer_fcd/meshlab_host.h>

#include <vector>

/// The colour of a stretch by 2^exponent: blue for -1 or less, grey for 0, red for 1 (twice as long) or more.
vcg::Color4b colorOfStretch(double exponent);

/// One colour per vertex slot, by the mean TriangleStretch::Exponent() of its faces, weighed by their area at rest.
/// \param rest positions at rest, per vertex slot \param world linear part of the layer's matrix: stretch is that in
/// the world \param opacity [0, 255]
std::vector<vcg::Color4b> colorsOfStretch(const CMeshO &mesh, const std::vector<Point3m> &rest,
                                          const Eigen::Matrix3d &world, unsigned char opacity);

/// The colour of a distance, from blue by green and yellow to red. \param part of the largest distance shown
vcg::Color4b colorOfDistance(double part);
/// The colour of vertices without a counterpart.
vcg::Color4b colorOfNoCounterpart();

#endif
