// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_LANDMARKS_H
#define VCG_FCD_FIT_LANDMARKS_H

#include <vcg_ext/fit/fit_samples.h>
#include <vcg_ext/fit/fit_system.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// The point nearest to \p x within \p tolerance of \p place.
Eigen::Vector3d Within(double tolerance, const Eigen::Vector3d &place, const Eigen::Vector3d &x);

/// The pull on a landmark at \p x to its target \p place, frame units. Its energy is \p weight times half the square of
/// the distance from the ball around the target whose radius is the tolerance. A little of the squared distance from
/// the target itself is added: it keeps the landmark from sliding about in the ball, and centres many landmarks that
/// are off by chance.
FitSystem::Pull LandmarkPull(double tolerance, const Eigen::Vector3d &place, const Eigen::Vector3d &x, double weight);

/// Moves the free nodes of a graph by as little as possible (least squares), so that some samples meet their targets.
/// \param first number of the first of these samples; the others follow it
/// \param place their targets, frame units \param isFree flags of the graph's nodes
/// \return the largest move of a node, frame units \throw Cancelled
double MoveOnto(const FitSamples &samples, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                const std::vector<char> &isFree, GraphPose &pose, const Progress &progress = {});

/// The same if the nodes cannot take all samples to their targets, or only by far longer moves, as with more samples
/// than nodes: samples come as near as moves of about their distances can take them.
double MoveTowards(const FitSamples &samples, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                   const std::vector<char> &isFree, GraphPose &pose);

} // namespace vcg::fcd

#endif
