// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_PICKED_POINTS_H
#define FCD_PICKED_POINTS_H

#include <vcg_ext/handles/handle_file.h> // before Qt

#include <string>
#include <utility>
#include <vector>

#include <QByteArray>

/// The active points of MeshLab's picked points, in their order.
/// \param text of a .pp file \param name of the file, for messages
/// \throw vcg::fcd::Error with the line and what was expected there
std::vector<Eigen::Vector3d> readActivePoints(const QByteArray &text, const std::string &name);

/// The active points as pairs of start and target, at least one. \throw as above; no pair, or an odd number
std::vector<vcg::fcd::PointPair> readPickedPoints(const QByteArray &text, const std::string &name);

/// The active points of two files as pairs of the same name, in the order of the first file.
/// \throw vcg::fcd::Error as above; a name that comes twice in a file, or in one file only
std::vector<vcg::fcd::PointPair> matchPickedPoints(const QByteArray &starts, const std::string &startsName,
                                                   const QByteArray &targets, const std::string &targetsName);

/// The names of the active points, UTF-8, in their order. \throw as above
std::vector<std::string> namesOfPickedPoints(const QByteArray &text, const std::string &name);

/// The text that these functions read, to the bit.
QByteArray pickedPointsText(const std::vector<std::pair<std::string, Eigen::Vector3d>> &points);

#endif
