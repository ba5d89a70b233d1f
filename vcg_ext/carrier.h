// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_CARRIER_H
#define VCG_FCD_CARRIER_H

#include "graph_mapping.h"
#include "held_nodes.h"
#include "loose_parts.h"
#include "nearest_place.h"
#include "normals.h"
#include "rotation_fit.h"

#include <utility>

namespace vcg {
namespace fcd {

/// One pose of a surface.
struct SurfacePose {
    HeldMotions given;
    GraphPose solved;                        ///< of the graph
    GraphPose graph;                         ///< the same with linear maps (FitLinear; rotations as printed)
    std::vector<Eigen::Affine3d> nodeMotion; ///< k, of constrained nodes, frame units
    /// Of every tag but 1, frame units; of single nodes that turn as the surface around them does, that.
    std::map<Index, Eigen::Affine3d> motion;
    int iterations = 0; ///< of the solver, with those of the poses on the way
};

/// A surface with its deformation graph, and how each of its vertices follows the graph.
struct MovingSurface {
    /// A free vertex of the surface.
    struct Bent {
        std::uint32_t slot;
        Index node;
    };

    const SurfaceGraph surface; ///< the free surface without its loose parts, and what holds it
    const HeldNodes held;
    const LooseSurface loose;
    const std::vector<int> slotTag; ///< one per vertex slot, noVertex where it is deleted
    Patches patches;
    DeformationGraph graph;
    MappingWeights weights = MappingWeights::Surface;
    std::unique_ptr<GraphMapping> mapping;
    LooseFollowing following;
    std::vector<Eigen::Vector3d> leaderRest; ///< of each loose part, mesh units
    std::vector<Bent> bent;                  ///< the free vertices of the surface
    std::vector<std::uint32_t> carried;      ///< slots of handles, and of loose parts

    MovingSurface(SurfaceGraph surface, HeldNodes held, LooseSurface loose, std::vector<int> slotTag)
        : surface(std::move(surface)), held(std::move(held)), loose(std::move(loose)), slotTag(std::move(slotTag)) {}
    MovingSurface(const MovingSurface &) = delete; // its parts refer to each other
    MovingSurface &operator=(const MovingSurface &) = delete;

    /// body(slot) for each slot that may move in some pose, once.
    template <class Body>
    void ForMoving(const Body &body) const {
        for (const Bent &vertex : bent)
            body(std::size_t(vertex.slot));
        for (std::uint32_t i : carried)
            body(std::size_t(i));
    }

    /// Lists what may move, free vertices of one patch beside each other. \param point slots of the point handles
    void FindMoving(const std::vector<std::size_t> &point, const Progress &progress) {
        const char *stage = "Preparing the mapping";
        const std::size_t grain = 1 << 14, count = surface.slots.size(), chunks = (count + grain - 1) / grain;
        std::vector<std::size_t> begin(chunks + 1, 0);
        const auto isBent = [&](std::size_t i) {
            const Index node = surface.nodeOf[surface.slots[i]];
            return node >= 0 && held.tag[node] == 1;
        };
        ParallelFor(progress, stage, count, grain, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                begin[first / grain + 1] += isBent(i);
        });
        for (std::size_t c = 0; c < chunks; ++c)
            begin[c + 1] += begin[c];
        AssignLarge(bent, begin[chunks], Bent{0, 0});
        ParallelFor(progress, stage, count, grain, [&](std::size_t first, std::size_t last) {
            std::vector<std::pair<Index, Bent>> here; // by patch
            here.reserve(last - first);
            std::map<Index, std::size_t> next; // of each patch: where its next one goes
            for (std::size_t i = first; i < last; ++i)
                if (isBent(i)) {
                    const Index node = surface.nodeOf[surface.slots[i]];
                    here.push_back({patches.patchOf[node], {surface.slots[i], node}});
                    ++next[here.back().first];
                }
            std::size_t at = begin[first / grain];
            for (auto &each : next)
                each.second = std::exchange(at, at + each.second);
            for (const auto &each : here)
                bent[next[each.first]++] = each.second;
        });

