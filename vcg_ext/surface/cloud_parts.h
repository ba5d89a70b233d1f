// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CLOUD_PARTS_H
#define VCG_FCD_CLOUD_PARTS_H

#include <vcg_ext/base/elementary.h>
#include <vcg_ext/surface/surface_arrays.h>
#include <vcg_ext/surface/vertex_chunks.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

namespace vcg::fcd::detail {

/// The points of a cloud, sorted into cells, so that a region is read from the points around it alone.
class CloudParts {
  public:
    /// \param mesh must outlive this \param isLive isLive(slot): the point is read \param metric as in Frame
    /// \pre some point is live
    template <class IsLive>
    CloudParts(const SurfaceView &mesh, const IsLive &isLive, const Eigen::Matrix3d &metric, const Progress &progress)
        : mesh(mesh), metric(metric) {
        Frame world;
        world.SetMetric(metric);
        const VertexChunks chunks = FindVertices(mesh, isLive, world, progress.Slice(0, 0.5));
        const auto live = double(chunks.Live());
        places = WithoutStrays(chunks.box, chunks.Live(),
                               [&](std::size_t k) { return At(SlotOf(k, chunks.begin, isLive)); });
        // At most about as many cells as points, also if the points lie in a plane or along a line. On other surfaces
        // most cells are empty.
        Eigen::Array3d size = places.sizes();
        std::sort(size.data(), size.data() + 3, std::greater<>());
        width = std::max({Power(std::max(size[0] / live * size[1] * size[2], 1e-300), 1.0 / 3),
                          std::sqrt(size[0] / live * size[1]), size[0] / (1 << 10)});
        if (width > 0 && width <= std::numeric_limits<double>::max())
            across = (places.sizes().array() / width).ceil().cast<int>().max(1);
        else // all at one position, or infinitely far apart
            width = std::numeric_limits<double>::max();
        std::vector<std::uint32_t> cell;
        const auto cells = std::uint32_t(across.prod());
        AssignLarge(cell, mesh.vertexSlots, cells);
        ParallelForEach(progress.Slice(0.5, 1), readingStage, cell.size(), 1 << 16, [&](std::size_t i) {
            if (isLive(i))
                cell[i] = std::uint32_t(NumberOf(CellOf(i), across));
        });
        begin.assign(std::size_t(cells) + 2, 0);
        for (std::uint32_t c : cell)
            ++begin[c + 1];
        std::partial_sum(begin.begin(), begin.end(), begin.begin());
        AssignLarge(slots, cell.size(), std::uint32_t(0));
        std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
        for (std::size_t i = 0; i < cell.size(); ++i)
            slots[next[cell[i]]++] = std::uint32_t(i);
    }

    /// The slots of the points in the cells of \p some points and in rings of cells around, ascending.
    /// \param reach in: all points within this distance of \p some are asked for, world units; 0: a distance that
    /// mostly holds \p wanted points around each \param reach out: the distance that the cells do cover, at least that;
    /// infinity if they hold all points
    std::vector<std::uint32_t> Around(const std::vector<std::uint32_t> &some, std::size_t wanted, double &reach) const {
        Eigen::AlignedBox3i own;
        for (std::uint32_t i : some)
            own.extend(CellOf(i).matrix());
        const double most = double(across.maxCoeff()), cells = reach / width * (1 + 2e-9); // more than taken off below
        const int rings = reach == 0 ? RingsFor(some, wanted) : std::max(1, int(std::ceil(std::min(cells, most))));
        const Cell low = (own.min().array() - rings).max(0), high = (own.max().array() + rings).min(across - 1);
        const Cell size = high - low + 1;
        std::vector<char> isNear(std::size_t(size.cast<double>().prod()), 0);
        for (std::uint32_t i : some)
            isNear[NumberOf(CellOf(i) - low, size)] = 1;
        std::size_t stride = 1;
        for (int axis = 2; axis >= 0; stride *= std::size_t(size[axis--]))
            Widen(isNear, stride, std::size_t(size[axis]), rings);
        std::vector<std::uint32_t> found;
        for (int x = 0; x < size[0]; ++x)
            for (int y = 0; y < size[1]; ++y)
                for (int z = 0; z < size[2]; ++z)
                    if (isNear[NumberOf({x, y, z}, size)]) {
                        const std::size_t cell = NumberOf(low + Cell(x, y, z), across);
                        found.insert(found.end(), slots.begin() + begin[cell], slots.begin() + begin[cell + 1]);
                    }
        std::sort(found.begin(), found.end());
        const bool isAll = found.size() == begin[begin.size() - 2];
        reach = isAll ? std::numeric_limits<double>::infinity() : rings * width * (1 - 1e-9); // which is rounded
        return found;
    }

    Eigen::AlignedBox3d places; ///< as in CloudPart

  private:
    using Cell = Eigen::Array3i;

    Eigen::Vector3d At(std::size_t slot) const { return metric * mesh.At(slot); }
    /// Beyond the box, the outermost cell.
    Cell CellOf(std::size_t slot) const {
        const Eigen::Array3d at = (At(slot) - places.min()).array() / width;
        return at.max(0.).min((across - 1).cast<double>()).cast<int>();
    }
    static std::size_t NumberOf(const Cell &c, const Cell &size) {
        return (std::size_t(c[0]) * std::size_t(size[1]) + std::size_t(c[1])) * std::size_t(size[2]) +
               std::size_t(c[2]);
    }

    /// The number of rings of cells that hold three times \p wanted points, on a sheet with as many points a cell as
    /// \p some have.
    int RingsFor(const std::vector<std::uint32_t> &some, std::size_t wanted) const {
        std::vector<std::size_t> cell;
        cell.reserve(some.size());
        for (std::uint32_t i : some)
            cell.push_back(NumberOf(CellOf(i), across));
        std::sort(cell.begin(), cell.end());
        const auto cells = double(std::unique(cell.begin(), cell.end()) - cell.begin());
        const double rings = std::sqrt(3 * double(wanted) * cells / double(some.size())) / 2;
        return std::max(1, int(std::ceil(std::min(rings, double(across.maxCoeff())))));
    }

    /// Also flags the cells up to \p rings along an axis from a flagged one.
    static void Widen(std::vector<char> &isNear, std::size_t stride, std::size_t count, int rings) {
        constexpr char given = 1, added = 2;
        const auto each = [&](char &flag, int &since) {
            since = (flag & given) ? 0 : std::min(since + 1, rings + 1);
            flag = char(flag | (since <= rings ? added : 0));
        };
        for (std::size_t first = 0; first < isNear.size(); ++first) {
            if (first / stride % count != 0)
                continue;
            int since = rings + 1;
            for (std::size_t k = 0; k < count; ++k)
                each(isNear[first + k * stride], since);
            since = rings + 1;
            for (std::size_t k = count; k-- > 0;)
                each(isNear[first + k * stride], since);
        }
        for (char &flag : isNear)
            flag = char(flag != 0);
    }

    const SurfaceView &mesh;
    const Eigen::Matrix3d metric;
    double width = 1;                        ///< of a cell, world units
    Cell across = Cell::Ones();              ///< how many cells
    std::vector<std::uint32_t> begin, slots; ///< each cell's slots; then those of points that are not read
};

} // namespace vcg::fcd::detail

#endif
