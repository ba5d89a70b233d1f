// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/lists.h>
#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/morton.h>
#include <vcg_ext/contact/crossing_faces.h>
#include <vcg_ext/surface/box_tree.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

namespace vcg::fcd::detail {

namespace {

constexpr const char *stage = "Looking for contact";

/// The faces that may be in contact: all that move, and those at rest within the box of these. Faces whose corners lie
/// at one point or on one line are left out: none passes through another, and thousands at one point would all meet.
struct Looked {
    std::vector<std::uint32_t> face, still; ///< ascending
    Eigen::AlignedBox3d box;                ///< of the moving faces, now
};

Looked FacesToLookAt(const TwoShapes &shape, const Progress &progress) {
    const SurfaceView &mesh = shape.mesh;
    enum State : char { Stays, Moves, Unusable };
    std::vector<char> state(mesh.vertexSlots);
    ParallelForEach(progress.Slice(0, 0.3), stage, mesh.vertexSlots, 1 << 16, [&](std::size_t i) {
        state[i] = char(!shape.IsUsable(i) ? Unusable : shape.Stays(i) ? Stays : Moves);
    });
    const std::size_t grain = 1 << 16, parts = (mesh.faces + grain - 1) / grain;
    std::vector<Looked> part(parts);
    const auto stateOf = [&](std::size_t f) {
        char all = Stays;
        for (std::size_t k = 0; k < 3; ++k)
            all = std::max(all, state[shape.Corner(f, k)]);
        return all;
    };
    ParallelFor(progress.Slice(0.3, 0.7), stage, mesh.faces, grain, [&](std::size_t first, std::size_t last) {
        Looked &own = part[first / grain];
        for (std::size_t f = first; f < last; ++f)
            if (mesh.IsFace(f) && stateOf(f) == Moves && shape.HasAreaNow(f)) {
                own.face.push_back(std::uint32_t(f));
                own.box.extend(shape.BoxNow(f));
            }
    });
    Looked all;
    for (const Looked &each : part)
        all.box.extend(each.box);
    all.face = Together(part, &Looked::face);
    if (all.face.empty())
        return all;
    all.still = NumbersThat<std::uint32_t>(progress.Slice(0.7, 1), stage, mesh.faces, [&](std::size_t f) {
        return mesh.IsFace(f) && stateOf(f) == Stays && all.box.intersects(shape.BoxNow(f)) && shape.HasAreaNow(f);
    });
    return all;
}

/// Boxes of triangles in Morton order, eight in a leaf. They are in single precision. Rounding keeps the order of
/// numbers, so boxes that meet also meet when rounded.
class Leaves {
  public:
    static constexpr std::size_t wide = 8; // numbers in a register

    Leaves(const TwoShapes &shape, const Looked &looked, const Progress &progress)
        : moving(looked.face.size()), count(moving + looked.still.size()), origin(looked.box.center()),
          item(LargeArray<std::uint64_t>(count)), leaf(LargeArray<Leaf>(Size())) {
        const double size = std::max(looked.box.sizes().maxCoeff(), 1e-300);
        ParallelForEach(progress.Slice(0, 0.3), stage, count, 1 << 14, [&](std::size_t i) {
            const std::uint32_t f = i < moving ? looked.face[i] : looked.still[i - moving];
            const Eigen::Vector3f p = ((shape.BoxNow(f).center() - origin) / size).cast<float>();
            item[i] = std::uint64_t(MortonCode(p[0], p[1], p[2])) << 32 | std::uint32_t(i);
        });
        RadixSortUpper30(item, count, progress.Slice(0.3, 0.6), stage);
        box.resize(Size());
        ParallelForEach(progress.Slice(0.6, 1), stage, Size(), 1 << 11, [&](std::size_t i) { Fill(shape, looked, i); });
    }

    struct Leaf {
        float low[3][wide], high[3][wide]; ///< corners of the boxes; an entry without a triangle has an empty one
        std::uint32_t face[wide];
        std::uint32_t moves;     ///< a bit for each triangle
        std::uint32_t corner[3]; ///< slots of corners that all triangles share; SurfaceView::none: none

        /// Whether all triangles share a corner with all of \p o, as in a large fan, where all boxes meet. Then none
        /// passes through another.
        bool IsInFanWith(const Leaf &o) const {
            for (const std::uint32_t a : corner)
                if (a != SurfaceView::none && (a == o.corner[0] || a == o.corner[1] || a == o.corner[2]))
                    return true;
            return false;
        }
    };

    std::size_t Size() const { return (count + wide - 1) / wide; }
    const Leaf &operator[](std::size_t i) const { return leaf[i]; }
    const Eigen::AlignedBox3f &BoxOf(std::size_t i) const { return box[i]; }

    /// A bit for each triangle of \p b: whether its box meets that of triangle \p k of \p a.
    static std::uint32_t Meeting(const Leaf &a, std::size_t k, const Leaf &b) {
        std::uint32_t bits = 0;
        for (std::size_t l = 0; l < wide; ++l) {
            int meet = 1;
            for (int d = 0; d < 3; ++d)
                meet &= int(a.low[d][k] <= b.high[d][l]) & int(b.low[d][l] <= a.high[d][k]);
            bits |= std::uint32_t(meet) << l;
        }
        return bits;
    }

    /// Whether the box of triangle \p k of \p a meets that of leaf \p j.
    bool MeetsBox(const Leaf &a, std::size_t k, std::size_t j) const {
        const Eigen::AlignedBox3f &other = box[j];
        int meet = 1;
        for (int d = 0; d < 3; ++d)
            meet &= int(a.low[d][k] <= other.max()[d]) & int(other.min()[d] <= a.high[d][k]);
        return meet != 0;
    }