        std::vector<char> isPoint; // one per slot, where there is any
        for (std::size_t i : point) {
            isPoint.resize(slotTag.size(), 0);
            isPoint[i] = 1;
        }
        const auto isCarried = [&](std::size_t i) {
            const Index node = surface.nodeOf[i];
            if (node >= 0)
                return held.tag[node] != 1 && !held.IsFixed(held.tag[node]);
            if (slotTag[i] != 1)
                return slotTag[i] > 1;
            return (!loose.partOf.empty() && loose.partOf[i] >= 0) || (!isPoint.empty() && isPoint[i]);
        };
        carried = CollectInOrder<std::uint32_t>(progress, stage, Index(slotTag.size()),
                                                [&](Index i, std::vector<std::uint32_t> &found) {
                                                    if (isCarried(std::size_t(i)))
                                                        found.push_back(std::uint32_t(i));
                                                });
    }
};

/// Where a pose takes the vertices of a surface, and points beside them. Refers to surface and pose.
class Carrier {
  public:
    Carrier(const MovingSurface &surface, const SurfacePose &pose)
        : moving(surface), pose(pose), mapped(moving.mapping->At(pose.graph, pose.motion, moving.surface.frame)),
          looseMotion(LooseMotions()), moves(pose.given.Moves()) {}

    /// \param slot of a vertex \param p a point beside it, mesh units; it keeps its bits where the vertex does
    /// \param linear how the surface turns and stretches there, mesh units
    Eigen::Vector3d operator()(std::size_t slot, const Eigen::Vector3d &p, Eigen::Matrix3f &linear) const {
        const Index node = moving.surface.nodeOf[slot];
        linear.setIdentity();
        if (!moves || moving.slotTag[slot] == noVertex)
            return p;
        if (node >= 0 && moving.held.tag[node] == 1) {
            if (moving.weights == MappingWeights::Surface && pose.graph.rests[moving.patches.patchOf[node]])
                return p;
            return mapped(node, p, &linear);
        }
        if (node >= 0 && moving.held.IsFixed(moving.held.tag[node]))
            return p;
        const auto told = pose.given.pointMotion.find(slot);
        const auto &follows = moving.following.vertex;
        const auto follower =
            std::lower_bound(follows.begin(), follows.end(), slot,
                             [](const LooseFollowing::Vertex &vertex, std::size_t s) { return vertex.slot < s; });
        const Eigen::Matrix4d &matrix = node >= 0 ? pose.given.motion.at(moving.held.tag[node]) : MatrixAt(slot);
        linear = matrix.topLeftCorner<3, 3>().cast<float>();
        if (told != pose.given.pointMotion.end())
            return p + told->second.topRightCorner<3, 1>();
        if (follower != follows.end() && follower->slot == slot)
            return Followed(*follower, p);
        return matrix.isIdentity(0) ? p : Eigen::Vector3d((matrix * p.homogeneous()).head<3>());
    }

    /// The displacement of a point that is no vertex: it goes with its place on the surface, which NearestPlace finds
    /// once for all poses.
    /// \param place of vertex slots \param p mesh units \param linear how the surface turns and stretches there
    /// \return mesh units; 0, to the bit, where nothing moves at the place
    Eigen::Vector3d Displacement(const SurfacePlace &place, const Eigen::Vector3d &p, Eigen::Matrix3f &linear) const {
        Eigen::Vector3d way = Eigen::Vector3d::Zero();
        Eigen::Matrix3f each;
        linear.setZero();
        for (int k = 0; k < place.count; ++k) {
            way += place.weight[k] * ((*this)(std::size_t(place.slot[k]), p, each) - p);
            linear += float(place.weight[k]) * each;
        }
        return way;
    }

