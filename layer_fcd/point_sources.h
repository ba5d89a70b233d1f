// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_POINT_SOURCES_H
#define FCD_POINT_SOURCES_H

// Before Qt, whose macros (slots, emit, ...) are common words.
#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/fit.h>
#include <vcg_ext/handles/handle_file.h>
#include <vcg_ext/handles/handles.h>

#include "parameters.h" // Remark

#include <Eigen/Core>

#include <memory>
#include <vector>

/// Finds the vertices of a layer that points in files stand for.
class VertexFinder {
  public:
    /// \param rest positions per vertex slot; null: the layer is at rest
    VertexFinder(const MeshModel &layer, const Point3m *rest);

    /// The slot of a vertex by its number among the live ones. \throw vcg::fcd::Error \p file names none
    std::size_t numbered(std::int64_t number, const QString &file) const;
    /// The slot of the vertex nearest to \p point, world units. \param number of the point in its file, from 0
    /// \throw vcg::fcd::Error no vertex has finite coordinates
    std::size_t nearestTo(const Eigen::Vector3d &point, std::size_t number);
    /// From a vertex to \p point, which nearestTo got; world units. 0 if they differ by rounding of a file.
    Eigen::Vector3d beside(std::size_t vertex, const Eigen::Vector3d &point) const;
    /// The position of a vertex, layer units.
    Eigen::Vector3d at(std::size_t slot) const { return toVector(rest ? rest[slot] : layer.cm.vert[slot].cP()); }

    /// Says which points of \p file that nearestTo got are farther from the layer than it is large, and forgets them.
    void tellFar(const QString &file, const Remark &remark);

    const Eigen::Affine3d world; ///< from layer to world units

  private:
    void plant();

    const MeshModel &layer;
    const Point3m *rest;
    std::vector<std::size_t> live, slot; ///< of live vertices; of those in the tree
    std::vector<Eigen::Vector3d> place;  ///< of those in the tree, world units
    std::unique_ptr<vcg::fcd::PointTree<double>> tree;
    double size = 0;                 ///< diagonal of the layer's box, world units
    std::vector<std::size_t> strays; ///< points that are farther than that
    double farthest = 0;
};

/// Landmarks of \p layer from a file in world coordinates: MeshLab's picked points (.pp), in pairs of start and target,
/// or a list (vcg::fcd::ReadPointHandleFile). A start that is no vertex goes with the vertex nearest to it.
/// \param rest positions per vertex slot; null: the layer is at rest
/// \param targets picked points of the other layer, paired with those of \p file by name; may be empty
/// \param remark is told starts that are far from the layer
/// \throw vcg::fcd::Error the file cannot be read, or names a vertex that does not exist
std::vector<vcg::fcd::Landmark> readLandmarks(const MeshModel &layer, const Point3m *rest, const QString &file,
                                              const QString &targets = QString(), const Remark &remark = {});

/// Point handles from such a file. A start that is no vertex stands for the vertex nearest to it, which moves as the
/// start does. Parameters and errors as readLandmarks.
std::vector<vcg::fcd::PointHandle> readPointHandles(const MeshModel &layer, const Point3m *rest, const QString &file,
                                                    const Remark &remark = {});

/// The pairs of such a file, unchanged. \throw as readLandmarks
std::vector<vcg::fcd::PointPair> readPointPairs(const MeshModel &layer, const QString &file);

/// The points of the line that the edges of \p layer form, 3 x n, world units.
/// \throw vcg::fcd::Error naming the layer: no edges, a branch, a ring, several lines
Eigen::Matrix3Xd readLine(const MeshModel &layer);

/// The points of \p file, in their order, 3 x n: MeshLab's picked points (.pp), or a list of points.
/// \throw vcg::fcd::Error with the file, and what is wrong in it
Eigen::Matrix3Xd readLine(const QString &file);

#endif
