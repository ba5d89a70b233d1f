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

/// A place on a surface: slots of vertices and their weights, of sum 1.
struct SurfacePlace {
    static constexpr int most = 8;
    std::array<Index, most> slot;
    std::array<double, most> weight;
    int count = 0;

    static SurfacePlace AtVertex(Index slot) {
        SurfacePlace place;
        place.slot[0] = slot;
        place.weight[0] = 1;
        place.count = 1;
        return place;
    }
};

/// What lies around a vertex of a surface without triangles. Lengths are in a unit of the object that found it.
struct Around {
    Index slot = -1;           ///< of the vertex
    double least = 0;          ///< no point nearer to its place lies beyond an end; grows if isKnown
    bool isKnown = false;      ///< what follows is
    bool isPlane = false;      ///< the vertices around it lie along a plane
    double reach = 0;          ///< distance of the farthest one
    double leastBeside = 0;    ///< as least, along the plane
    Eigen::Vector3d across;    ///< normal of the plane, length 1
    Eigen::Matrix3Xd position; ///< of the vertices, from this one
};

/// Finds the place of a surface that is nearest to a point: on its triangles, or among its vertices if it has none,
/// where vertices at one position count as one. Safe for any number of threads.
class NearestPlace {
  public:
    /// \param given 3 x slots, any unit; must outlive this \param triangle slots of the corners
    /// \param isVertex flags of slots that count if there are no triangles
    /// \pre there is a triangle, or a vertex that counts \throw Cancelled
    NearestPlace(const Eigen::Matrix3Xd &given, std::vector<std::array<Index, 3>> triangle,
                 const std::vector<char> &isVertex, const Progress &progress = {});
    ~NearestPlace();
    NearestPlace(const NearestPlace &) = delete;
    NearestPlace &operator=(const NearestPlace &) = delete;

    /// The place nearest to \p p. It changes continuously with \p p wherever the nearest point does.
    SurfacePlace operator()(const Eigen::Vector3d &p) const {
        Hint none;
        return Find(p, none, nullptr);
    }

    /// What was found for one point; with it, a point nearby is found faster. It changes no bit of the result. Each
    /// object needs hints of its own.
    struct Hint {
        Index triangle = -1;
        std::size_t block = std::size_t(-1); ///< of vertices, where there are no triangles
        Around around;
    };
    SurfacePlace operator()(const Eigen::Vector3d &p, Hint &hint) const { return Find(p, hint, nullptr); }

    /// Whether vertices without triangles end between their place nearest to \p p and \p p: they lie along a plane
    /// there, and \p p lies beside them. So a match in that place is on a border. False if \p p is nearer than they are
    /// to each other, or they lie along no plane, as at the tip of a finger.
    /// \param at the place nearest to \p p \param hint what was found for it
    bool EndsBefore(const Eigen::Vector3d &p, const SurfacePlace &at, Hint &hint) const;

    /// The same for a point of another sampling of the same shape, such as a thinned one. If the nearest triangle faces
    /// away from \p normal (the opposite wall of a fold), this takes the nearest one that faces along \p normal, at
    /// most half an edge farther away. Two triangulations of a surface are nearer to each other than that if
    /// neighbouring triangles turn by less than 90 degrees.
    /// \param normal any length
    SurfacePlace operator()(const Eigen::Vector3d &p, Hint &hint, const Eigen::Vector3d &normal) const {
        return Find(p, hint, &normal);
    }

    /// Whether the normals of points agree with the surface: 1 if four fifths of them point to the side that the
    /// nearest triangles face, -1 if they point to the other side, 0 otherwise. In folds, a tenth of the points has the
    /// opposite wall nearest; if triangles face at random, half disagree. \param count number of points; about a
    /// thousand of them are looked at \param at at(i): a point \param normal normal(i): its normal; 0: the point is
    /// left out
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

    /// Slots of the corners of the triangles, as in construction. \pre there are some
    const std::vector<std::array<Index, 3>> &Triangles() const;

  private:
    SurfacePlace Find(const Eigen::Vector3d &at, Hint &hint, const Eigen::Vector3d *normal) const;
    Eigen::Vector3d InUnit(const Eigen::Vector3d &p) const;
    void Among(const Eigen::Vector3d &p, Hint &hint, SurfacePlace &place) const;
    double SideOf(const Eigen::Vector3d &p, const Eigen::Vector3d &normal) const;

    const double unit;             ///< of all lengths here: squares of others may be no numbers
    const Eigen::Matrix3Xd scaled; ///< the positions in that unit; none where it is 1
    const Eigen::Matrix3Xd &position;
    std::unique_ptr<const detail::TriangleTree> triangles; ///< null: there are none
    std::vector<Index> vertex;                             ///< slots of the points in vertices
    std::unique_ptr<const PointTree<double>> vertices;     ///< if there are no triangles
};

} // namespace vcg::fcd

#endif
