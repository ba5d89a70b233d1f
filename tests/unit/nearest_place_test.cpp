// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/surface/nearest_place.h>
#include "test_support.h"

using namespace vcg::fcd;
using namespace fcd_test;
using Eigen::Vector3d;

static Vector3d PointAt(const SurfacePlace &place, const Eigen::Matrix3Xd &position) {
    Vector3d p = Vector3d::Zero();
    for (int k = 0; k < place.count; ++k)
        p += place.weight[k] * position.col(place.slot[k]);
    return p;
}

static double SumOfWeights(const SurfacePlace &place) {
    return std::accumulate(place.weight.begin(), place.weight.begin() + place.count, 0.0);
}

/// Random triangles, with needles and points among them.
static std::vector<std::array<Index, 3>> Soup(Eigen::Matrix3Xd &position) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(-1, 1);
    position.resize(3, 600);
    for (Eigen::Index i = 0; i < position.cols(); ++i)
        position.col(i) << number(random), number(random), number(random);
    std::vector<std::array<Index, 3>> triangle;
    for (Index i = 0; i + 2 < 600; i += 3) {
        for (int k = 1; k < 3; ++k) // small ones
            position.col(i + k) = position.col(i) + 0.1 * position.col(i + k);
        if (i % 30 == 0)
            position.col(i + 2) = 0.5 * position.col(i) + 0.5 * position.col(i + 1);
        if (i % 90 == 0)
            position.col(i + 2) = position.col(i + 1) = Vector3d(position.col(i));
        triangle.push_back({i, i + 1, i + 2});
    }
    return triangle;
}

TEST(NearestPlace, OnTrianglesIsNoFartherThanAnyPointOfThem) {
    Eigen::Matrix3Xd position;
    const auto triangle = Soup(position);
    const NearestPlace nearest(position, triangle, {});
    std::mt19937 random(2);
    std::uniform_real_distribution<double> number(0, 1);
    for (int i = 0; i < 300; ++i) {
        const double far = i < 250 ? 2 : 1e6;
        const Vector3d p = far * (Vector3d(number(random), number(random), number(random)).array() - 0.5);
        const SurfacePlace place = nearest(p);
        ASSERT_GE(place.count, 1);
        ASSERT_NEAR(SumOfWeights(place), 1, 1e-12);
        const double distance = (PointAt(place, position) - p).norm();
        for (const auto &t : triangle) {
            double a = number(random), b = number(random);
            if (a + b > 1) {
                a = 1 - a;
                b = 1 - b;
            }
            const Vector3d other = (1 - a - b) * position.col(t[0]) + a * position.col(t[1]) + b * position.col(t[2]);
            ASSERT_LE(distance, (other - p).norm() * (1 + 1e-12) + 1e-12);
            for (Index corner : t)
                ASSERT_LE(distance, (position.col(corner) - p).norm() * (1 + 1e-12));
        }
    }
}

TEST(NearestPlace, IsTheSameAtAnySize) {
    Eigen::Matrix3Xd position;
    const auto triangle = Soup(position);
    const NearestPlace nearest(position, triangle, {});
    for (const int power : {-480, -300, -200, 200, 330}) { // from 1e-145 to 1e99
        const double scale = std::ldexp(1.0, power);
        const Eigen::Matrix3Xd scaled = scale * position;
        const NearestPlace there(scaled, triangle, {});
        std::mt19937 random(3);
        std::uniform_real_distribution<double> number(-1, 1);
        for (int i = 0; i < 300; ++i) {
            const double far = i < 200 ? 1 : i < 250 ? 1e-3 : 1e3;
            const Vector3d p = far * Vector3d(number(random), number(random), number(random));
            const SurfacePlace one = nearest(p), other = there(scale * p);
            ASSERT_EQ(one.count, other.count) << power;
            for (int k = 0; k < one.count; ++k) {
                ASSERT_EQ(one.slot[k], other.slot[k]) << power;
                ASSERT_EQ(one.weight[k], other.weight[k]) << power; // to the bit: the scale is a power of two
            }
        }
    }
}

