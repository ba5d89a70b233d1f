// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_NEAREST_PLACE_H
#define VCG_FCD_NEAREST_PLACE_H

#include <vcg_ext/base/graph.h>

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

namespace vcg {
namespace fcd {

/// A place on a surface: vertices and their weights, of sum 1.
struct SurfacePlace {
    static constexpr int most = 8;
    std::array<Index, most> slot;
    std::array<double, most> weight;
    int count = 0;
};

/// Finds the places of a surface that are nearest to points: on its triangles, or among its vertices where it has none.
/// Any number of threads may ask.
class NearestPlace {
  public:
    /// \param position 3 x slots, which must outlive this \param triangle slots of the corners \param isVertex flags of
    /// slots, of those that count where there are no triangles \pre a triangle, or a vertex that counts
    NearestPlace(const Eigen::Matrix3Xd &position, std::vector<std::array<Index, 3>> triangle,
                 const std::vector<char> &isVertex);
    ~NearestPlace();
    NearestPlace(const NearestPlace &) = delete;
    NearestPlace &operator=(const NearestPlace &) = delete;

    /// The place nearest to \p p, which changes continuously with it as far as the nearest one does.
    SurfacePlace operator()(const Eigen::Vector3d &p) const;

    /// What was found for one point, to find the next one sooner that is near it; it changes no bit.
    struct Hint {
        Index triangle = -1;
    };
    SurfacePlace operator()(const Eigen::Vector3d &p, Hint &hint) const;

  private:
    class Search;
    const std::unique_ptr<const Search> search;
};

} // namespace fcd
} // namespace vcg

#endif
