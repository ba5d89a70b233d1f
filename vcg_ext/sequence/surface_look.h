// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_LOOK_H
#define VCG_FCD_SURFACE_LOOK_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace vcg::fcd {

/// Red, green, blue (sRGB) and opacity of each vertex slot or face; empty: none.
using ElementColors = std::vector<std::array<std::uint8_t, 4>>;

/// An image that lies on a surface.
struct TextureImage {
    std::string name;    ///< of its file, UTF-8
    std::string content; ///< of its file; empty: missing

    /// "image/png" or "image/jpeg", by the first bytes; null for others, which are not shown.
    const char *Kind() const;
};

/// Colours and textures of a surface.
struct SurfaceLook {
    static constexpr std::int32_t plain = -1; ///< the number of no texture

    ElementColors color;               ///< of each vertex slot
    ElementColors faceColor;           ///< of each face; not read where vertices have colours
    std::vector<float> place;          ///< texture coordinates: u and v (upwards) of the corners, 6 per face
    std::vector<std::int32_t> texture; ///< of each face: number of an image, or plain; empty: all have the first image
    std::vector<TextureImage> image;

    bool HasColors() const { return !color.empty() || !faceColor.empty(); }
    /// The number of the face's image if it is shown, else plain.
    std::int32_t TextureOf(std::size_t face) const;
    bool IsShown(std::int32_t texture) const { return texture >= 0 && image[std::size_t(texture)].Kind(); }
};

} // namespace vcg::fcd

#endif
