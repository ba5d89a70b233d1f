// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/nearest_others.h>
#include <vcg_ext/surface/cloud_neighbourhood.h>
#include "test_support.h"

#include <random>
#include <set>

using namespace vcg::fcd;
using namespace fcd_test;

namespace {

/// A grid with equal distances, noise around it, and strays far away.
template <class Scalar>
Eigen::Matrix<Scalar, 3, Eigen::Dynamic> SheetInNoise(int grid, int noise, int strays, unsigned seed) {
    std::mt19937 random(seed);
    Eigen::Matrix<Scalar, 3, Eigen::Dynamic> points(3, grid * grid + noise + strays);
    int at = 0;
    for (int i = 0; i < grid * grid; ++i)
        points.col(at++) << Scalar(i / grid) / Scalar(grid), Scalar(i % grid) / Scalar(grid), 0;
    for (int i = 0; i < noise + strays; ++i)
        points.col(at++) = ((i < noise ? 1 : 1e4) * RandomVector(random)).template cast<Scalar>();
    return points;
}

/// Compares all answers with a search of all points.
template <class Scalar>
void ExpectNearest(const Eigen::Matrix<Scalar, 3, Eigen::Dynamic> &points, std::size_t count) {
    using Neighbour = typename NearestOthers<Scalar>::Neighbour;
    const PointTree<Scalar> blocks(points, 3);
    NearestOthers<Scalar> nearest(blocks);
    std::vector<bool> isThere(blocks.Size(), false);
    for (std::size_t block = 0; block < blocks.Blocks(); ++block) {
        const std::size_t first = blocks.Begin(block), last = blocks.Begin(block + 1);
        nearest.Ask(first, last, count);
        ASSERT_EQ(nearest.Each(), std::min(count, blocks.Size() - 1));
        for (std::size_t at = first; at < last; ++at) {
            EXPECT_EQ(blocks.BlockOf(at), block);
            EXPECT_TRUE(nearest.Knows(at, count));
            const Index self = blocks.Number(at);
            isThere[std::size_t(self)] = true;
            ASSERT_EQ(blocks.At(at), points.col(self));
            std::vector<std::pair<Scalar, Index>> all;
            for (Index i = 0; i < Index(points.cols()); ++i)
                if (i != self) {
                    const Eigen::Matrix<Scalar, 3, 1> way = points.col(i) - points.col(self);
                    all.emplace_back(way[0] * way[0] + way[1] * way[1] + way[2] * way[2], i);
                }
            std::partial_sort(all.begin(), all.begin() + std::ptrdiff_t(nearest.Each()), all.end());
            for (std::size_t k = 0; k < nearest.Each(); ++k) {
                const Neighbour &found = nearest.Of(at)[k];
                ASSERT_EQ(found.square, all[k].first) << "point " << self << ", its " << k << "-th";
                ASSERT_EQ(found.point, all[k].second) << "of equally near ones, that of the smaller number";
                ASSERT_EQ(blocks.Number(std::size_t(found.at)), found.point);
            }
        }
    }
    EXPECT_EQ(std::count(isThere.begin(), isThere.end(), true), points.cols());
}

} // namespace

TEST(NearestOthers, AreThoseThatLookingAtAllFinds) {
    for (std::size_t count : {1, 12, 100}) {
        ExpectNearest(SheetInNoise<float>(20, 60, 3, 1),
                      count); // blocks whose points are far from each other ask one by one
        ExpectNearest(SheetInNoise<double>(20, 60, 3, 2), count);
        ExpectNearest(SheetInNoise<float>(0, 5, 0, 3), count); // fewer than asked for
        ExpectNearest(SheetInNoise<float>(0, 1, 0, 4), count); // none
    }
    ExpectNearest(SheetInNoise<float>(25, 0, 0, 5), 12);
    const Eigen::Matrix3Xf same = Eigen::Matrix3Xf::Constant(3, 200, 0.25f);
    ExpectNearest(same, 12);
}

TEST(NearestOthers, AnswerAloneAsInBlocks) {
    const Eigen::Matrix3Xf points = SheetInNoise<float>(30, 40, 2, 6);
    const PointTree<float> one(points, 1), three(points, 3);
    NearestOthers<float> block(one), alone(three);
    for (std::size_t b = 0; b < one.Blocks(); ++b) {
        block.Ask(one.Begin(b), one.Begin(b + 1), 12);
        for (std::size_t at = one.Begin(b); at < one.Begin(b + 1); ++at) {
            alone.Ask(at, at + 1, 12);
            for (std::size_t k = 0; k < 12; ++k)
                ASSERT_EQ(alone.Of(at)[k].point, block.Of(at)[k].point);
        }
    }
}

