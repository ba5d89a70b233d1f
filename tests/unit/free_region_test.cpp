// SPDX-License-Identifier: GPL-3.0-or-later
#include "free_region.h"
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;

TEST(FreeRegion, IsWhatIsFreeAndWhatIsHeldBesideIt) {
    using vcg::tri::Region;
    for (bool wires : {false, true})
        for (unsigned seed = 0; seed < 5; ++seed) {
            Shape shape = wires ? Wireframe(20, 15) : Grid(20, 15);
            shape.position.insert(shape.position.end(), 3, Eigen::Vector3d(50, 50, 0)); // isolated
            std::vector<int> tag;
            for (Index t : RandomGroups(shape.Size() - 3, 12, seed))
                tag.push_back(seed ? (t > 3 ? 0 : int(t)) : -1);
            if (!seed)
                std::fill(tag.begin(), tag.begin() + 100, 1);
            tag.insert(tag.end(), {0, 1, 2});
            MeshD mesh(shape);
            mesh.DeleteVertex(7);
            const Region region = vcg::tri::FreeRegion(mesh, tag, {});
            std::vector<unsigned char> expected;
            for (int t : tag)
                expected.push_back(t == 1 ? Region::none : Region::candidate);
            const auto join = [&](const auto &corners) {
                bool any = false, all = true;
                for (int c : corners) {
                    any |= tag[c] == 1;
                    all &= c != 7;
                }
                for (int c : corners)
                    if (any && all)
                        expected[c] = Region::part;
            };
            for (const auto &f : shape.face)
                join(f);
            for (const auto &e : shape.edge)
                join(e);
            expected[7] = Region::none;
            EXPECT_EQ(region.flag, expected);
        }
}

TEST(FreeRegion, LeavesOutWhatIsExcluded) {
    using vcg::tri::Region;
    const Shape shape = TwoSheets(6, 1);
    std::vector<int> tag(72, 1);
    std::vector<char> excluded(72, 0);
    std::fill(excluded.begin() + 36, excluded.end(), 1);
    for (const Shape &s : {shape, Points(shape)}) {
        const Region region = vcg::tri::FreeRegion(MeshD(s), tag, excluded);
        for (int i = 0; i < 72; ++i)
            EXPECT_EQ(region.flag[i], i < 36 ? Region::part : Region::none);
    }
}

TEST(FreeRegion, OfACloudHasTheNearestOfTheFree) {
    using vcg::tri::Region;
    const Shape shape = PointCloud(400);
    const std::vector<int> tag = TagsOf(shape, [](const Eigen::Vector3d &p) {
        return p[0] < 0.6 ? 0 : p[0] < 0.8 ? 1 : 2;
    });
    const Region region = vcg::tri::FreeRegion(MeshD(shape), tag, {});
    std::vector<unsigned char> expected;
    for (int t : tag)
        expected.push_back(t == 1 ? Region::part : Region::candidate);
    for (int i = 0; i < shape.Size(); ++i) {
        if (tag[i] != 1)
            continue;
        std::vector<std::pair<double, int>> others;
        for (int j = 0; j < shape.Size(); ++j)
            if (j != i)
                others.emplace_back((shape.position[i] - shape.position[j]).norm(), j);
        std::sort(others.begin(), others.end());
        for (int j = 0; j < vcg::fcd::detail::cloudNeighbours; ++j)
            expected[others[j].second] = Region::part;
    }
    EXPECT_EQ(region.flag, expected);
}