TEST(NearestPlace, IsOnTheFirstOfTheNearestTriangles) {
    for (const double scale : {1.0, 1e-60, 1e60}) {
        Eigen::Matrix3Xd position;
        auto triangle = Soup(position);
        for (std::size_t t = 0; t + 1 < triangle.size();
             t += 20) // edges and vertices that several have, and faces twice
            triangle[t + 1] =
                t % 40 == 0 ? triangle[t] : std::array<Index, 3>{triangle[t][2], triangle[t][0], Index(t)};
        position *= scale;
        position.row(0).array() += scale < 1 ? 0 : 1e3 * scale; // single precision cannot resolve less
        std::vector<std::unique_ptr<NearestPlace>> alone;
        for (const auto &each : triangle)
            alone.push_back(
                std::make_unique<NearestPlace>(position, std::vector<std::array<Index, 3>>{each}, std::vector<char>()));
        const NearestPlace nearest(position, triangle, {});
        std::mt19937 random(4);
        std::uniform_real_distribution<double> number(-1.5, 1.5);
        for (int i = 0; i < 400; ++i) {
            const Vector3d some(number(random), number(random), number(random));
            const Index corner = triangle[std::size_t(i) % triangle.size()][0];
            const Vector3d p = i % 4 == 3 ? Vector3d(position.col(corner))
                                          : Vector3d(position.col(0) + (i % 4 == 2 ? 1e5 : 1.0) * scale * some);
            NearestPlace::Hint best;
            double least = std::numeric_limits<double>::infinity();
            for (std::size_t t = 0; t < triangle.size(); ++t) {
                SurfacePlace place = (*alone[t])(p);
                const double square = (PointAt(place, position) - p).squaredNorm();
                if (square < least) {
                    least = square;
                    best.triangle = Index(t);
                }
            }
            NearestPlace::Hint found;
            const SurfacePlace place = nearest(p, found);
            const double square = (PointAt(place, position) - p).squaredNorm();
            ASSERT_LE(square, least * (1 + 1e-9)) << i << " at " << scale;
            if (i % 4 == 3 || triangle[std::size_t(found.triangle)] == triangle[std::size_t(best.triangle)]) {
                ASSERT_EQ(found.triangle, best.triangle) << i << " at " << scale;
            }
        }
    }
}

TEST(NearestPlace, AHintChangesNoBit) {
    Eigen::Matrix3Xd position;
    const auto triangle = Soup(position);
    const NearestPlace nearest(position, triangle, {});
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1.5, 1.5);
    NearestPlace::Hint last;
    Vector3d p = Vector3d::Zero();
    for (int i = 0; i < 5000; ++i) {
        // Far from the last point, near to it, at a vertex, and at a vertex of the hint's triangle.
        const Vector3d other(number(random), number(random), number(random));
        const Index corner = i % 4 == 2 ? Index(i) % 600 : triangle[std::size_t(std::max(0, last.triangle))][i % 3];
        p = i % 4 == 0 ? other : i % 4 == 1 ? Vector3d(p + 1e-3 * other) : Vector3d(position.col(corner));
        const SurfacePlace alone = nearest(p), hinted = nearest(p, last);
        ASSERT_EQ(hinted.count, alone.count);
        for (int k = 0; k < alone.count; ++k) {
            ASSERT_EQ(hinted.slot[k], alone.slot[k]);
            ASSERT_EQ(hinted.weight[k], alone.weight[k]);
        }
        ASSERT_GE(last.triangle, 0);
    }
}

TEST(NearestPlace, AHintChangesNoEndOfVertices) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> number(-1, 1);
    Eigen::Matrix3Xd position(3, 600); // a square; 30 of them beside it, where no plane is
    for (Eigen::Index i = 0; i < position.cols(); ++i)
        position.col(i) << number(random), number(random), i < 30 ? 2 + number(random) : 0;
    const NearestPlace nearest(position, {}, std::vector<char>(600, 1));
    std::vector<NearestPlace::Hint> hint(100);
    std::vector<Vector3d> at(hint.size());
    for (Vector3d &p : at)
        p << 1.5 * number(random), 1.5 * number(random), 0.3 + number(random);
    int ends = 0, same = 0;
    for (int step = 0; step < 40; ++step)
        for (std::size_t i = 0; i < at.size(); ++i) {
            const Index before = hint[i].around.slot;
            at[i] += 0.01 * Vector3d(number(random), number(random), number(random));
            NearestPlace::Hint none;
            const SurfacePlace place = nearest(at[i], hint[i]), alone = nearest(at[i], none);
            const bool isEnd = nearest.EndsBefore(at[i], alone, none);
            ASSERT_EQ(nearest.EndsBefore(at[i], place, hint[i]), isEnd);
            ends += isEnd;
            same += hint[i].around.slot == before;
        }
    EXPECT_GT(ends, 1000);
    EXPECT_LT(ends, 3000);
    EXPECT_GT(same, 2000);
    EXPECT_LT(same, 3900);
}

