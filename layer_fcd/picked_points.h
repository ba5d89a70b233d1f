// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_PICKED_POINTS_H
#define FCD_PICKED_POINTS_H

#include <vcg_ext/handles/handle_file.h> // before Qt

#include <string>
#include <utility>
#include <vector>

#include <QByteArray>

/// The active ones of MeshLab's picked points, in their order. Knows of no host, so that it can be fuzzed.
///
/// \param text what a .pp file holds
/// \param name of the file, for messages
/// \throw vcg::fcd::Error with the line and what was expected there
std::vector<Eigen::Vector3d> readActivePoints(const QByteArray &text, const std::string &name);

/// The same in pairs of start and target, of which there is one at least.
std::vector<vcg::fcd::PointPair> readPickedPoints(const QByteArray &text, const std::string &name);

/// The active ones of the picked points of two layers, in pairs of the same name, in the order of the first.
/// \throw vcg::fcd::Error as above; a name that comes twice in one of them, or in no pair
std::vector<vcg::fcd::PointPair> matchPickedPoints(const QByteArray &starts, const std::string &startsName,
                                                   const QByteArray &targets, const std::string &targetsName);

/// The names of the active ones, UTF-8, in their order. \throw as above
std::vector<std::string> namesOfPickedPoints(const QByteArray &text, const std::string &name);

/// Picked points with their names, as these functions read them, to the bit.
QByteArray pickedPointsText(const std::vector<std::pair<std::string, Eigen::Vector3d>> &points);

#endif