  private:
    void Fill(const TwoShapes &shape, const Looked &looked, std::size_t i) {
        Leaf &own = leaf[i];
        own.moves = 0;
        for (std::size_t k = 0; k < wide; ++k) {
            Eigen::AlignedBox3f moved;
            own.face[k] = SurfaceView::none;
            if (i * wide + k < count) {
                const auto at = std::size_t(std::uint32_t(item[i * wide + k]));
                own.face[k] = at < moving ? looked.face[at] : looked.still[at - moving];
                own.moves |= std::uint32_t(at < moving) << k;
                const Eigen::AlignedBox3d now = shape.BoxNow(own.face[k]);
                const std::uint32_t corner[] = {shape.Corner(own.face[k], 0), shape.Corner(own.face[k], 1),
                                                shape.Corner(own.face[k], 2)};
                for (std::size_t c = 0; c < 3; ++c)
                    if (k == 0)
                        own.corner[c] = corner[c];
                    else if (std::find(corner, corner + 3, own.corner[c]) == corner + 3)
                        own.corner[c] = SurfaceView::none;
                moved = {(now.min() - origin).cast<float>(), (now.max() - origin).cast<float>()};
                box[i].extend(moved);
            }
            for (int d = 0; d < 3; ++d) {
                own.low[d][k] = moved.min()[d];
                own.high[d][k] = moved.max()[d];
            }
        }
    }

    const std::size_t moving, count;
    const Eigen::Vector3d origin;
    std::unique_ptr<std::uint64_t[]> item; ///< Morton code << 32 | number: of moving faces first, then of still ones
    std::unique_ptr<Leaf[]> leaf;
    std::vector<Eigen::AlignedBox3f> box;
};

} // namespace

std::vector<Crossing> FindCrossings(const TwoShapes &shape, double apart, std::vector<Pinch> &pinches,
                                    const Progress &progress) {
    const Looked looked = FacesToLookAt(shape, progress.Slice(0, 0.2));
    if (looked.face.empty())
        return {};
    const Leaves leaves(shape, looked, progress.Slice(0.2, 0.4));
    const Eigen::AlignedBox3d &box = looked.box;
    const double distance = apart * box.diagonal().norm(),
                 least = std::ldexp(box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff(), -46);
    const auto boxOf = [&](std::size_t i) -> const Eigen::AlignedBox3f & { return leaves.BoxOf(i); };
    const BoxTree<decltype(boxOf)> tree(leaves.Size(), boxOf);
    struct Found {
        std::vector<Crossing> crossing;
        std::vector<Pinch> pinch;
    };
    const auto lookAt = [&](std::uint32_t f, std::uint32_t g, Found &found) {
        if (f > g)
            std::swap(f, g);
        auto shared = shape.SharedCorners(f, g, std::equal_to<>());
        if (shared.count > 1)
            return;
        // Begin at the shared corner: then rounding decides nothing there.
        const auto from = [](const Corners3 &c, std::size_t k) {
            return Corners3{c[k], c[(k + 1) % 3], c[(k + 2) % 3]};
        };
        const auto through = [&] {
            return Through(from(shape.CornersNow(f), shared.of[0]), from(shape.CornersNow(g), shared.of[1]), least);
        };
        const double deep = through();
        if (!(deep > 0))
            return;
        if (shared.count == 0) { // vertices may be doubled
            shared = shape.SharedCorners(
                f, g, [&](std::uint32_t i, std::uint32_t j) { return shape.mesh.At(i) == shape.mesh.At(j); });
            if (shared.count > 1 || (shared.count == 1 && !(through() > 0)))
                return;
        }
        const Corners3 a = from(shape.CornersAtRest(f), shared.of[0]), b = from(shape.CornersAtRest(g), shared.of[1]);
        if (shared.count == 0) {
            if (!AreNear(a, b, distance))
                found.crossing.push_back({{f, g}, deep});
        } else if (!(Through(a, b, 0) > 0))
            found.pinch.push_back({{f, g}, {shape.Corner(f, shared.of[0]), shape.Corner(g, shared.of[1])}});
    };
    const std::size_t grain = 1 << 8;
    std::vector<Found> found((leaves.Size() + grain - 1) / grain);
    ParallelFor(progress.Slice(0.4, 1), stage, leaves.Size(), grain, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const Leaves::Leaf &a = leaves[i];
            if (a.moves == 0)
                continue;
            tree.ForMeeting(leaves.BoxOf(i), [&](std::size_t j) {
                const Leaves::Leaf &b = leaves[j];
                if ((j < i && b.moves != 0) || a.IsInFanWith(b)) // leaf j finds this pair
                    return;
                for (std::size_t k = 0; k < Leaves::wide; ++k) {
                    if (!leaves.MeetsBox(a, k, j))
                        continue;
                    std::uint32_t bits = Leaves::Meeting(a, k, b);
                    if (i == j)
                        bits &= ~((2u << k) - 1);
                    if (!(a.moves >> k & 1))
                        bits &= b.moves;
                    for (std::size_t l = 0; bits >> l != 0; ++l)
                        if (bits >> l & 1)
                            lookAt(a.face[k], b.face[l], found[first / grain]);
                }
            });
        }
    });
    pinches = Together(found, &Found::pinch);
    std::vector<Crossing> all = Together(found, &Found::crossing);
    std::sort(all.begin(), all.end());
    return all;
}

} // namespace vcg::fcd::detail
