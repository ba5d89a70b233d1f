// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_LANDMARKS_H
#define VCG_FCD_FIT_LANDMARKS_H

#include <vcg_ext/fit/fit_samples.h>
#include <vcg_ext/fit/fit_system.h>

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace vcg::fcd {

/// The place nearest to \p x that is no farther from \p place than that.
Eigen::Vector3d Within(double tolerance, const Eigen::Vector3d &place, const Eigen::Vector3d &x);

/// What draws a landmark at \p x to its place: half the square of the distance from the ball of the tolerance around
/// it, times \p weight; and within, a little of the distance from the place itself, so that it does not slide about in
/// the ball from step to step, and many that are off by chance are met in the middle.
FitSystem::Pull LandmarkPull(double tolerance, const Eigen::Vector3d &place, const Eigen::Vector3d &x, double weight);

/// Moves the free nodes of a graph, all together by as little as possible (least squares), so that some samples are
/// where they belong. The surface follows as smoothly as it follows the nodes.
/// \param first the number of the first of these samples; they are those from there on
/// \param place of each of them, frame units \param isFree flags of the graph's nodes
/// \return the largest move of a node, frame units \throw Cancelled
double MoveOnto(const FitSamples &samples, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                const std::vector<char> &isFree, GraphPose &pose, const Progress &progress = {});

/// The same where the nodes cannot take all samples there, or only by far more than these are off, as where there are
/// more samples than nodes around them: they come as near as the nodes can take them by moves of that size.
double MoveTowards(const FitSamples &samples, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                   const std::vector<char> &isFree, GraphPose &pose);

} // namespace vcg::fcd

#endif
