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

/// A surface on arrays, which must outlive it. \param faces none: a cloud
vcg::fcd::SurfaceView viewOf(const Rows &vertices, const std::optional<Corners> &faces);

/// A surface of numpy's arrays that is prepared to be deformed. It refers to the arrays. Python passes arrays of its
/// own, or checks before each call that they have not changed.
class Prepared {
  public:
    /// \param tags one per vertex \param points vertices of the landmarks \param kept as in PrepareDeformer, or null
    Prepared(const Rows &vertices, const std::optional<Corners> &faces, const Given<std::int32_t, nb::ndim<1>> &tags,
             const Given<std::int64_t, nb::ndim<1>> &points, const vcg::fcd::DeformationParam &param, unsigned threads,
             const nb::object &report, const Prepared *kept);
    /// A surface that is all free, without handles.
    Prepared(const Rows &vertices, const std::optional<Corners> &faces, const vcg::fcd::DeformationParam &param,
             unsigned threads, const nb::object &report);
    /// Makes the deformer of the view and the tags.
    using Make = std::function<std::shared_ptr<const vcg::fcd::Deformer>(const Prepared &, const vcg::fcd::Progress &)>;
    /// A surface with the deformer of \p make. \param tags one per vertex
    Prepared(const Rows &vertices, const std::optional<Corners> &faces, const Given<std::int32_t, nb::ndim<1>> &tags,
             const vcg::fcd::DeformationParam &param, unsigned threads, const nb::object &report, const Make &make);

    // For Deformer and Graph in Python.
    nb::tuple graph() const;
    nb::object patchOf() const;
    nb::tuple weights(const nb::object &report) const;
    nb::dict report() const;
    nb::dict centers() const;

    /// The vertex normals of \p positions: the sum of the faces' normals, times their angles there, of length 1; 0
    /// without a face.
    void normalsOf(const Rows &positions, const Written &out) const;

    /// Finds the nearest place of the surface; built at the first use. \throw BadInput a coordinate is no longer finite
    const vcg::fcd::NearestPlace &places(const vcg::fcd::Progress &progress) const;

    const Rows vertices;
    const std::optional<Corners> faces;
    vcg::fcd::SurfaceView view;
    vcg::fcd::Handles handles; ///< tags, and vertices of the landmarks
    const vcg::fcd::DeformationParam param;
    const unsigned threads;
    vcg::fcd::TagCount tags;
    std::shared_ptr<const vcg::fcd::Deformer> deformer;
    std::vector<std::uint32_t> still; ///< slots that move in no pose
    Eigen::AlignedBox3d box;          ///< of the vertices
    double seconds = 0;               ///< time for the preparation

  private:
    void prepare(const nb::object &report, const Make &make);
    void findStill(const vcg::fcd::Progress &progress);
    std::vector<std::int32_t> firstNodes() const; // number of each region's first node, then the number of all

    mutable std::once_flag placesMade;
    mutable Eigen::Matrix3Xd rest; ///< 3 x n, for places()
    mutable std::unique_ptr<vcg::fcd::NearestPlace> found;
};

/// The numbers of the vertices nearest to points.
nb::object nearestVertices(const Rows &vertices, const Rows &points, unsigned threads, const nb::object &report);

/// A checksum of the numbers' bits; the same for any number of threads.
std::uint64_t checksum(const Rows &rows, unsigned threads);

#endif
