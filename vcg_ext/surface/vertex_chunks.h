// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_VERTEX_CHUNKS_H
#define VCG_FCD_VERTEX_CHUNKS_H

#include <vcg_ext/base/frame.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace vcg::fcd::detail {

/// The number of vertices that are read, by chunks of slots, and their box.
struct VertexChunks {
    static constexpr std::size_t grain = 1 << 16; ///< slots a chunk

    std::vector<std::size_t> begin{0}; ///< chunks + 1: number of vertices before each chunk
    Eigen::AlignedBox3d box;           ///< world units

    std::size_t Live() const { return begin.back(); }
};

/// The slot of the k-th vertex that is read. \param begin as in VertexChunks \param isPart isPart(slot): it is read
template <class IsPart>
std::size_t SlotOf(std::size_t k, const std::vector<std::size_t> &begin, const IsPart &isPart) {
    const std::size_t c = std::size_t(std::upper_bound(begin.begin(), begin.end(), k) - begin.begin()) - 1;
    if (begin[c + 1] - begin[c] == VertexChunks::grain) // the whole chunk is read
        return c * VertexChunks::grain + (k - begin[c]);
    for (std::size_t i = c * VertexChunks::grain, at = begin[c];; ++i)
        if (isPart(i) && at++ == k)
            return i;
}

/// \param isPart isPart(slot): it is read \param frame gives the metric
/// \throw BadInput a coordinate that is not finite \throw Cancelled
template <class IsPart>
VertexChunks FindVertices(const SurfaceView &mesh, const IsPart &isPart, const Frame &frame, const Progress &progress) {
    struct Chunk {
        Eigen::AlignedBox3d box;
        std::size_t live = 0, bad = std::size_t(-1);
    };
    const std::size_t slots = mesh.vertexSlots, grain = VertexChunks::grain;
    std::vector<Chunk> chunks((slots + grain - 1) / grain);
    ParallelFor(progress, readingStage, slots, grain, [&](std::size_t first, std::size_t last) {
        Chunk c;
        for (std::size_t i = first; i < last; ++i) {
            if (!isPart(i))
                continue;
            const Eigen::Vector3d x = frame.ToWorld(mesh.At(i));
            if (!x.allFinite())
                c.bad = std::min(c.bad, i);
            c.box.extend(x);
            ++c.live;
        }
        chunks[first / grain] = c;
    });
    VertexChunks found;
    std::size_t bad = std::size_t(-1);
    for (const Chunk &c : chunks) {
        found.box.extend(c.box);
        found.begin.push_back(found.begin.back() + c.live);
        bad = std::min(bad, c.bad);
    }
    if (bad != std::size_t(-1))
        throw NotFinite(bad);
    return found;
}

/// Scales the boxes \p one and \p other if squares of lengths in \p all would overflow or underflow, by a power of two
/// near its size. \return the unit that they were divided by, mostly 1
inline double TakeUnit(const Eigen::AlignedBox3d &all, Eigen::AlignedBox3d &one, Eigen::AlignedBox3d &other) {
    const double unit = UnitOf(all.min().cwiseAbs().cwiseMax(all.max().cwiseAbs()).maxCoeff());
    for (Eigen::AlignedBox3d *box : {&one, &other})
        *box = {box->min() / unit, box->max() / unit};
    return unit;
}

/// Sets origin and scale of the frame by the vertices that are read, at least one. \param isPart as in FindVertices
template <class IsPart>
void SetFrame(const SurfaceView &mesh, const VertexChunks &chunks, const IsPart &isPart, Frame &frame) {
    const Eigen::AlignedBox3d box = WithoutStrays(chunks.box, chunks.Live(), [&](std::size_t k) {
        return frame.ToWorld(mesh.At(SlotOf(k, chunks.begin, isPart)));
    });
    const Eigen::Vector3d extent = box.max() * 0.5 - box.min() * 0.5; // half of it: no overflow
    const double halfDiagonal = extent.stableNorm();
    frame.origin = box.min() * 0.5 + box.max() * 0.5;
    frame.scale = halfDiagonal > 0 ? std::min(2 * halfDiagonal, std::numeric_limits<double>::max()) : 1;
}

} // namespace vcg::fcd::detail

#endif
