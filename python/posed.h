// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_POSED_H
#define PYMESHLAB_FCD_POSED_H

#include "field.h"
#include "prepared.h"

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

/// How a prepared surface is posed.
struct PoseParam {
    std::vector<std::pair<int, std::string>> motions; ///< of tags, as ReadMotionText reads their steps
    std::optional<Rows> targets;                      ///< of the landmarks
    double percent = 100;
    int steps = 1;
};

/// A pose of a prepared surface.
class Posed {
  public:
    /// Solved, but not yet mapped. \param start the pose to go on from; its motions lead to the new ones as those of a
    /// blend do
    Posed(std::shared_ptr<const Prepared> prepared, const PoseParam &param, const Posed *start,
          const nb::object &report);
    /// A pose that something else has found. \param seconds that it took
    Posed(std::shared_ptr<const Prepared> prepared, vcg::fcd::SurfacePose pose, double seconds);
    /// As state() has told it, of a surface that is prepared alike. \throw BadInput another one
    Posed(std::shared_ptr<const Prepared> prepared, const nb::bytes &state);
    Posed(const Posed &) = delete;
    Posed &operator=(const Posed &) = delete;

    /// Writes positions and, if \p normals at rest are given, what these turn to. What is in the arrays before is lost.
    void write(const Written &vertices, const std::optional<Rows> &normals, const std::optional<Written> &turned,
               const nb::object &report);

    /// Counts what is probably not meant. \param vertices as written
    nb::dict check(const Rows &vertices, const nb::object &report) const;
    /// Where the surface passes through itself and did not at rest. \param vertices as written \return faces, pairs,
    /// the largest depth, and the depth at each vertex or None
    nb::tuple contact(const Rows &vertices, const nb::object &report) const;
    /// Stretch of the surface at each vertex.
    nb::object stretch(const Rows &vertices, const nb::object &report) const;
    /// Other points of the same space, and their normals.
    nb::tuple map(const Rows &points, const std::optional<Rows> &normals, const nb::object &report) const;
    /// The same as a field that is sampled, and what there is to say of it. \param accuracy as of FieldParam
    nb::tuple field(bool inverse, double accuracy, const nb::object &report) const;
    /// Positions of the nodes, and their linear maps.
    nb::tuple nodes() const;
    nb::dict info() const;
    /// How far it is from the pose of more and more nodes; solves a second graph.
    double discretisationError(const nb::object &report) const;
    /// All that it knows besides the surface.
    nb::bytes state() const;

  private:
    void solve(const PoseParam &param, const Posed *start, const vcg::fcd::Progress &progress);
    vcg::fcd::Handles handlesOf(const PoseParam &param) const;
    vcg::fcd::Handles between(const Posed &start, const vcg::fcd::Handles &end, double percent, double share) const;

    const std::shared_ptr<const Prepared> prepared;
    std::vector<Eigen::Vector3d> reached; ///< where the landmarks are; none of a pose that something else has found
    bool anyMoves = false;                ///< whether any motion leads anywhere
    vcg::fcd::SurfacePose pose;
    std::unique_ptr<const vcg::fcd::Carrier> carrier;
    double secondsSolve = 0, secondsMap = 0;
};

#endif