    /// \param position 3 x vertex slots, mesh units; in: at rest, out: deformed. Held vertices are exact: what is fixed
    ///        keeps its bits.
    /// \param linear if given: how the surface turns and stretches around each vertex, mesh units, one per slot
    void Apply(Eigen::Matrix3Xd &position, std::vector<Eigen::Matrix3f> *linear = nullptr,
               const Progress &progress = {}) const {
        if (linear)
            linear->assign(moving.slotTag.size(), Eigen::Matrix3f::Identity());
        Apply([&](std::size_t i) { return Eigen::Vector3d(position.col(Eigen::Index(i))); },
              [&] {
                  return [&](std::size_t i, const Eigen::Vector3d &p, const Eigen::Matrix3f &map) {
                      position.col(Eigen::Index(i)) = p;
                      if (linear)
                          (*linear)[i] = map;
                  };
              },
              linear != nullptr, progress, [](std::size_t) {});
    }

    /// The same for any layout: rest(slot) gives the position at rest; taker() gives what takes, by a call with (slot,
    /// position, map), the deformed ones and, where \p maps are wanted, how the surface turns and stretches there.
    /// There is a taker for some slots each, called from several threads; it gets each slot that may move in some pose
    /// once, and no other. ahead(slot) tells which slots come soon, for memory that is far away.
    template <class Rest, class Taker, class Ahead>
    void Apply(const Rest &rest, const Taker &taker, bool maps, const Progress &progress, const Ahead &ahead) const {
        ApplyBlocks(
            rest, maps, progress, ahead, taker,
            [&](auto &take, const MovingSurface::Bent *vertex, int count, const detail::Vertices &moved) {
                for (int l = 0; l < count; ++l)
                    take(vertex[l].slot, moved.Moved(l), maps ? moved.Linear(l) : Eigen::Matrix3f::Identity());
            },
            [&](auto &take, std::size_t slot, const Eigen::Vector3d &p, const Eigen::Matrix3f &map) {
                take(slot, p, map);
            });
    }

