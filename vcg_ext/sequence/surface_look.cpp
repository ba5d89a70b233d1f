// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/frame_files.h>
#include <vcg_ext/sequence/surface_look.h>

#include <cassert>
#include <cstring>

namespace vcg::fcd {

const char *TextureImage::Kind() const {
    const auto begins = [this](const char *with) { return content.compare(0, std::strlen(with), with) == 0; };
    if (begins("\x89PNG\r\n\x1A\n")) // Portable Network Graphics (PNG) Specification, 5.2
        return "image/png";
    return begins("\xFF\xD8\xFF") ? "image/jpeg" : nullptr; // ITU-T T.81, B.1.1.3: start of image, and a marker
}

std::int32_t SurfaceLook::TextureOf(std::size_t face) const {
    if (place.empty())
        return plain;
    const std::int32_t number = texture.empty() ? 0 : texture[face];
    return number >= 0 && std::size_t(number) < image.size() ? number : plain;
}

PackedSurface::PackedSurface(const SurfaceView &surface, const SurfaceLook &look, const Progress &progress)
    : PackedSurface(surface, progress) {
    const bool hasPlaces = !look.place.empty(), hasFaceColors = look.color.empty() && !look.faceColor.empty();
    assert(!hasPlaces || look.place.size() == 6 * surface.faces);
    assert(!hasFaceColors || look.faceColor.size() == surface.faces);
    if (corner.empty() || (!hasPlaces && !hasFaceColors))
        return;
    std::vector<std::uint32_t> face; // of each triangle that is written
    face.reserve(corner.size() / 3);
    detail::ForItems(surface.faces, progress, [&](std::size_t f) {
        if (surface.IsFace(f))
            face.push_back(std::uint32_t(f));
    });
    const auto placeBits = [&](std::uint32_t c) { // u and v as bits: a NaN equals itself
        std::uint64_t bits;
        std::memcpy(&bits, &look.place[2 * std::size_t(c)], sizeof bits);
        return bits;
    };
    const auto isAlike = [&](std::uint32_t a, std::uint32_t b) {
        return (!hasPlaces || placeBits(a) == placeBits(b)) &&
               (!hasFaceColors || look.faceColor[a / 3] == look.faceColor[b / 3]);
    };
    wedge.assign(slot.size(), SurfaceView::none);
    std::vector<std::uint32_t> next(slot.size(), SurfaceView::none); // next vertex of the same slot
    detail::ForItems(corner.size(), progress, [&](std::size_t c) {
        const auto own = std::uint32_t(3 * std::size_t(face[c / 3]) + c % 3);
        std::uint32_t at = corner[c];
        if (wedge[at] == SurfaceView::none)
            wedge[at] = own;
        while (!isAlike(wedge[at], own)) {
            if (next[at] == SurfaceView::none) {
                next[at] = std::uint32_t(slot.size());
                slot.push_back(slot[at]);
                wedge.push_back(own);
                next.push_back(SurfaceView::none);
            }
            at = next[at];
        }
        corner[c] = at;
    });

    // Sorts triangles by texture, stable, those without one first.
    const auto placeOf = [&](std::uint32_t f) { return std::size_t(std::ptrdiff_t(look.TextureOf(f)) + 1); };
    std::vector<std::size_t> count(look.image.size() + 1, 0);
    detail::ForItems(face.size(), progress, [&](std::size_t i) { ++count[placeOf(face[i])]; });
    range.clear();
    std::vector<std::size_t> to(count.size(), 0);
    for (std::size_t i = 0, first = 0; i < count.size(); first += 3 * count[i], ++i) {
        to[i] = first;
        if (count[i] > 0)
            range.push_back({std::int32_t(i) - 1, first, 3 * count[i]});
    }
    if (range.size() < 2)
        return;
    std::vector<std::uint32_t> sorted(corner.size());
    detail::ForItems(face.size(), progress, [&](std::size_t i) {
        std::size_t &at = to[placeOf(face[i])];
        for (std::size_t k = 0; k < 3; ++k)
            sorted[at++] = corner[3 * i + k];
    });
    corner.swap(sorted);
}

} // namespace vcg::fcd