TEST(NearestPlace, IsTheVertexAtAVertex) {
    Eigen::Matrix3Xd position;
    const auto triangle = Soup(position);
    const NearestPlace onTriangles(position, triangle, {});
    const NearestPlace amongVertices(position, {}, std::vector<char>(600, 1));
    for (Eigen::Index i = 0; i < position.cols(); i += 7)
        for (const NearestPlace *nearest : {&onTriangles, &amongVertices})
            EXPECT_LE((PointAt((*nearest)(position.col(i)), position) - position.col(i)).norm(), 1e-9);
}

TEST(NearestPlace, AmongVerticesChangesContinuously) {
    Eigen::Matrix3Xd position;
    Soup(position);
    std::vector<char> counts(600, 1);
    for (int i = 0; i < 600; i += 3)
        counts[i] = 0;
    const NearestPlace nearest(position, {}, counts);
    const Vector3d begin(-1, -0.3, 0.2), end(1, 0.4, -0.1);
    double greatest = 0;
    Vector3d last = PointAt(nearest(begin), position);
    const int steps = 20000;
    for (int i = 1; i <= steps; ++i) {
        const SurfacePlace place = nearest(begin + (end - begin) * i / steps);
        ASSERT_NEAR(SumOfWeights(place), 1, 1e-12);
        for (int k = 0; k < place.count; ++k)
            ASSERT_NE(place.slot[k] % 3, 0) << "does not count";
        const Vector3d here = PointAt(place, position);
        greatest = std::max(greatest, (here - last).norm());
        last = here;
    }
    EXPECT_LE(greatest, 0.01); // a jump from one vertex to the next would be 0.1 or more
}

TEST(NearestPlace, AmongVerticesIsOfTheNearestOfAll) {
    Eigen::Matrix3Xd position;
    Soup(position);
    std::vector<char> counts(600, 1);
    for (std::size_t i = 0; i < counts.size(); i += 3)
        counts[i] = 0;
    const NearestPlace nearest(position, {}, counts);
    std::mt19937 random(6);
    std::uniform_real_distribution<double> number(-1.5, 1.5);
    NearestPlace::Hint last;
    for (int i = 0; i < 2000; ++i) {
        const Vector3d p = (i % 5 == 4 ? 1e4 : 1.0) * Vector3d(number(random), number(random), number(random));
        std::vector<std::pair<double, Index>> all;
        for (Index v = 0; v < 600; ++v)
            if (counts[v] && v % 90 != 2) // those coincide with the one before
                all.emplace_back((position.col(v) - p).norm(), v);
        std::sort(all.begin(), all.end());
        const SurfacePlace place = nearest(p), hinted = nearest(p, last);
        ASSERT_EQ(hinted.count, place.count);
        double sum = 0;
        for (int k = 0; k < place.count; ++k)
            sum += std::pow(all[SurfacePlace::most].first / all[k].first - 1, 2);
        for (int k = 0; k < place.count; ++k) {
            ASSERT_EQ(hinted.slot[k], place.slot[k]);
            ASSERT_EQ(hinted.weight[k], place.weight[k]);
            if (i % 5 != 4) { // from afar, rounding decides
                ASSERT_EQ(place.slot[k], all[k].second) << i;
                ASSERT_NEAR(place.weight[k], std::pow(all[SurfacePlace::most].first / all[k].first - 1, 2) / sum, 1e-9);
            }
        }
        ASSERT_GE(place.count, 1);
        for (int k = place.count; i % 5 != 4 && k < SurfacePlace::most; ++k)
            ASSERT_EQ(all[k].first, all[SurfacePlace::most].first) << i;
    }
}

TEST(NearestPlace, FindsTheOnlyVertexAndTheOnlyTriangle) {
    Eigen::Matrix3Xd position(3, 3);
    position << 0, 1, 0, 0, 0, 1, 0, 0, 0;
    const SurfacePlace vertex = NearestPlace(position, {}, {0, 1, 0})(Vector3d(5, 5, 5));
    EXPECT_EQ(vertex.count, 1);
    EXPECT_EQ(vertex.slot[0], 1);
    const SurfacePlace onFace = NearestPlace(position, {{{0, 1, 2}}}, {})(Vector3d(0.25, 0.25, 9));
    EXPECT_LE((PointAt(onFace, position) - Vector3d(0.25, 0.25, 0)).norm(), 1e-15);
}