    /// The same with normals, which turn with the surface and keep their lengths: normal(slot) gives that at rest, and
    /// what takes is called with (slot, position, normal).
    template <class Rest, class Normal, class Taker, class Ahead>
    void ApplyWithNormals(const Rest &rest, const Normal &normal, const Taker &taker, const Progress &progress,
                          const Ahead &ahead) const {
        ApplyBlocks(
            rest, true, progress, ahead, taker,
            [&](auto &take, const MovingSurface::Bent *vertex, int count, detail::Vertices &moved) {
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

    /// The motion of a vertex that is no node of the surface, mesh units.
    const Eigen::Matrix4d &MatrixAt(std::size_t slot) const {
        if (moving.slotTag[slot] == 1 && !moving.loose.partOf.empty() && moving.loose.partOf[slot] >= 0)
            return looseMotion[moving.loose.partOf[slot]];
        return pose.given.motion.at(moving.slotTag[slot] == 1 ? 0 : std::max(0, moving.slotTag[slot]));
    }

  private:
    /// Maps what may move: blocks of free vertices, for takeBlock(take, ...), and the others one by one, for takeOne.
    template <class Rest, class Ahead, class Taker, class TakeBlock, class TakeOne>
    void ApplyBlocks(const Rest &rest, bool maps, const Progress &progress, const Ahead &ahead, const Taker &taker,
                     const TakeBlock &takeBlock, const TakeOne &takeOne) const {
        const char *stage = "Mapping to the mesh";
        const bool isSurface = moving.weights == MappingWeights::Surface; // no other part has an influence
        const std::size_t all = moving.bent.size() + moving.carried.size(), lanes = detail::lanes;
        const double share = all > 0 ? double(moving.bent.size()) / double(all) : 1;
        ParallelFor(progress.Slice(0, share), stage, moving.bent.size(), 1 << 12,
                    [&](std::size_t first, std::size_t last) {
                        auto &&take = taker();
                        GraphMapping::Posed::Scratch scratch;
                        Index node[detail::lanes];
                        for (std::size_t i = first; i < last;) {
                            const Index patch = moving.patches.patchOf[moving.bent[i].node];
                            int count = 0;
                            for (std::size_t next = i + 2 * lanes; next < std::min(last, i + 3 * lanes); ++next)
                                ahead(moving.bent[next].slot);
                            for (; count < detail::lanes && i + count < last; ++count) {
                                node[count] = moving.bent[i + count].node;
                                if (moving.patches.patchOf[node[count]] != patch)
                                    break;
                                scratch.vertices.SetRest(count, rest(moving.bent[i + count].slot));
                            }
                            if (!moves || (isSurface && pose.graph.rests[patch]))
                                scratch.vertices.Stay();
                            else
                                mapped.Map(node, count, maps, scratch);
                            takeBlock(take, &moving.bent[i], count, scratch.vertices);
                            i += count;
                        }
                    });
        ParallelFor(progress.Slice(share, 1), stage, moving.carried.size(), 1 << 12,
                    [&](std::size_t first, std::size_t last) {
                        auto &&take = taker();
                        Eigen::Matrix3f map;
                        for (std::size_t c = first; c < last; ++c) {
                            const Eigen::Vector3d p = (*this)(moving.carried[c], rest(moving.carried[c]), map);
                            takeOne(take, moving.carried[c], p, map);
                        }
                    });
        progress(1, stage);
    }

    /// The motion of a held vertex, or of a free one at the place of one.
    const Eigen::Matrix4d &GivenAt(std::size_t slot) const {
        const Index node = moving.surface.nodeOf[slot];
        if (node >= 0)
            return pose.given.motion.at(moving.held.tag[node]);
        return moving.slotTag[slot] == 1 ? pose.given.pointMotion.at(slot)
                                         : pose.given.motion.at(std::max(0, moving.slotTag[slot]));
    }

    /// The motion of each loose part, mesh units: the rigid one of its leader.
    std::vector<Eigen::Matrix4d> LooseMotions() const {
        std::vector<Eigen::Matrix4d> result(moving.loose.parts, Eigen::Matrix4d::Identity());
        for (Index part = 0; part < moving.loose.parts; ++part) {
            const std::size_t i = moving.following.leader[part];
            if (i == LooseFollowing::none)
                continue;
            const Eigen::Vector3d p = moving.surface.frame.ToFrame(moving.leaderRest[part]);
            Eigen::Affine3d there;
            const Index node = moving.surface.nodeOf[i];
            if (node >= 0 && moving.surface.tag[node] == 1) {
                there.linear() = detail::RotationOf(pose.graph.linear[moving.patches.patchOf[node]]);
                there.translation() =
                    moving.surface.frame.ToFrame(mapped(node, moving.leaderRest[part])) - there.linear() * p;
            } else {
                const Eigen::Matrix4d &given = GivenAt(i);
                if (given.isIdentity(0))
                    continue;
                const Eigen::Affine3d moved = moving.surface.frame.ToFrame(given);
                there.linear() = detail::RotationOf(moved.linear());
                there.translation() = moved * p - there.linear() * p;
            }
            result[part] = moving.surface.frame.FromFrame(there);
            result[part].row(3) << 0, 0, 0, 1;
        }
        return result;
    }

    /// Where a vertex of a large loose part goes: the mean of where the places near it lead.
    Eigen::Vector3d Followed(const LooseFollowing::Vertex &vertex, const Eigen::Vector3d &p) const {
        Eigen::Vector3d way = Eigen::Vector3d::Zero();
        for (int i = 0; i < Places::several; ++i) {
            if (!(vertex.weight[i] > 0))
                continue;
            const std::size_t slot = std::size_t(vertex.place[i]);
            const Index node = moving.surface.nodeOf[slot];
            const Eigen::Vector3d there =
                node >= 0 ? mapped(node, p) : Eigen::Vector3d((GivenAt(slot) * p.homogeneous()).head<3>());
            way += double(vertex.weight[i]) * (there - p);
        }
        return way.isZero(0) ? p : p + way;
    }

    const MovingSurface &moving;
    const SurfacePose &pose;
    const GraphMapping::Posed mapped;
    const std::vector<Eigen::Matrix4d> looseMotion; // of each loose part, mesh units
    const bool moves;
};

} // namespace fcd
} // namespace vcg

#endif
