// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CARRIER_H
#define VCG_FCD_CARRIER_H

#include <vcg_ext/base/progress.h>
#include <vcg_ext/map/moving_surface.h>
#include <vcg_ext/map/normals.h>
#include <vcg_ext/surface/nearest_place.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace vcg::fcd {

/// Maps the vertices of a surface by a pose, and points beside it. Surface and pose must outlive this.
class Carrier {
  public:
    /// \param threads for the preparation, 0 = one a core
    Carrier(const MovingSurface &surface, const SurfacePose &pose, unsigned threads = 0);

    /// The displacements of points that follow places on the surface, which NearestPlace finds once for all poses.
    /// Points near each other are mapped together, which is several times faster. \param place of vertex slots \param p
    /// mesh units \param displacement out: mesh units; exactly 0 where nothing moves at the place \param linear out:
    /// the linear maps of the surface there, mesh units
    void Displacements(const std::vector<SurfacePlace> &place, const std::vector<Eigen::Vector3d> &p,
                       std::vector<Eigen::Vector3d> &displacement, std::vector<Eigen::Matrix3f> &linear) const;

    /// Deforms all vertices. Held ones are exact, and fixed ones keep their bits. \param position 3 x vertex slots,
    /// mesh units; in: at rest, out: deformed \param linear if not null, out: the linear map of the surface at each
    /// vertex slot, mesh units
    void Apply(Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> *linear = nullptr,
               const Progress &progress = {}) const;

    /// The same for positions in any layout. Calls take(slot, position, linear map) once for each slot that may move in
    /// some pose. The map is the identity unless \p maps.
    /// \param rest rest(slot): its rest position, mesh units
    /// \param taker taker() makes a take for one range of slots; called by several threads at a time
    /// \param ahead ahead(slot) is called some slots before rest(slot), to prefetch it
    template <class Rest, class Taker, class Ahead>
    void Apply(const Rest &rest, const Taker &taker, bool maps, const Progress &progress, const Ahead &ahead) const {
        ApplyBlocks(
            rest, maps, progress, ahead, taker,
            [&](auto &take, const MovingRegion::Bent *vertex, int count, const detail::Vertices &moved) {
                for (int l = 0; l < count; ++l)
                    take(vertex[l].slot, moved.Moved(l), maps ? moved.Linear(l) : Eigen::Matrix3f::Identity());
            },
            [&](auto &take, std::size_t slot, const Eigen::Vector3d &p, const Eigen::Matrix3f &map) {
                take(slot, p, map);
            });
    }

    /// The same with normals: calls take(slot, position, normal). They turn with the surface and keep their lengths.
    /// \param normal normal(slot): at rest
    template <class Rest, class Normal, class Taker, class Ahead>
    void ApplyWithNormals(const Rest &rest, const Normal &normal, const Taker &taker, const Progress &progress,
                          const Ahead &ahead) const {
        ApplyBlocks(
            rest, true, progress, ahead, taker,
            [&](auto &take, const MovingRegion::Bent *vertex, int count, detail::Vertices &moved) {
                Eigen::Vector3d before[detail::lanes];
                for (int l = 0; l < detail::lanes; ++l) {
                    before[l] = normal(vertex[std::min(l, count - 1)].slot);
                    moved.SetNormal(l, before[l]);
                }
                detail::TurnNormals(moved);
                for (int l = 0; l < count; ++l)
                    take(vertex[l].slot, moved.Moved(l), moved.turns[l] != 0 ? moved.Normal(l) : before[l]);
            },
            [&](auto &take, std::size_t slot, const Eigen::Vector3d &p, const Eigen::Matrix3f &map) {
                take(slot, p, Turned(map, normal(slot)));
            });
    }

    /// The motion of a vertex in no region, mesh units.
    const Eigen::Matrix4d &MatrixAt(std::size_t slot) const;

