// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_LOOK_H
#define VCG_FCD_SURFACE_LOOK_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vcg::fcd {

/// Red, green, blue and opacity of each vertex slot, or face, as sRGB has them; empty: there are none.
using ElementColors = std::vector<std::array<std::uint8_t, 4>>;

/// An image that lies on a surface.
struct TextureImage {
    std::string name;    ///< of its file, UTF-8
    std::string content; ///< of its file; empty: it is not there

    /// "image/png" or "image/jpeg", as the content begins; null: it is neither, and is not shown.
    const char *Kind() const;
};

/// What a surface looks like, beside its shape. Whatever is empty is not there.
struct SurfaceLook {
    static constexpr std::int32_t plain = -1; ///< the number of no texture

    ElementColors color;               ///< of each vertex slot
    ElementColors faceColor;           ///< of each face; not read where vertices have colours
    std::vector<float> place;          ///< texture coordinates, u and v (upwards) of the corners of each face: 6 a face
    std::vector<std::int32_t> texture; ///< of each face, the number of an image, or plain; empty: all have the first
    std::vector<TextureImage> image;

    bool HasColors() const { return !color.empty() || !faceColor.empty(); }
    /// The number of an image that is there, or plain.
    std::int32_t TextureOf(std::size_t face) const;
    bool IsShown(std::int32_t texture) const { return texture >= 0 && image[std::size_t(texture)].Kind(); }
};

} // namespace vcg::fcd

#endif
