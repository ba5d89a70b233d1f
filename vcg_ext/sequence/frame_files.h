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

/// Takes bytes that stand \p at so many bytes from the beginning of a file; what was not there before is zero.
using WriteAt = std::function<void(std::uint64_t at, const char *data, std::size_t size)>;

/// What files know of a surface: its vertices and triangles, without what is deleted.
struct PackedSurface {
    /// \throw Cancelled
    explicit PackedSurface(const SurfaceView &surface, const Progress &progress = {});
    /// The same, its triangles texture by texture, with further vertices behind its own where corners at one differ in
    /// texture coordinates, or in the colours of their faces. \pre the arrays of \p look are as long as the surface's
    PackedSurface(const SurfaceView &surface, const SurfaceLook &look, const Progress &progress);

    /// Triangles with one texture.
    struct Range {
        std::int32_t texture;     ///< number in the look, or SurfaceLook::plain
        std::size_t first, count; ///< of corners
    };

    std::vector<std::uint32_t> slot;   ///< of each vertex
    std::vector<std::uint32_t> corner; ///< numbers of vertices, 3 a triangle
    std::vector<Range> range;          ///< all corners; none without a triangle
    std::vector<std::uint32_t> wedge;  ///< of each vertex, 3 faces + the corner that it looks as, or SurfaceView::none;
                                       ///< empty: corners do not differ
    unsigned threads;                  ///< that write it, 0 = one a core
};

/// A point cache: where the vertices of a mesh are, in single precision, frame by frame. Blender's modifier "Mesh
/// Cache" reads both formats.
class PointCacheFile {
  public:
    enum Format {
        /// `.pc2`, of Autodesk's PointCache: "POINTCACHE2", 0, then integers and numbers of 4 bytes (the version 1, the
        /// number of vertices, the number of the first frame, frames a sample, samples), then three numbers a vertex a
        /// frame; all little-endian.
        Pc2,
        /// `.mdd`, of LightWave: the numbers of frames and of vertices, the time of each frame in seconds, then three
        /// numbers a vertex a frame; all of 4 bytes, and big-endian.
        Mdd
    };

    /// \param time of each frame, seconds \param rate frames a second
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

/// Times of frames in single precision. \param ending of the file that they are for
/// \throw BadInput two of them are then the same
std::vector<float> SingleTimes(const std::vector<double> &time, const std::string &ending);

/// body(i) for i from 0 to \p count, one after the other. \throw Cancelled
template <class Body>
void ForItems(std::size_t count, const Progress &progress, const Body &body) {
    const std::size_t block = 1 << 18; // takes some milliseconds
    for (std::size_t first = 0; first < count; first += block) {
        progress(0, readingStage);
        for (std::size_t i = first; i < std::min(first + block, count); ++i)
            body(i);
    }
}

/// Writes 3 numbers a vertex in single precision, block by block. \param row gives those of a slot
void WriteRows(const WriteAt &write, std::uint64_t at, const PackedSurface &surface,
               const std::function<Eigen::Vector3f(std::size_t slot)> &row);

} // namespace detail
} // namespace vcg::fcd

#endif
