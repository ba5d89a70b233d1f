// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_PREPARED_H
#define PYMESHLAB_FCD_PREPARED_H

#include "arrays.h"
#include "listener.h"

#include <vcg_ext/deformer.h>
#include <vcg_ext/surface/nearest_place.h>

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

/// A surface of numpy's arrays that is prepared to be deformed. The arrays are referred to, not copied: Python gives
/// arrays of its own, or looks before each call whether they are as they were.
class Prepared {
  public:
    /// \param tags one per vertex \param points vertices of the landmarks \param kept as of PrepareDeformer, or null
    Prepared(const Rows &vertices, const std::optional<Corners> &faces, const Given<std::int32_t, nb::ndim<1>> &tags,
             const Given<std::int64_t, nb::ndim<1>> &points, const vcg::fcd::DeformationParam &param, unsigned threads,
             const nb::object &report, const Prepared *kept);
    /// All of it is free, to be moved by something else than handles.
    Prepared(const Rows &vertices, const std::optional<Corners> &faces, const vcg::fcd::DeformationParam &param,
             unsigned threads, const nb::object &report);
    /// Prepares the view and the tags of one that is read.
    using Make = std::function<std::shared_ptr<const vcg::fcd::Deformer>(const Prepared &, const vcg::fcd::Progress &)>;
    /// What \p make prepares, to be moved by something else than handles, or beside them. \param tags one per vertex
    Prepared(const Rows &vertices, const std::optional<Corners> &faces, const Given<std::int32_t, nb::ndim<1>> &tags,
             const vcg::fcd::DeformationParam &param, unsigned threads, const nb::object &report, const Make &make);

    // What Python is told of it; see Deformer and Graph there.
    nb::tuple graph() const;
    nb::object patchOf() const;
    nb::tuple weights(const nb::object &report) const;
    nb::dict report() const;
    nb::dict centers() const;

    /// The normals of \p positions, one per vertex: the sum of those of its faces, times their angles there; 0 without
    /// a face.
    void normalsOf(const Rows &positions, const Written &out) const;

    /// A search tree for the nearest place of the surface, built at the first use. \throw BadInput a coordinate that is
    /// no longer finite
    const vcg::fcd::NearestPlace &places(const vcg::fcd::Progress &progress) const;

    const Rows vertices;
    const std::optional<Corners> faces;
    vcg::fcd::SurfaceView view;
    vcg::fcd::Handles handles; ///< tags, and the vertices of points
    const vcg::fcd::DeformationParam param;
    const unsigned threads;
    vcg::fcd::TagCount tags;
    std::shared_ptr<const vcg::fcd::Deformer> deformer;
    std::vector<std::uint32_t> still; ///< slots that move in no pose
    Eigen::AlignedBox3d box;          ///< of the vertices
    double seconds = 0;               ///< that it took

  private:
    void prepare(const nb::object &report, const Make &make);
    void findStill(const vcg::fcd::Progress &progress);
    std::vector<std::int32_t> firstNodes() const; // of each region, and how many there are

    mutable std::once_flag placesMade;
    mutable Eigen::Matrix3Xd rest; ///< for places
    mutable std::unique_ptr<vcg::fcd::NearestPlace> found;
};

/// The numbers of the vertices nearest to points.
nb::object nearestVertices(const Rows &vertices, const Rows &points, unsigned threads, const nb::object &report);

/// A sum of the bits of numbers, to tell whether any has changed; the same for any number of threads.
std::uint64_t checksum(const Rows &rows, unsigned threads);

#endif