  private:
    /// Maps all slots that may move: free vertices in blocks, by takeBlock(take, ...), others one by one, by takeOne.
    template <class Rest, class Ahead, class Taker, class TakeBlock, class TakeOne>
    void ApplyBlocks(const Rest &rest, bool maps, const Progress &progress, const Ahead &ahead, const Taker &taker,
                     const TakeBlock &takeBlock, const TakeOne &takeOne) const {
        const char *stage = "Mapping to the mesh";
        struct Range {
            std::size_t region, first, last;
        };
        std::vector<Range> ranges; // of the free vertices
        std::size_t bends = 0;
        for (std::size_t r = 0; r < moving.regions.size(); ++r) {
            const std::size_t count = moving.regions[r]->bent.size(), grain = 1 << 12;
            for (std::size_t first = 0; first < count; first += grain)
                ranges.push_back({r, first, std::min(count, first + grain)});
            bends += count;
        }
        const std::size_t all = bends + moving.carried.size();
        const double share = all > 0 ? double(bends) / double(all) : 1;
        ParallelFor(progress.Slice(0, share), stage, ranges.size(), 1, [&](std::size_t at, std::size_t) {
            auto &&take = taker();
            GraphMapping::Posed::Scratch scratch;
            Index node[detail::lanes];
            const Range &range = ranges[at];
            const MovingRegion &region = *moving.regions[range.region];
            const std::vector<MovingRegion::Bent> &bent = region.bent;
            constexpr std::size_t lanes = detail::lanes;
            for (std::size_t i = range.first; i < range.last;) {
                const Index patch = region.patches.patchOf[bent[i].node];
                int count = 0;
                for (std::size_t next = i + 2 * lanes; next < std::min(range.last, i + 3 * lanes); ++next)
                    ahead(bent[next].slot);
                for (; count < detail::lanes && i + count < range.last; ++count) {
                    node[count] = bent[i + count].node;
                    if (region.patches.patchOf[node[count]] != patch)
                        break;
                    scratch.vertices.SetRest(count, rest(bent[i + count].slot));
                }
                if (Rests(range.region, patch))
                    scratch.vertices.Stay();
                else
                    mapped[range.region]->Map(node, count, maps, scratch);
                takeBlock(take, &bent[i], count, scratch.vertices);
                i += count;
            }
        });
        ParallelFor(progress.Slice(share, 1), stage, moving.carried.size(), 1 << 12,
                    [&](std::size_t first, std::size_t last) {
                        auto &&take = taker();
                        Eigen::Matrix3f map;
                        for (std::size_t c = first; c < last; ++c) {
                            const Eigen::Vector3d p = MovedUnbent(moving.carried[c], rest(moving.carried[c]), map);
                            takeOne(take, moving.carried[c], p, map);
                        }
                    });
        progress(1, stage);
    }

    /// Moves a point as a vertex moves that is free in no region. \param slot of the vertex \param p mesh units; keeps
    /// its bits if the vertex does \param linear out: the linear map of the surface there, mesh units
    Eigen::Vector3d MovedUnbent(std::size_t slot, const Eigen::Vector3d &p, Eigen::Matrix3f &linear) const;

    /// Whether the vertices of a patch keep their bits: nothing moves in its region or, with distances along the
    /// surface, in its part of the graph. With Euclidean weights, nodes of other parts influence it.
    bool Rests(std::size_t region, Index patch) const {
        return !regionMoves[region] ||
               (moving.regions[region]->weights == MappingWeights::Surface && pose.region[region].graph.rests[patch]);
    }

    /// The motion of a held vertex, or of a free one at the same position as a held one, mesh units.
    const Eigen::Matrix4d &GivenAt(std::size_t slot) const;

    /// The motion of each loose part, mesh units: that of its leader, made rigid if the graph's maps are.
    std::vector<Eigen::Matrix4d> LooseMotions() const;

    /// The motion at each of LooseFollowing::place, mesh units.
    std::vector<Eigen::Affine3d> PlaceMotions(unsigned threads) const;

    /// The position of a vertex of a large loose part: the weighted mean of the motions at places near it, mesh units.
    Eigen::Vector3d Followed(const LooseFollowing::Vertex &vertex, const Eigen::Vector3d &p) const;

    const MovingSurface &moving;
    const SurfacePose &pose;
    const std::vector<std::unique_ptr<const GraphMapping::Posed>> mapped; // of each region
    const std::vector<Eigen::Matrix4d> looseMotion;                       // of each loose part, mesh units
    const std::vector<Eigen::Affine3d> placeMotion; // of each of LooseFollowing::place, mesh units
    const bool moves;
    std::vector<char> regionMoves; // asked for each block of vertices, while RegionPose::Moves looks at each handle
};

} // namespace vcg::fcd

#endif
