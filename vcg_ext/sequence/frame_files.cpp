// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/frame_files.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
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
        ParallelForEach(surface.threads, last - first, 1 << 12, [&](std::size_t i) {
            Eigen::Map<Eigen::Vector3f>(numbers.data() + 3 * i) = row(surface.slot[first + i]);
        });
        if (!Eigen::Map<const Eigen::ArrayXf>(numbers.data(), Eigen::Index(3 * (last - first))).isFinite().all())
            throw BadInput("A vertex is farther away than single precision allows in this file (3e38). Scale the "
                           "scene, or leave that mesh out.");
        write(at + 12 * std::uint64_t(first), reinterpret_cast<const char *>(numbers.data()), 12 * (last - first));
    }
}

std::vector<float> SingleTimes(const std::vector<double> &time, const std::string &ending) {
    std::vector<float> seconds(time.size());
    std::transform(time.begin(), time.end(), seconds.begin(), [](double each) { return float(each); });
    if (std::adjacent_find(seconds.begin(), seconds.end(), std::greater_equal<float>()) != seconds.end())
        throw BadInput("A " + ending +
                       " file has single-precision times, in which some frames would be at the same time. Move the "
                       "first key frame nearer to 0 s.");
    return seconds;
}

} // namespace detail

namespace {

/// What takes numbers of 4 bytes and passes them on in the order of a format's bytes.
WriteAt InOrder(WriteAt write, PointCacheFile::Format format) {
    if (format == PointCacheFile::Pc2)
        return write;
    return [write = std::move(write)](std::uint64_t at, const char *data, std::size_t size) {
        std::string swapped(data, size);
        for (auto each = swapped.begin(); each != swapped.end(); each += 4)
            std::reverse(each, each + 4);
        write(at, swapped.data(), size);
    };
}

} // namespace

PointCacheFile::PointCacheFile(WriteAt given, const PackedSurface &surface, const std::vector<double> &time,
                               double rate, Format format)
    : write(InOrder(std::move(given), format)), surface(surface) {
    const auto put = [&](auto number) {
        static_assert(sizeof number == 4);
        write(at, reinterpret_cast<const char *>(&number), 4);
        at += 4;
    };
    const auto points = std::int32_t(surface.slot.size()), frames = std::int32_t(time.size());
    if (format == Pc2) {
        const char name[12] = "POINTCACHE2";
        write(at, name, sizeof name);
        at += sizeof name;
        put(std::int32_t(1)); // version
        put(points);
        put(float(std::round(time.front() * rate)));
        put(1.F); // frames a sample
        put(frames);
    } else {
        const std::vector<float> seconds = detail::SingleTimes(time, ".mdd");
        put(frames);
        put(points);
        write(at, reinterpret_cast<const char *>(seconds.data()), 4 * seconds.size());
        at += 4 * seconds.size();
    }
}

void PointCacheFile::Add(const PositionsRef &position) {
    detail::WriteRows(write, at, surface, [&](std::size_t slot) {
        return Eigen::Vector3f(position.col(Eigen::Index(slot)).cast<float>());
    });
    at += 12 * std::uint64_t(surface.slot.size());
}

} // namespace vcg::fcd
