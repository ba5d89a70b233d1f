// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/frame_files.h>

#include <algorithm>
#include <cstring>
#include <utility>

namespace vcg::fcd {

PackedSurface::PackedSurface(const SurfaceView &surface, const Progress &progress) : threads(progress.threads) {
    std::vector<std::uint32_t> number(surface.vertexSlots, SurfaceView::none);
    detail::ForItems(surface.vertexSlots, progress, [&](std::size_t i) {
        if (!surface.IsDeleted(i)) {
            number[i] = std::uint32_t(slot.size());
            slot.push_back(std::uint32_t(i));
        }
    });
    corner.reserve(3 * surface.faces);
    detail::ForItems(surface.faces, progress, [&](std::size_t f) {
        for (std::size_t k = 0; surface.IsFace(f) && k < 3; ++k)
            corner.push_back(number[surface.corner[3 * f + k]]);
    });
    if (!corner.empty())
        range.push_back({SurfaceLook::plain, 0, corner.size()});
}

namespace detail {

void WriteRows(const WriteAt &write, std::uint64_t at, const PackedSurface &surface,
               const std::function<Eigen::Vector3f(std::size_t slot)> &row) {
    const std::size_t block = 1 << 16;
    std::vector<float> numbers(3 * std::min(block, surface.slot.size()));
    for (std::size_t first = 0; first < surface.slot.size(); first += block) {
        const std::size_t last = std::min(first + block, surface.slot.size());
        ParallelFor(surface.threads, last - first, 1 << 12, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                Eigen::Map<Eigen::Vector3f>(numbers.data() + 3 * i) = row(surface.slot[first + i]);
        });
        if (!Eigen::Map<const Eigen::ArrayXf>(numbers.data(), Eigen::Index(3 * (last - first))).isFinite().all())
            throw BadInput("The file holds coordinates up to 3e38, in single precision, and a vertex is farther away. "
                           "Scale the scene, or leave that mesh out.");
        write(at + 12 * std::uint64_t(first), reinterpret_cast<const char *>(numbers.data()), 12 * (last - first));
    }
}

} // namespace detail

PointCacheFile::PointCacheFile(WriteAt write, const PackedSurface &surface, std::size_t frames, double first)
    : write(std::move(write)), surface(surface) {
    char header[32] = "POINTCACHE2";
    const std::int32_t version = 1, points = std::int32_t(surface.slot.size()), samples = std::int32_t(frames);
    const float start = float(first), rate = 1;
    std::memcpy(header + 12, &version, 4);
    std::memcpy(header + 16, &points, 4);
    std::memcpy(header + 20, &start, 4);
    std::memcpy(header + 24, &rate, 4);
    std::memcpy(header + 28, &samples, 4);
    this->write(0, header, sizeof header);
    at = sizeof header;
}

void PointCacheFile::Add(const PositionsRef &position) {
    detail::WriteRows(write, at, surface, [&](std::size_t slot) {
        return Eigen::Vector3f(position.col(Eigen::Index(slot)).cast<float>());
    });
    at += 12 * std::uint64_t(surface.slot.size());
}

} // namespace vcg::fcd