/// A wavy sheet, and triangles as large as it, at a distance in diagonals.
static std::vector<std::array<Index, 3>> SheetWithStrays(int n, const std::vector<Vector3d> &strays,
                                                         Eigen::Matrix3Xd &position) {
    const Shape sheet = Jittered(Grid(n, n, 1.0 / n), 0.2 / n);
    position.resize(3, sheet.Size() + 3 * Index(strays.size()));
    std::vector<std::array<Index, 3>> triangle;
    for (int i = 0; i < sheet.Size(); ++i)
        position.col(i) = sheet.position[std::size_t(i)] + Vector3d(0, 0, 0.1 * std::sin(9 * sheet.position[i][0]));
    for (const auto &f : sheet.face)
        triangle.push_back({f[0], f[1], f[2]});
    for (std::size_t s = 0; s < strays.size(); ++s) {
        const Index first = sheet.Size() + 3 * Index(s);
        for (Index k = 0; k < 3; ++k)
            position.col(first + k) = strays[s] + Vector3d::Unit(k) / n;
        triangle.insert(triangle.begin() + std::ptrdiff_t(s * triangle.size() / strays.size()),
                        {first, first + 1, first + 2});
    }
    return triangle;
}

TEST(NearestPlace, AFewTrianglesFarAwayChangeNoBitAndTakeHardlyAnyTime) {
    const int n = sanitized ? 60 : 150;
    Eigen::Matrix3Xd alone;
    const NearestPlace without(alone, SheetWithStrays(n, {}, alone), {});
    std::mt19937 random(3);
    std::vector<std::vector<Vector3d>> cases;
    for (const double far : {1e3, 1e6, 1e9, 1e15})
        cases.push_back({Vector3d(far, 0, 0)});
    cases.push_back({{1e6, 0, 0}, {0, -1e3, 0}, {1e9, 1e9, 0}, {0, 0, 1e12}});
    cases.emplace_back();
    for (int i = 0; i < 200; ++i)
        cases.back().push_back(std::pow(10.0, 3 + i % 7) * RandomVector(random));
    std::vector<Vector3d> asked;
    for (int i = 0; i < 2000; ++i)
        asked.push_back(alone.col(Eigen::Index(random() % std::size_t(alone.cols()))) + 0.02 * RandomVector(random));
    const auto seconds = [&](const NearestPlace &nearest) {
        double least = 1e9;
        for (int again = 0; again < 3; ++again) {
            const Stopwatch watch;
            for (const Vector3d &p : asked)
                nearest(p);
            least = std::min(least, watch.Seconds());
        }
        return least;
    };
    const double expected = seconds(without);
    for (const std::vector<Vector3d> &strays : cases) {
        Eigen::Matrix3Xd position;
        const auto triangle = SheetWithStrays(n, strays, position);
        const NearestPlace nearest(position, triangle, {}, Threads(3));
        for (const Vector3d &p : asked) {
            const SurfacePlace place = nearest(p), same = without(p);
            ASSERT_EQ(place.count, same.count);
            for (int k = 0; k < place.count; ++k) {
                ASSERT_EQ(place.slot[k], same.slot[k]);
                ASSERT_EQ(place.weight[k], same.weight[k]);
            }
        }
        for (std::size_t s = 0; s < strays.size(); s += 7) // and they are found themselves
            EXPECT_GE(nearest(strays[s]).slot[0], alone.cols());
        EXPECT_LE(seconds(nearest), 20 * expected + 1e-3) << strays[0].norm();
    }
}

TEST(NearestPlace, OfPartsThatAreFarApartIsFoundInEach) {
    Eigen::Matrix3Xd one;
    const auto triangle = SheetWithStrays(sanitized ? 40 : 80, {}, one);
    const Index n = Index(one.cols()), parts = 3;
    Eigen::Matrix3Xd position(3, parts * n);
    std::vector<std::array<Index, 3>> all;
    for (Index part = 0; part < parts; ++part) { // of 1, 1e-4 and 1e-8 of the first one's size
        position.middleCols(part * n, n) = one * std::pow(1e-4, part);
        position.middleCols(part * n, n).row(0).array() += 1e7 * part;
        for (const auto &t : triangle)
            all.push_back({t[0] + part * n, t[1] + part * n, t[2] + part * n});
    }
    const NearestPlace nearest(position, all, {});
    for (Index i = 0; i < position.cols(); i += 11)
        EXPECT_LE((PointAt(nearest(position.col(i)), position) - position.col(i)).norm(),
                  1e-9 * position.col(i).norm());
}

