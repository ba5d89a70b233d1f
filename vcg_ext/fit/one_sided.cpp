// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/fit/one_sided.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <utility>

namespace vcg::fcd {

namespace {

constexpr double most = 0.75; // half-way between full agreement and none, which is a half

/// The triangles at each node.
class Fans {
  public:
    Fans(std::size_t nodes, const std::vector<Corners> &triangle) : triangle(triangle), begin(nodes + 1, 0) {
        for (const Corners &each : triangle)
            for (Index c : each)
                ++begin[std::size_t(c) + 1];
        for (std::size_t i = 0; i < nodes; ++i)
            begin[i + 1] += begin[i];
        item.resize(begin.back());
        std::vector<std::uint32_t> end(begin.begin(), begin.end() - 1);
        for (std::size_t t = 0; t < triangle.size(); ++t)
            for (Index c : triangle[t])
                item[end[c]++] = std::uint32_t(t);
    }

    std::uint32_t Size(Index node) const { return begin[std::size_t(node) + 1] - begin[node]; }
    const std::uint32_t *First(Index node) const { return item.data() + begin[node]; }
    const std::uint32_t *Last(Index node) const { return First(node) + Size(node); }

    /// Whether an earlier triangle has the same corners.
    bool IsRepeated(std::uint32_t t) const {
        Corners own = triangle[t];
        const Index rare =
            *std::min_element(own.begin(), own.end(), [&](Index a, Index b) { return Size(a) < Size(b); });
        std::sort(own.begin(), own.end());
        for (const std::uint32_t *other = First(rare); *other < t; ++other) { // ascending
            Corners earlier = triangle[*other];
            std::sort(earlier.begin(), earlier.end());
            if (earlier == own)
                return true;
        }
        return false;
    }

    /// The only other triangle at an edge of \p t; \p t itself if there is none, or several. \param against out:
    /// whether both run along the edge in the same direction, so that they face different sides
    std::uint32_t Beside(std::uint32_t t, Index from, Index to, bool &against) const {
        std::uint32_t found = t;
        const Index rare = Size(from) < Size(to) ? from : to;
        for (const std::uint32_t *other = First(rare); other != Last(rare); ++other) {
            if (*other == t)
                continue;
            const Corners &corners = triangle[*other];
            for (std::size_t k = 0; k < 3; ++k) {
                const Index a = corners[k], b = corners[(k + 1) % 3];
                if ((a != from || b != to) && (a != to || b != from))
                    continue;
                if (found != t)
                    return t; // more than two
                found = *other;
                against = a == from;
            }
        }
        return found;
    }

  private:
    const std::vector<Corners> &triangle;
    std::vector<std::uint32_t> begin, item;
};

} // namespace

void MakeOneSided(const Eigen::Matrix3Xd &position, std::vector<Corners> &triangle, const Progress &progress) {
    const char *const stage = "Comparing sides";
    const std::size_t nodes = std::size_t(position.cols());
    {
        const Fans fans(nodes, triangle);
        std::vector<char> isRepeated(triangle.size());
        const Progress looking = progress.Slice(0, 0.4);
        for (std::size_t t = 0; t < triangle.size(); ++t) {
            looking.Round(t, triangle.size(), stage);
            isRepeated[t] = fans.IsRepeated(std::uint32_t(t));
        }
        std::size_t kept = 0;
        for (std::size_t t = 0; t < triangle.size(); ++t)
            if (!isRepeated[t])
                triangle[kept++] = triangle[t];
        triangle.resize(kept);
    }
    progress(0.4, stage);
    const Progress turning = progress.Slice(0.6, 1);
    const Fans fans(nodes, triangle);
    std::size_t seen = 0;
    const auto at = [&](std::uint32_t t, int k) { return position.col(triangle[t][k]); };
    const auto across = [&](std::uint32_t t) -> Eigen::Vector3d {
        return (at(t, 1) - at(t, 0)).cross(at(t, 2) - at(t, 0));
    };
    enum Side : char { unknown, kept, turned };
    std::vector<char> side(triangle.size(), unknown);
    std::vector<std::uint32_t> piece;
    for (std::size_t seed = 0; seed < triangle.size(); ++seed) {
        if (side[seed] != unknown)
            continue;
        piece.assign(1, std::uint32_t(seed));
        side[seed] = kept;
        bool hasSides = true, isMixed = false;
        for (std::size_t i = 0; i < piece.size(); ++i) {
            const std::uint32_t t = piece[i];
            turning.Round(seen++, triangle.size(), stage);
            for (std::size_t k = 0; k < 3; ++k) {
                bool against = false;
                const std::uint32_t other = fans.Beside(t, triangle[t][k], triangle[t][(k + 1) % 3], against);
                if (other == t)
                    continue;
                const char expected = against ? char(kept + turned - side[t]) : side[t];
                isMixed = isMixed || against;
                if (side[other] == unknown) {
                    side[other] = expected;
                    piece.push_back(other);
                }
                hasSides = hasSides && side[other] == expected;
            }
        }
        if (!isMixed || !hasSides) {
            for (std::uint32_t t : piece)
                side[t] = kept;
            continue;
        }
        double area[3] = {};
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (std::uint32_t t : piece) {
            const double size = across(t).norm();
            area[static_cast<unsigned char>(side[t])] += size;
            middle += size * (at(t, 0) + at(t, 1) + at(t, 2)) / 3;
        }
        const double all = area[kept] + area[turned];
        middle /= all;
        bool isOther = area[turned] > area[kept];
        if (std::max(area[kept], area[turned]) < most * all) {
            double volume = 0; // with the side of the kept triangles
            for (std::uint32_t t : piece)
                volume += (side[t] == kept ? 1 : -1) * (at(t, 0) - middle).dot(across(t));
            isOther = volume < 0;
        }
        for (std::uint32_t t : piece)
            if ((side[t] == turned) != isOther)
                std::swap(triangle[t][1], triangle[t][2]);
    }
}

} // namespace vcg::fcd
