// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/sequence/frame_files.h>
#include <vcg_ext/sequence/surface_look.h>
#include "test_support.h"

using namespace vcg::fcd;

namespace {

/// Two triangles beside each other, one that is deleted, and one more on their common edge; vertex 1 is deleted.
struct Leaves {
    std::vector<double> position = std::vector<double>(18, 0.5);
    std::vector<char> deleted{0, 1, 0, 0, 0, 0};
    std::vector<std::uint32_t> corner{0, 2, 3, SurfaceView::none, 1, 0, 2, 4, 3, 3, 2, 5};
    SurfaceView View() const {
        SurfaceView view;
        view.position = position.data();
        view.vertexSlots = 6;
        view.deleted = deleted.data();
        view.corner = corner.data();
        view.faces = 4;
        return view;
    }
};

using Numbers = std::vector<std::uint32_t>;

} // namespace

TEST(SurfaceLook, SplitsVerticesAlongSeamsAlone) {
    const Leaves leaves;
    SurfaceLook look;
    look.place.assign(24, 0);
    const PackedSurface same(leaves.View(), look, {});
    EXPECT_EQ(same.slot, (Numbers{0, 2, 3, 4, 5}));
    EXPECT_EQ(same.corner, (Numbers{0, 1, 2, 1, 3, 2, 2, 1, 4}));
    EXPECT_EQ(same.wedge, (Numbers{0, 1, 2, 7, 11}));

    for (std::size_t k = 0; k < 3; ++k)
        look.place[18 + 2 * k] = 0.25f; // the third face has other coordinates
    look.place[12] = 1;                 // and, of the second one, slot 2
    const PackedSurface split(leaves.View(), look, {});
    EXPECT_EQ(split.slot, (Numbers{0, 2, 3, 4, 5, 2, 3, 2})); // its own first
    EXPECT_EQ(split.corner, (Numbers{0, 1, 2, 5, 3, 2, 6, 7, 4}));
    EXPECT_EQ(split.wedge, (Numbers{0, 1, 2, 7, 11, 6, 9, 10}));
    ASSERT_EQ(split.range.size(), 1u);
    EXPECT_EQ(split.range[0].texture, SurfaceLook::plain);
    EXPECT_EQ(split.range[0].count, 9u);

    const PackedSurface plain(leaves.View());
    EXPECT_EQ(plain.corner, same.corner);
    EXPECT_TRUE(plain.wedge.empty());
    look.place[12] = look.place[14] = std::numeric_limits<float>::quiet_NaN(); // whatever is there
    EXPECT_EQ(PackedSurface(leaves.View(), look, {}).slot, split.slot);
}

TEST(SurfaceLook, SplitsVerticesBetweenColorsOfFaces) {
    const Leaves leaves;
    SurfaceLook look;
    look.faceColor = {{1, 2, 3, 4}, {9, 9, 9, 9}, {1, 2, 3, 4}, {1, 2, 3, 5}};
    const PackedSurface split(leaves.View(), look, {});
    EXPECT_EQ(split.slot, (Numbers{0, 2, 3, 4, 5, 3, 2}));
    EXPECT_EQ(split.corner, (Numbers{0, 1, 2, 1, 3, 2, 5, 6, 4}));
    look.color.resize(6); // wins over faceColor
    EXPECT_EQ(PackedSurface(leaves.View(), look, {}).slot, (Numbers{0, 2, 3, 4, 5}));
    EXPECT_TRUE(look.HasColors());
}

TEST(SurfaceLook, BringsTrianglesOfATextureTogether) {
    const Leaves leaves;
    SurfaceLook look;
    look.place.assign(24, 0);
    look.image = {{"a.png", "\x89PNG\r\n\x1A\n and more"}, {"b", ""}};
    EXPECT_EQ(look.TextureOf(3), 0); // the default for all faces
    look.texture = {1, 7, -3, 0};
    EXPECT_EQ(look.TextureOf(1), SurfaceLook::plain);
    const PackedSurface packed(leaves.View(), look, {});
    ASSERT_EQ(packed.range.size(), 3u);
    EXPECT_EQ(packed.corner, (Numbers{1, 3, 2, 2, 1, 4, 0, 1, 2}));
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(packed.range[i].texture, std::int32_t(i) - 1);
        EXPECT_EQ(packed.range[i].first, 3 * i);
        EXPECT_EQ(packed.range[i].count, 3u);
    }
    EXPECT_TRUE(look.IsShown(0));
    EXPECT_FALSE(look.IsShown(1)); // its file is missing
    EXPECT_FALSE(look.IsShown(SurfaceLook::plain));
    look.place.clear();
    EXPECT_EQ(look.TextureOf(0), SurfaceLook::plain); // no texture coordinates
    EXPECT_FALSE(look.HasColors());
}

TEST(PackedSurface, CanBeCancelled) {
    const Leaves leaves;
    SurfaceLook look;
    look.place.assign(24, 0);
    static int left; // times that it may ask and goes on
    const auto pack = [&](int times) {
        left = times;
        return PackedSurface(leaves.View(), look, Progress(+[](const int, const char *) { return left-- > 0; }));
    };
    EXPECT_EQ(pack(1000).slot.size(), 5u);
    const int asked = 1000 - left;
    EXPECT_GE(asked, 4);
    for (int i = 0; i < asked; ++i)
        EXPECT_THROW(pack(i), Cancelled) << i;
}

TEST(TextureImage, IsKnownByItsContent) {
    EXPECT_STREQ((TextureImage{"a.jpg", "\x89PNG\r\n\x1A\n"}).Kind(), "image/png");
    EXPECT_STREQ((TextureImage{"a.png", "\xFF\xD8\xFF\xE0"}).Kind(), "image/jpeg");
    for (const char *other : {"", "\x89PNG", "\xFF\xD8", "BM", "GIF89a"})
        EXPECT_EQ((TextureImage{"a.png", other}).Kind(), nullptr) << other;
}