TEST(NearestPlace, CanBeCancelledWhileItIsPrepared) {
    Eigen::Matrix3Xd position;
    const auto triangle = SheetWithStrays(100, {}, position);
    for (unsigned threads : {1u, 3u}) {
        CallbackLog all;
        const NearestPlace nearest(position, triangle, {}, all.Progress(threads));
        ASSERT_GT(all.percent.size(), 3u);
        for (std::size_t i = 0; i < (threads == 1 ? all.percent.size() : 3); ++i) {
            CallbackLog log(i);
            EXPECT_THROW(NearestPlace(position, triangle, {}, log.Progress(threads)), Cancelled) << i;
        }
    }
}

/// Two facing walls of triangles with edges of up to root 2.
struct Walls {
    Shape shape;
    Index half;
    Eigen::Matrix3Xd position;
    std::unique_ptr<NearestPlace> nearest;

    explicit Walls(double gap) : shape(Join(Grid(11, 11), Grid(11, 11, 1, gap))), half(shape.Size() / 2) {
        position.resize(3, shape.Size());
        for (int i = 0; i < shape.Size(); ++i)
            position.col(i) = shape.position[std::size_t(i)];
        std::vector<std::array<Index, 3>> triangle;
        for (const auto &f : shape.face)
            triangle.push_back(f[0] < half ? std::array<Index, 3>{f[0], f[1], f[2]}
                                           : std::array<Index, 3>{f[0], f[2], f[1]});
        nearest = std::make_unique<NearestPlace>(position, triangle, std::vector<char>());
    }
    bool IsLow(double z, const Vector3d &normal) const {
        NearestPlace::Hint hint;
        return (*nearest)(Vector3d(4.3, 5.2, z), hint, normal).slot[0] < half;
    }
    int Sides(const Vector3d &low, const Vector3d &high) const {
        return nearest->SidesTold(
            std::size_t(shape.Size()), [&](std::size_t i) { return Vector3d(position.col(Eigen::Index(i))); },
            [&](std::size_t i) { return Index(i) < half ? low : high; });
    }
};

TEST(NearestPlace, BindsToTheWallThatLooksTheSameWay) {
    const Vector3d up = Vector3d::UnitZ(), none = Vector3d::Zero();
    const Walls fold(0.1);
    for (const double z : {-0.4, 0.02, 0.04, 0.09, 0.3}) { // one of the walls is triangulated differently
        EXPECT_EQ(fold.IsLow(z, none), z < 0.05) << z;
        EXPECT_TRUE(fold.IsLow(z, up)) << z;
        EXPECT_FALSE(fold.IsLow(z, -up)) << z;
    }
    EXPECT_FALSE(Walls(2).IsLow(1.9, up)) << "what is farther away than another triangulation leads is another thing";
    EXPECT_EQ(fold.Sides(up, -up), 1);
    EXPECT_EQ(fold.Sides(-up, up), -1);
    EXPECT_EQ(fold.Sides(up, up), 0);
    EXPECT_EQ(fold.Sides(none, none), 0);
    EXPECT_EQ(fold.Sides(up, none), 1);
}

TEST(NearestPlace, VerticesAtOnePlaceCountAsOne) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1, 1);
    Eigen::Matrix3Xd once(3, 400);
    for (Eigen::Index i = 0; i < once.cols(); ++i)
        once.col(i) << number(random), number(random), number(random);
    const NearestPlace alone(once, {}, std::vector<char>(400, 1));
    for (const Index times : {2, 6, 15, 1000}) {
        Eigen::Matrix3Xd position(3, 400 * times); // copies of one triangle are apart in memory, as in joined scans
        for (Index k = 0; k < times; ++k)
            position.middleCols(400 * k, 400) = once;
        const NearestPlace nearest(position, {}, std::vector<char>(std::size_t(400 * times), 1));
        for (int i = 0; i < 30; ++i) {
            const Vector3d p(number(random), number(random), number(random));
            const SurfacePlace expected = alone(p), place = nearest(p);
            if (times > 144) { // so many are looked at
                EXPECT_EQ(place.count, 1);
                EXPECT_EQ(place.weight[0], 1);
                continue;
            }
            ASSERT_EQ(place.count, expected.count) << times;
            for (int k = 0; k < place.count; ++k) {
                EXPECT_EQ(place.slot[k], expected.slot[k]);
                EXPECT_EQ(place.weight[k], expected.weight[k]);
            }
        }
    }
}