TEST(CloudNeighbourhood, LooksFartherExactlyWhereItsNearestLieAlongALine) {
    // Twelve points in an ellipsoid around one, flatter and narrower from each to the next, and an even ring far away.
    std::mt19937 random(8);
    constexpr int nearest = vcg::fcd::detail::cloudNeighbours, ring = 300;
    int along = 0;
    for (int i = 0; i < 3000; ++i) {
        Eigen::Matrix3Xf points(3, 1 + nearest + ring);
        points.col(0).setZero();
        Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
        for (int k = 1; k <= nearest; ++k) {
            Eigen::Vector3d way = RandomVector(random).cwiseProduct(Eigen::Vector3d(1, i / 3000.0, i % 100 / 100.0));
            points.col(k) = (0.1 * way).cast<float>();
            way = points.col(k).cast<double>();
            moments += way * way.transpose() / way.squaredNorm();
        }
        for (int k = 0; k < ring; ++k)
            points.col(1 + nearest + k) << float(std::cos(k)), float(std::sin(k)), 0;
        const PointTree<float> blocks(points, 1);
        vcg::fcd::detail::CloudNeighbourhood<float> neighbourhood(blocks);
        for (std::size_t at = 0; at < blocks.Size(); ++at)
            if (blocks.Number(at) == 0)
                neighbourhood.Look(at);
        const Eigen::Vector3d values = vcg::fcd::detail::SymmetricEigen(moments).values;
        EXPECT_EQ(neighbourhood.isWide, values[1] < 0.25 * values[2]) << values.transpose();
        along += neighbourhood.isWide;
    }
    EXPECT_GT(along, 300);
    EXPECT_LT(along, 2700);
}

TEST(CloudNeighbourhood, OfAPointIsTheSameWhateverIsAskedBefore) {
    // Lines far apart, lines of a sheet, a sheet, clumps: some look at 12 points, some at 48, some at 192.
    std::mt19937 random(10);
    Eigen::Matrix3Xf points(3, 500);
    for (int i = 0; i < points.cols(); ++i) {
        const float x = float(random() % 4096) / 4096, y = float(random() % 4096) / 4096;
        const float across[] = {float(i % 3), 0.02f * std::floor(50 * y), y, 1e-4f * y + float(i % 20)};
        points.col(i) = Eigen::Vector3f(x, across[i % 4], float(i % 4));
    }
    const PointTree<float> tree(points, 1);
    using Neighbourhood = vcg::fcd::detail::CloudNeighbourhood<float>;
    Neighbourhood inOrder(tree);
    std::set<std::size_t> looked;
    for (std::size_t at = 0; at < tree.Size(); ++at) {
        const bool far = at % 4 > 1;
        inOrder.Look(at);
        const std::vector<Index> neighbours = inOrder.Neighbours(far);
        looked.insert(inOrder.around.size());
        if (at % 2 == 0)
            continue;
        Neighbourhood alone(tree);
        alone.Look(at);
        ASSERT_EQ(inOrder.around, alone.around) << at;
        ASSERT_EQ(neighbours, alone.Neighbours(far)) << at;
        ASSERT_EQ(inOrder.here, alone.here) << at;
    }
    EXPECT_EQ(looked, (std::set<std::size_t>{12, 48, 192}));
}

TEST(PointTree, OfManyPointsAtOnePlaceFindsTheFirstWithoutLookingAtAll) {
    // A scanner's invalid points. Each search among them would look at all: 20 thousand times 200 thousand.
    constexpr Index many = 200000;
    Eigen::Matrix3Xd points(3, many + 100);
    points.leftCols(many).colwise() = Eigen::Vector3d(1, 2, 3);
    for (Index i = 0; i < 100; ++i)
        points.col(many + i) << i, i % 7, i % 3;
    const PointTree<double> tree(points, 2);
    std::vector<PointTree<double>::Neighbour> found;
    for (int i = 0; i < 20000; ++i) {
        tree.Nearest(Eigen::Vector3d(1, 2, 3 + i % 2), 10, found);
        ASSERT_EQ(found.size(), 10u);
        for (Index k = 0; k < 10; ++k)
            ASSERT_EQ(found[std::size_t(k)].point, k);
    }
}

TEST(SortDiffering, IsAsStdSort) {
    std::mt19937 random(9);
    for (int i = 0; i < 100; ++i) {
        std::vector<Index> from(12), to(12);
        for (int k = 0; k < 12; ++k)
            from[std::size_t(k)] = 12 * Index(random() % 1000) + k;
        std::shuffle(from.begin(), from.end(), random);
        vcg::fcd::detail::SortDiffering<12>(from.data(), to.data());
        std::sort(from.begin(), from.end());
        EXPECT_EQ(to, from);
    }
}
