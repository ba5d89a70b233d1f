// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/candidates_beside.h>
#include <vcg_ext/surface/free_region.h>
#include <vcg_ext/surface/point_cloud.h>
#include "test_support.h"

#include <random>

using namespace vcg::fcd;
using namespace fcd_test;

TEST(FreeRegion, IsWhatIsFreeAndWhatIsHeldBesideIt) {
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
            const Region region = FreeRegion(Read(mesh), tag);
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

TEST(FreeRegion, LeavesOutWhatIsNoVertex) {
    const Shape shape = TwoSheets(6, 1);
    std::vector<int> tag(72, 1);
    std::fill(tag.begin() + 36, tag.end(), noVertex);
    for (const Shape &s : {shape, Points(shape)}) {
        const Region region = FreeRegion(Read(MeshD(s)), tag);
        for (int i = 0; i < 72; ++i)
            EXPECT_EQ(region.flag[i], i < 36 ? Region::part : Region::none);
    }
}

TEST(FreeRegion, OfACloudHasTheNearestOfTheFree) {
    const Shape shape = PointCloud(400);
    const std::vector<int> tag = TagsOf(shape, [](const Eigen::Vector3d &p) {
        return p[0] < 0.6 ? 0 : p[0] < 0.8 ? 1 : 2;
    });
    const Region region = FreeRegion(Read(MeshD(shape)), tag);
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

TEST(FreeRegion, OfAPartOfACloudTellsHowFarPointsCount) {
    const Shape cloud = Points(Jittered(Grid(60, 60), 0.2)); // one apart
    const auto tagOf = [](const Eigen::Vector3d &p) { return (p - Eigen::Vector3d(30, 30, 0)).norm() < 4 ? 1 : 0; };
    vcg::fcd::CloudPart of;
    for (const Eigen::Vector3d &p : cloud.position)
        of.places.extend(p);
    const auto regionOf = [&](double around, double reach) {
        Shape part;
        for (const Eigen::Vector3d &p : cloud.position)
            if ((p - Eigen::Vector3d(30, 30, 0)).norm() < 4 + around)
                part.position.push_back(p);
        of.reach = reach;
        return FreeRegion(Read(MeshD(part)), TagsOf(part, tagOf), Eigen::Matrix3d::Identity(), {}, of);
    };
    const auto partsOf = [](const Region &region) {
        return std::count(region.flag.begin(), region.flag.end(), (unsigned char)(Region::part));
    };
    const Region all = regionOf(INFINITY, INFINITY);
    EXPECT_GT(all.reach, 7); // 193 points of a sheet are in a disc of this radius
    EXPECT_LT(all.reach, 12);
    const Region enough = regionOf(all.reach + 1, all.reach);
    EXPECT_EQ(partsOf(enough), partsOf(all));
    EXPECT_LT(enough.flag.size(), all.flag.size());
    const Region few = regionOf(3, 3);
    EXPECT_GT(few.reach, 3);
    EXPECT_LT(partsOf(few), partsOf(all)) << "none is looked for";
}

TEST(FreeRegion, OfALargeCloudLooksAroundWhereverSomethingIsHeld) {
    // A held band, another one within the free region, and a few isolated held points: skipping what is far from them
    // changes nothing.
    std::mt19937 random(4);
    std::uniform_real_distribution<double> jitter(-0.3, 0.3); // points stay apart
    for (int lines : {140, 33}) {                             // with few, more than the nearest are examined
        const int n = sanitized ? 10000 : 20000, each = n / lines;
        Shape cloud;
        std::vector<int> tag;
        for (int i = 0; i < each * lines; ++i) {
            const double x = (i % each + jitter(random)) / each;
            cloud.position.emplace_back(x, double(i / each) / lines, 0.1 * std::sin(9 * x));
            tag.push_back(x < 0.2 || (x > 0.5 && x < 0.52) ? 0 : i % 4000 == 0 ? 2 : 1);
        }
        const Region region = FreeRegion(Read(MeshD(cloud)), tag);
        const Eigen::Map<const Eigen::Matrix3Xd> position(cloud.position[0].data(), 3, cloud.Size());
        const PointTree<double> blocks(position, 1);
        vcg::fcd::detail::CloudNeighbourhood<double> neighbourhood(blocks);
        std::vector<unsigned char> expected(tag.size(), Region::candidate);
        for (std::size_t at = 0; at < tag.size(); ++at) {
            const auto i = std::size_t(blocks.Number(at));
            if (tag[i] != 1)
                continue;
            expected[i] = Region::part;
            neighbourhood.Look(at);
            for (Index j : neighbourhood.around)
                expected[std::size_t(j)] = Region::part;
        }
        EXPECT_EQ(region.flag, expected);
        EXPECT_GT(std::count(expected.begin(), expected.end(), (unsigned char)(Region::candidate)), 1000);
    }
}

TEST(FreeRegion, OfACloudHasTheNearestPlacesHoweverManyPointsAreThere) {
    const Shape once = Points(Jittered(Grid(20, 20), 0.2));
    const auto tagsOf = [](const Shape &shape) {
        return TagsOf(shape, [](const Eigen::Vector3d &p) { return p[0] < 8 ? 0 : p[0] < 12 ? 1 : 2; });
    };
    const Region region = FreeRegion(Read(MeshD(once)), tagsOf(once));
    for (double jitter : {0.0, 1e-6})
        for (int times : {2, 30}) {
            std::mt19937 random(1);
            Shape many;
            for (int i = 0; i < times * once.Size(); ++i)
                many.position.push_back(once.position[i / times] + (i % times ? jitter : 0) * RandomVector(random));
            const Region more = FreeRegion(Read(MeshD(many)), tagsOf(many));
            int parts = 0, missed = 0; // few: a cell's border may lie between nearly equal points
            for (int i = 0; i < many.Size(); ++i)
                if (region.flag[i / times] == Region::part) {
                    ++parts;
                    missed += more.flag[i] != Region::part;
                }
            EXPECT_LE(missed, jitter > 0 ? parts / 20 : 0) << times << " times, jitter " << jitter;
        }
}

TEST(FreeRegion, OfACloudIsTheSameWithAPointFarAway) {
    const int n = sanitized ? 60 : 200;
    const Shape cloud = Points(Jittered(Grid(n, n), 0.3));
    std::vector<int> tag = TagsOf(cloud, [&](const Eigen::Vector3d &p) { return p[0] < 0.3 * n ? 0 : 1; });
    const auto seconds = [&](const Shape &shape, Region &region) {
        const Stopwatch watch;
        region = FreeRegion(Read(MeshD(shape)), tag);
        return watch.Seconds();
    };
    Region alone, with;
    const double expected = seconds(cloud, alone);
    for (const int ofStray : {0, 1})
        for (const double far : {1e3, 1e6, 1e9}) {
            Shape more = cloud;
            tag.resize(std::size_t(cloud.Size()));
            for (int k = 0; k < 3; ++k) {
                more.position.push_back(far * n * (Eigen::Vector3d::Unit(k) + Eigen::Vector3d(0.1, 0.2, 0.3)));
                tag.push_back(ofStray);
            }
            EXPECT_LE(seconds(more, with), 20 * expected + 0.05) << far;
            std::size_t missed = 0, beyond = 0;
            for (std::size_t i = 0; i < std::size_t(cloud.Size()); ++i) {
                missed += alone.flag[i] == Region::part && with.flag[i] != Region::part;
                beyond += alone.flag[i] != Region::part && with.flag[i] == Region::part;
            }
            EXPECT_EQ(missed, 0u) << far;
            EXPECT_LE(beyond, ofStray == 1 ? 300u : 0u) << far; // the neighbours of the far ones
        }
}

TEST(CandidatesBeside, AreThoseInACellOfAPart) {
    const float hair = 1e-5f;
    for (unsigned seed = 0; seed < 8; ++seed) {
        std::mt19937 random(seed);
        const auto number = [&](double low, double high) {
            return low + (high - low) * double(random()) / double(std::mt19937::max());
        };
        const bool fewParts = seed & 1, isFlat = seed & 2;
        std::vector<Eigen::Vector3d> point;
        Region region;
        const auto add = [&](const Eigen::Vector3d &p, unsigned char flag) {
            point.push_back(isFlat ? Eigen::Vector3d(p[0], p[1], 0.25) : p);
            region.flag.push_back(flag);
        };
        for (int i = 0; i < 20000; ++i) {
            const Eigen::Vector3d p(number(-0.5, 0.5), number(-0.5, 0.5), number(-0.5, 0.5));
            const bool isFew = i % 50 == 0;
            add(p, seed & 4 && i % 7 == 0 ? Region::none : isFew == fewParts ? Region::part : Region::candidate);
            if (isFew) { // and one of the others near it
                const double away = hair * std::vector<double>{0, 0.5, 0.99, 1.5, 20, 50}[std::size_t(i / 50 % 6)];
                add(p + away * Eigen::Vector3d(number(-1, 1), number(-1, 1), number(-1, 1)),
                    fewParts ? Region::candidate : Region::part);
            }
        }
        if (seed & 4) {
            add({40, -30, 20}, Region::part);
        } else { // the box of the parts is known, and pairs lie at the borders of a grid of it
            add({-0.5, -0.5, -0.5}, Region::part);
            add({0.5, 0.5, 0.5}, Region::part);
            const double reach = 41 * hair + 0.5e-6, width = (1 + 2 * reach) / 64;
            for (int i = 1; i < 64; ++i) {
                const Eigen::Vector3d p = Eigen::Vector3d::Constant(i * width - 0.5 - reach);
                add(p + Eigen::Vector3d(-0.4, -0.4, -0.4) * hair, Region::part);
                add(p + Eigen::Vector3d(0.4, 0.4, 0.4) * hair, Region::candidate);
                add(p + Eigen::Vector3d(0.4, -0.5, 0.4) * hair, Region::candidate);
            }
        }
        add({1e6, 0, 0}, Region::candidate);
        const auto inFrame = [](const Eigen::Vector3d &p) { return Eigen::Vector3f(p.cast<float>()); };
        const auto at = [&](std::size_t i) { return inFrame(point[i]); };
        region.box.resize(point.size() / Region::boxed + 1);
        Eigen::AlignedBox3f box;
        std::set<std::uint64_t> cells;
        for (std::size_t i = 0; i < point.size(); ++i) {
            region.box[i / Region::boxed].extend(point[i]);
            if (region.flag[i] == Region::part) {
                box.extend(at(i));
                detail::ForCells(at(i), 0.05f / hair, hair, [&](std::uint64_t cell) { cells.insert(cell); });
            }
        }
        std::vector<std::uint32_t> expected;
        for (std::size_t i = 0; i < point.size(); ++i)
            if (region.flag[i] == Region::candidate)
                detail::ForCells(at(i), 0.05f / hair, 0, [&](std::uint64_t cell) {
                    if (cells.count(cell))
                        expected.push_back(std::uint32_t(i));
                });
        const auto count = [&](unsigned char flag) {
            return std::size_t(std::count(region.flag.begin(), region.flag.end(), flag));
        };
        EXPECT_GT(expected.size(), 200u);
        for (unsigned threads : {1u, 2u})
            EXPECT_EQ(detail::CandidatesBeside(region, count(Region::part), count(Region::candidate), at, inFrame, box,
                                               hair, Threads(threads)),
                      expected)
                << seed;
    }
}
