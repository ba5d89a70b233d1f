// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FRAME_FILES_H
#define VCG_FCD_FRAME_FILES_H

#include <vcg_ext/sequence/surface_look.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace vcg::fcd {

/// Writes bytes at an offset from the beginning of a file. Gaps are zero.
using WriteAt = std::function<void(std::uint64_t at, const char *data, std::size_t size)>;

/// The vertices and triangles of a surface as files have them, without deleted ones.
struct PackedSurface {
    /// \throw Cancelled
    explicit PackedSurface(const SurfaceView &surface, const Progress &progress = {});
    /// The same for glTF: triangles sorted by texture, and more vertices at the end for corners of a vertex that differ
    /// in texture coordinates or face colour. \pre the arrays of \p look have the surface's sizes
    PackedSurface(const SurfaceView &surface, const SurfaceLook &look, const Progress &progress);

    /// Triangles with one texture.
    struct Range {
        std::int32_t texture;     ///< number in SurfaceLook::image, or SurfaceLook::plain
        std::size_t first, count; ///< in corner
    };

    std::vector<std::uint32_t> slot;   ///< of each vertex
    std::vector<std::uint32_t> corner; ///< numbers of vertices, 3 per triangle
    std::vector<Range> range;          ///< covers all corners; empty for a cloud
    std::vector<std::uint32_t>
        wedge; ///< per vertex: 3 * face + corner with its look, or SurfaceView::none; empty if corners never differ
    unsigned threads; ///< for writing, 0 = one a core
};

/// A point cache: the positions of a mesh's vertices, frame by frame, in single precision. Blender's modifier "Mesh
/// Cache" reads both formats.
class PointCacheFile {
  public:
    enum Format {
        /// `.pc2`, of Autodesk's PointCache. 32 bytes ("POINTCACHE2", 0, the version 1, number of vertices, number of
        /// the
        /// first frame, frames per sample, number of samples), then three numbers for each vertex of each frame,
        /// little-endian.
        Pc2,
        /// `.mdd`, of LightWave. Number of frames, number of vertices, the time of each frame in seconds, then three
        /// numbers for each vertex of each frame; 4 bytes each, big-endian.
        Mdd
    };

    /// \param time of each frame, seconds \param rate frames per second
    /// \throw BadInput two frames (Mdd) are at the same time in single precision
    PointCacheFile(WriteAt write, const PackedSurface &surface, const std::vector<double> &time, double rate,
                   Format format);

    /// \param position 3 x vertex slots of the next frame
    /// \throw BadInput it is beyond single precision
    void Add(const PositionsRef &position);

  private:
    const WriteAt write;
    const PackedSurface &surface;
    std::uint64_t at = 0;
};

namespace detail {

/// Times of frames in single precision. \param ending of their file
/// \throw BadInput two of them are then the same
std::vector<float> SingleTimes(const std::vector<double> &time, const std::string &ending);

/// Calls body(i) for each i below \p count, in order, and reports progress. \throw Cancelled
template <class Body>
void ForItems(std::size_t count, const Progress &progress, const Body &body) {
    const std::size_t block = 1 << 18; // takes some milliseconds
    for (std::size_t first = 0; first < count; first += block) {
        progress(0, readingStage);
        for (std::size_t i = first; i < std::min(first + block, count); ++i)
            body(i);
    }
}

/// Writes 3 numbers per vertex in single precision. \param row the numbers of a slot
void WriteRows(const WriteAt &write, std::uint64_t at, const PackedSurface &surface,
               const std::function<Eigen::Vector3f(std::size_t slot)> &row);

} // namespace detail
} // namespace vcg::fcd

#endif
