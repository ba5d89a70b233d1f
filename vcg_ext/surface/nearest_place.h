// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NEAREST_PLACE_H
#define VCG_FCD_NEAREST_PLACE_H

#include <vcg_ext/base/graph.h>
#include <vcg_ext/base/progress.h>

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace vcg::fcd {

template <class Scalar>
class PointTree;
namespace detail {
class TriangleTree;
}

/// A place on a surface: vertices and their weights, of sum 1.
struct SurfacePlace {
    static constexpr int most = 8;
    std::array<Index, most> slot;
    std::array<double, most> weight;
    int count = 0;
};

/// Finds the places of a surface that are nearest to points: on its triangles, or among its vertices where it has none,
/// of which those at one place count as one.
/// Any number of threads may ask.
class NearestPlace {
  public:
    /// \param position 3 x slots, which must outlive this \param triangle slots of the corners \param isVertex flags of
    /// slots, of those that count where there are no triangles \throw Cancelled
    /// \pre a triangle, or a vertex that counts
    NearestPlace(const Eigen::Matrix3Xd &position, std::vector<std::array<Index, 3>> triangle,
                 const std::vector<char> &isVertex, const Progress &progress = {});
    ~NearestPlace();
    NearestPlace(const NearestPlace &) = delete;
    NearestPlace &operator=(const NearestPlace &) = delete;

    /// The place nearest to \p p, which changes continuously with it as far as the nearest one does.
    SurfacePlace operator()(const Eigen::Vector3d &p) const {
        Hint none;
        return Find(p, none, nullptr);
    }

    /// What was found for one point, to find the next one sooner that is near it; it changes no bit.
    struct Hint {
        Index triangle = -1;
        std::size_t block = std::size_t(-1); ///< of vertices, where there are no triangles
    };
    SurfacePlace operator()(const Eigen::Vector3d &p, Hint &hint) const { return Find(p, hint, nullptr); }

    /// The same for a point of another surface that stands for the same shape, as a thinned one does: where the nearest
    /// triangle looks away from \p normal, as the other wall of a fold does, the nearest one that does not, if it is
    /// hardly farther away. Two triangulations of a surface whose triangles turn by less than 90 degrees from one to
    /// the next are less than half an edge apart: so much farther.
    /// \param normal any length
    SurfacePlace operator()(const Eigen::Vector3d &p, Hint &hint, const Eigen::Vector3d &normal) const {
        return Find(p, hint, &normal);
    }

    /// Whether the normals of points tell the sides of the surface: 1 where they look to where the nearest triangles
    /// do, -1 where they look the other way, 0 where neither is so for four fifths of them. In folds, a tenth has
    /// another wall nearest; where triangles look anywhere, a half does.
    /// \param at at(i): a point \param normal normal(i): its normal; 0: the point is not looked at \param count points;
    /// some are looked at
    template <class At, class Normal>
    int SidesTold(std::size_t count, const At &at, const Normal &normal) const {
        const std::size_t looks = 1000; // the share is then known to 1.6 percent
        std::size_t along = 0, against = 0;
        for (std::size_t i = 0; i < count; i += 1 + count / looks) {
            const Eigen::Vector3d n = normal(i);
            const double side = n.isZero(0) ? 0 : SideOf(at(i), n);
            along += side > 0;
            against += side < 0;
        }
        return 4 * against < along ? 1 : 4 * along < against ? -1 : 0;
    }

    /// Slots of the corners of its triangles, as they were given. \pre it has some
    const std::vector<std::array<Index, 3>> &Triangles() const;

  private:
    SurfacePlace Find(const Eigen::Vector3d &p, Hint &hint, const Eigen::Vector3d *normal) const;
    void Among(const Eigen::Vector3d &p, Hint &hint, SurfacePlace &place) const;
    double SideOf(const Eigen::Vector3d &p, const Eigen::Vector3d &normal) const;

    const Eigen::Matrix3Xd &position;
    std::unique_ptr<const detail::TriangleTree> triangles; ///< of a surface that has some
    std::vector<Index> vertex;
    std::unique_ptr<const PointTree<double>> vertices;
};

} // namespace vcg::fcd

#endif
