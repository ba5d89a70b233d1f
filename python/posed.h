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
    std::vector<std::pair<int, std::string>> motions; ///< of tags, as steps for ReadMotionText
    std::optional<Rows> targets;                      ///< of the landmarks, in their order; none: they stay
    double percent = 100;
    int steps = 1;
};

/// A pose of a prepared surface.
class Posed {
  public:
    /// Solves a pose; write() maps it. \param start the pose to begin from, or null: rest. Motions change from its own
    /// to the new ones as in a blend
    Posed(std::shared_ptr<const Prepared> prepared, const PoseParam &param, const Posed *start,
          const nb::object &report);
    /// A pose that something else has solved. \param seconds time for that
    Posed(std::shared_ptr<const Prepared> prepared, vcg::fcd::SurfacePose pose, double seconds);
    /// From state(), for a surface that is prepared alike. \throw BadInput it is of another surface or version
    Posed(std::shared_ptr<const Prepared> prepared, const nb::bytes &state);
    Posed(const Posed &) = delete;
    Posed &operator=(const Posed &) = delete;

    /// Maps the pose: writes positions and, with \p normals at rest, the turned ones.
    void write(const Written &vertices, const std::optional<Rows> &normals, const std::optional<Written> &turned,
               const nb::object &report);

    /// Counts signs that the pose is not as intended. \param vertices as written
    nb::dict check(const Rows &vertices, const nb::object &report) const;
    /// As FindContact. \param vertices as written \return faces, number of pairs, the largest depth, and the depth of
    /// each vertex, or None without contact
    nb::tuple contact(const Rows &vertices, const nb::object &report) const;
    /// The stretch of the surface at each vertex, n numbers.
    nb::object stretch(const Rows &vertices, const nb::object &report) const;
    /// Maps other points of the same space, and their normals.
    nb::tuple map(const Rows &points, const std::optional<Rows> &normals, const nb::object &report) const;
    /// The pose as a sampled field, and its report. \param accuracy as in FieldParam
    nb::tuple field(bool inverse, double accuracy, const nb::object &report) const;
    /// The positions of the graph's nodes, and their linear maps.
    nb::tuple nodes() const;
    nb::dict info() const;
    const vcg::fcd::SurfacePose &solved() const { return pose; }
    /// As Deformer::DiscretisationError; solves a second graph.
    double discretisationError(const nb::object &report) const;
    /// The pose without the surface, for pickles.
    nb::bytes state() const;

  private:
    void solve(const PoseParam &param, const Posed *start, const vcg::fcd::Progress &progress);
    vcg::fcd::Handles handlesOf(const PoseParam &param) const;
    vcg::fcd::Handles between(const Posed &start, const vcg::fcd::Handles &end, double percent, double share) const;

    const std::shared_ptr<const Prepared> prepared;
    std::vector<Eigen::Vector3d> reached; ///< places of the landmarks; empty if something else has solved the pose
    bool anyMoves = false;                ///< whether any handle or landmark moves
    vcg::fcd::SurfacePose pose;
    std::unique_ptr<const vcg::fcd::Carrier> carrier;
    double secondsSolve = 0, secondsMap = 0;
};

#endif
