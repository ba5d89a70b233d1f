// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_MAPPING_H
#define VCG_FCD_GRAPH_MAPPING_H

#include "deformation_graph.h"
#include "graph_pose.h"
#include "handles.h"
#include "mapping_kernel.h"
#include "node_tree.h"
#include "patch_sampling.h"
#include "rotation_fit.h"
#include "shape_constants.h"

#include <functional>
#include <tuple>

namespace vcg {
namespace fcd {

/// What a node of the deformation graph may influence.
enum class MappingWeights {
    Surface,  ///< what is connected to it over free surface inside the ball of its influence, by a way not much longer
              ///< than the straight one
    Euclidean ///< whatever is inside the ball (the paper's)
};

/// Carries the motion of the deformation graph's nodes over to the nodes of the surface (paper, sec. 2.3, Eqs. 7 and
/// 8).
///
/// p' = sum_j w_j(p) ((R_j + R(p)) / 2 (p - c_j) + c'_j), weights normalised to sum one, w_j falling smoothly to zero
/// at `influence` times the radius of j's patch, and R(p) = sum_j w_j(p) R_j. (The paper has R_j alone, which is of
/// first order from node to vertex and leaves ripples of patch size where the surface bends; the mean of the two ends
/// is of second order, as the trapezoidal rule is.) Near a held region, the blend runs over into that region's own
/// motion, with continuous tangents at its border, so that held nodes are exact and no crease is left there. Small held
/// parts may lie in patches of free nodes.
class GraphMapping {
  public:
    /// \param tag tag of each surface node: 0 fixed, 1 free, else handle
    /// \param influence node radius over patch radius, > 1
    /// \param fade greatest width of the run-over into held regions along the surface, units of the positions
    GraphMapping(const Graph &surface, const std::vector<Index> &tag, const Patches &patches,
                 const DeformationGraph &graph, MappingWeights weights, double influence, double fade,
                 const Progress &progress = {}, const ShapeConstants &shape = {})
        : surface(surface), tag(tag), patches(patches), graph(graph), shape(shape) {
        const Index k = graph.Size();
        reach.resize(k);
        for (Index j = 0; j < k; ++j) {
            // A patch of few nodes still has to overlap its neighbours.
            double spacing = 0;
            for (Index i : graph.graph.adjacency[j])
                spacing += (graph.graph.position.col(i) - graph.graph.position.col(j)).norm();
            if (graph.graph.adjacency[j].size())
                spacing /= double(graph.graph.adjacency[j].size());
            const double radius = std::max({double(graph.radius[j]), 0.5 * spacing, 1e-6}); // a lone node has neither
            reach[j] = float(influence * radius);
        }
        FindCandidates(weights, influence, progress.Slice(0, 0.2));
        progress(0.2, "Preparing the mapping");
        FindHeldNearby(fade, progress.Slice(0.2, 0.9));
        FindWaysAway(fade, progress.Slice(0.9, 1));
    }

    /// The mapping of one pose: a function of a surface node and the position of a vertex there (frame units).
    class Posed {
      public:
        /// \param linear if given: how the surface around the vertex turns and stretches
        Eigen::Vector3d operator()(Index node, const Eigen::Vector3d &p, Eigen::Matrix3f *linear = nullptr) const {
            if (mapping.tag[node] != 1) {
                const Eigen::Affine3d &held = motion.at(mapping.tag[node]);
                if (linear)
                    *linear = held.linear().cast<float>();
                return held * p;
            }
            Eigen::Vector3d moved;
            thread_local Scratch scratch;
            Map(&node, &p, 1, &moved, linear, scratch);
            return moved;
        }

        /// Memory that many calls of Map use again.
        struct Scratch {
            detail::Blending blending;
            std::vector<float> weight, shareWeight, strainTerm;
            std::vector<std::uint32_t> active, shareActive;
            alignas(64) float strain[detail::terms][detail::lanes];

            template <class T>
            static T *AtLeast(std::vector<T> &memory, std::size_t size) {
                if (memory.size() < size)
                    memory.resize(size);
                return memory.data();
            }
        };

        /// Maps \p count vertices, detail::lanes at most, at free nodes of one patch.
        void Map(const Index *node, const Eigen::Vector3d *p, int count, Eigen::Vector3d *moved,
                 Eigen::Matrix3f *linear, Scratch &scratch) const {
            using detail::lanes;
            const Index patch = mapping.patches.patchOf[node[0]];
            const std::uint32_t first = mapping.candidates.begin[patch], end = mapping.candidates.begin[patch + 1];
            const std::vector<detail::Ball> &nearby = mapping.nearby[patch];
            const auto rows = [](std::vector<float> &memory, std::size_t wanted) {
                return reinterpret_cast<float(*)[lanes]>(Scratch::AtLeast(memory, wanted * lanes));
            };
            detail::Blending &b = scratch.blending;
            b.ball = mapping.ball.data() + first;
            b.term = reinterpret_cast<const float(*)[detail::terms]>(term.data() + std::size_t(first) * detail::terms);
            b.n = end - first;
            b.whole = mapping.partial[patch] - first;
            b.shareBall = nearby.data();
            b.share = mapping.shares.data() + mapping.sharesBegin[patch];
            b.m = nearby.size();
            b.weight = rows(scratch.weight, b.n);
            b.shareWeight = rows(scratch.shareWeight, b.m);
            b.active = Scratch::AtLeast(scratch.active, b.n);
            b.shareActive = Scratch::AtLeast(scratch.shareActive, b.m);
            for (int l = 0; l < lanes; ++l)
                for (int d = 0; d < 3; ++d)
                    b.x[d][l] = mapping.surface.position(d, node[std::min(l, count - 1)]);
            detail::Blend(b);

            // What the candidates' motions differ by from that of the patch is small, and float is enough.
            const Eigen::Vector3d center = mapping.graph.graph.position.col(patch).template cast<double>();
            float inverse[lanes], local[3][lanes], offset[3][lanes];
            for (int l = 0; l < lanes; ++l) { // 0 where no ball reaches, as around an isolated vertex
                const float total = b.sum[15][l];
                inverse[l] = total > 0 ? 1 / total : 0;
            }
            for (int d = 0; d < 3; ++d)
                for (int l = 0; l < lanes; ++l)
                    local[d][l] =
                        float(p[std::min(l, count - 1)][d] - center[d]) - 0.5f * b.sum[12 + d][l] * inverse[l];
            for (int d = 0; d < 3; ++d)
                for (int l = 0; l < lanes; ++l)
                    offset[d][l] = (local[0][l] * b.sum[d][l] + local[1][l] * b.sum[3 + d][l] +
                                    local[2][l] * b.sum[6 + d][l] + b.sum[9 + d][l]) *
                                   inverse[l];
            bool isStrainKnown = false;
            const Eigen::Matrix3f ownLinear = own[patch].linear().cast<float>();
            for (int l = 0; l < count; ++l) {
                Eigen::Vector3d sum = own[patch] * p[l] + Eigen::Vector3d(offset[0][l], offset[1][l], offset[2][l]);
                if (linear)
                    for (int d = 0; d < 9; ++d)
                        linear[l].data()[d] = ownLinear.data()[d] + b.sum[d][l] * inverse[l];
                const std::uint32_t firstHeld = mapping.heldBegin[node[l]], endHeld = mapping.heldBegin[node[l] + 1];
                if (firstHeld == endHeld) {
                    moved[l] = sum;
                    continue;
                }
                if (!isStrainKnown)
                    SumStrain(scratch);
                isStrainKnown = true;
                Eigen::Matrix3f strain;
                for (int d = 0; d < 9; ++d)
                    strain.data()[d] = scratch.strain[d][l] * inverse[l];
                double weight = 1;
                Eigen::Matrix3f turns = Eigen::Matrix3f::Zero();
                for (std::uint32_t h = firstHeld; h < endHeld; ++h) {
                    // s falls from 1 at the held region to 0 at the end of the fade; s / (1 - s) grows beyond all
                    // bounds. What is held does not stretch, but beside it the surface may: as it does there, away from
                    // the border.
                    const Held &held = mapping.held[h];
                    const double s = Falloff(held.distance), share = s / (1 - s);
                    sum += share * (heldMotion[held.index] * (p[l] + (strain * held.away).cast<double>()));
                    turns += float(share) * heldMotion[held.index].linear().cast<float>();
                    weight += share;
                }
                if (linear)
                    linear[l] = (linear[l] + turns) / float(weight);
                moved[l] = sum / weight;
            }
        }

      private:
        friend class GraphMapping;

        /// How the nodes stretch the surface, weighed as they were.
        void SumStrain(Scratch &scratch) const {
            const detail::Blending &b = scratch.blending;
            auto *term =
                reinterpret_cast<float(*)[detail::terms]>(Scratch::AtLeast(scratch.strainTerm, b.n * detail::terms));
            for (std::size_t a = 0; a < b.used; ++a)
                std::copy_n(nodeStrain[b.ball[b.active[a]].node].data(), 9, term[b.active[a]]);
            detail::SumTerms(b, term, scratch.strain);
        }

        Posed(const GraphMapping &mapping, const GraphPose &pose, const std::map<Index, Eigen::Affine3d> &motion)
            : mapping(mapping), motion(motion), own(mapping.graph.Size()), nodeStrain(mapping.graph.Size()),
              term(mapping.candidates.item.size() * detail::terms) {
            for (Index t : mapping.heldTag)
                heldMotion.push_back(motion.at(t));
            const auto rest = [&](Index j) { return mapping.graph.graph.position.col(j).cast<double>(); };
            for (Index j = 0; j < mapping.graph.Size(); ++j) {
                own[j] = Eigen::Affine3d::Identity();
                own[j].linear() = pose.linear[j];
                own[j].translation() = pose.position.col(j) - pose.linear[j] * rest(j);
                const Eigen::Matrix3d stretch = detail::RotationOf(pose.linear[j]).transpose() * pose.linear[j];
                nodeStrain[j] = (stretch - Eigen::Matrix3d::Identity()).cast<float>();
            }
            using Terms = Eigen::Matrix<float, detail::terms, 1>;
            for (Index patch = 0; patch < mapping.graph.Size(); ++patch)
                for (std::uint32_t c = mapping.candidates.begin[patch]; c < mapping.candidates.begin[patch + 1]; ++c) {
                    const Index j = mapping.candidates.item[c];
                    const Eigen::Matrix3d linear = pose.linear[j] - pose.linear[patch];
                    const Eigen::Vector3d way = rest(j) - rest(patch);
                    const Eigen::Vector3d shift = pose.position.col(j) - pose.position.col(patch) -
                                                  0.5 * (pose.linear[j] + pose.linear[patch]) * way;
                    Eigen::Map<Terms> terms(term.data() + std::size_t(c) * detail::terms);
                    terms << linear.col(0).cast<float>(), linear.col(1).cast<float>(), linear.col(2).cast<float>(),
                        shift.cast<float>(), way.cast<float>(), 1.f;
                }
        }

        const GraphMapping &mapping;
        const std::map<Index, Eigen::Affine3d> &motion;
        std::vector<Eigen::Affine3d> heldMotion; // of each of mapping.heldTag
        std::vector<Eigen::Affine3d> own;
        std::vector<Eigen::Matrix3f> nodeStrain; // stretch minus identity
        /// Of each candidate, about the patch's centre: columns of the 3 x 4 affine map by which it moves otherwise
        /// than the patch's node, the way to it, 1.
        std::vector<float> term;
    };

    /// \param motion of each held tag, 0 included; must outlive the result, as the mapping must
    Posed At(const GraphPose &pose, const std::map<Index, Eigen::Affine3d> &motion) const {
        return Posed(*this, pose, motion);
    }

  private:
    detail::Ball BallOf(Index j, float radius) const {
        const auto center = graph.graph.position.col(j);
        return {{center[0], center[1], center[2]}, 1 / (radius * radius), j};
    }

    struct Candidate {
        Index patch, node;
        bool partial;      ///< some share is less than 1
        std::size_t share; ///< if so: the first of those from the balls near the patch
    };
    struct Held {
        Index index;    ///< in heldTag
        float distance; ///< to the held region over the fade's width, (0, 1)
        Eigen::Vector3f
            away; ///< from the border of the held region, at right angles, as far as that; 0 for small parts
    };

    /// From 1 at x = 0, where it is level, to 0 at x = 1 with two continuous derivatives. It leaves 1 soon: what it
    /// multiplies grows with x, and this shape keeps the curvature of the product low.
    static double Falloff(double x) {
        const double level = 0.1, y = x * x * (1 + level) / (x + level), y2 = y * y;
        return 1 - y * (15 - y2 * (10 - 3 * y2)) / 8;
    }

    /// The share of its weight that a node keeps where the way to it over the surface is \p way and the straight one
    /// \p straight: all half-way round a cylinder, nothing across a fold.
    float Share(double way, double straight, double radius) const {
        const double detour = way / std::max(straight, shape.nearby * radius);
        const double x = std::min(1.0, std::max(0.0, (detour - shape.detour) / (shape.longDetour - shape.detour)));
        return float(1 - x * x * (3 - 2 * x));
    }

    /// Whether the ball of radius \p reach about node j touches the patch. A ball without extent touches none.
    bool Touches(Index j, float reach, Index patch) const {
        const Eigen::Matrix3Xf &x = graph.graph.position;
        return reach > 0 && (x.col(j) - x.col(patch)).norm() < reach + graph.radius[patch];
    }

    /// The nodes that may influence each free patch. A ball that touches very many patches is made smaller, so that
    /// memory is enough for any graph.
    void FindCandidates(MappingWeights weights, double influence, const Progress &progress) {
        const Index k = graph.Size();
        const std::size_t most = std::max<std::size_t>(64, (1 << 22) / std::size_t(std::max(k, 1))); // patches a ball
        std::vector<Candidate> found;
        std::vector<float> share;
        nearby.resize(k);
        if (weights == MappingWeights::Euclidean)
            FindInBalls(most, found);
        else
            FindAlongSurface(most, influence, progress, found, share);
        std::sort(found.begin(), found.end(), [](const Candidate &a, const Candidate &b) {
            return std::tie(a.patch, a.partial, a.node) < std::tie(b.patch, b.partial, b.node);
        });

        candidates.begin.assign(std::size_t(k) + 1, 0);
        candidates.item.reserve(found.size());
        ball.reserve(found.size());
        std::vector<std::uint32_t> partials(k, 0);
        for (const Candidate &c : found) {
            ++candidates.begin[c.patch + 1];
            partials[c.patch] += c.partial;
            candidates.item.push_back(c.node);
            ball.push_back(BallOf(c.node, reach[c.node]));
        }
        sharesBegin.assign(1, 0);
        for (Index j = 0; j < k; ++j) {
            candidates.begin[j + 1] += candidates.begin[j];
            partial.push_back(candidates.begin[j + 1] - partials[j]);
            sharesBegin.push_back(sharesBegin.back() + std::size_t(partials[j]) * nearby[j].size());
        }
        shares.reserve(sharesBegin.back());
        for (const Candidate &c : found)
            if (c.partial)
                shares.insert(shares.end(), share.begin() + std::ptrdiff_t(c.share),
                              share.begin() + std::ptrdiff_t(c.share + nearby[c.patch].size()));
    }

    void FindInBalls(std::size_t most, std::vector<Candidate> &found) {
        const Index k = graph.Size();
        if (std::size_t(k) > most)
            LimitReach(most);
        // Patches of similar radius at a time, so that a few large ones do not widen the search for all.
        std::map<int, std::vector<Index>> bySize;
        for (Index patch = 0; patch < k; ++patch)
            if (patches.tag[patch] == 1)
                bySize[std::ilogb(std::max(graph.radius[patch], 1e-6f))].push_back(patch);
        std::vector<unsigned> inside;
        std::vector<float> squares;
        for (const auto &size : bySize) {
            NodeTree tree(graph.graph.position, size.second);
            const float widest = std::ldexp(2.f, size.first);
            for (Index j = 0; j < k; ++j) {
                inside.clear();
                squares.clear();
                tree->doQueryDist(tree.Point(graph.graph.position.col(j)), 1.001f * (reach[j] + widest), inside,
                                  squares);
                for (unsigned i : inside)
                    if (Touches(j, reach[j], size.second[i]))
                        found.push_back({size.second[i], j, false, 0});
            }
        }
    }

    /// The patches that chains of touching free patches join to a node, each of them touched by the node's ball, and
    /// how long the way there is from centre to centre (Dijkstra).
    class Chains {
      public:
        explicit Chains(const GraphMapping &mapping) : mapping(mapping), way(mapping.graph.Size(), unreached) {}

        /// Of node j; \p reach is halved until there are at most \p most, none but j's with more than \p most
        /// neighbours, and is 0 where no ball is small enough.
        void Find(Index j, float &reach, std::size_t most) {
            if (FindInside(j, reach, most))
                return;
            reach = LargestReach(j, reach, most);
            FindInside(j, reach, most);
        }

        const std::vector<Index> &Patches() const { return patch; }
        /// Infinite where no chain leads.
        float Way(Index there) const { return way[there]; }

      private:
        using Step = std::pair<float, Index>;

        /// \return whether there are no more than \p most
        bool FindInside(Index j, float reach, std::size_t most) {
            const Eigen::Matrix3Xf &x = mapping.graph.graph.position;
            Start(j);
            while (!heap.empty()) {
                const Step step = Nearest();
                if (step.first > way[step.second])
                    continue;
                if (IsHub(step.second, j, most))
                    return false;
                for (Index next : mapping.graph.graph.adjacency[step.second])
                    if (IsOpen(next, j) && (way[next] < unreached || mapping.Touches(j, reach, next))) {
                        Offer(next, step.first + (x.col(step.second) - x.col(next)).norm());
                        if (patch.size() > most)
                            return false;
                    }
            }
            return true;
        }

        /// The largest half, quarter ... of \p reach that is small enough for Find; \p reach is not. The patches are
        /// visited in the order in which a growing ball takes them in, which bounds their number.
        float LargestReach(Index j, float reach, std::size_t most) {
            Start(j);
            for (std::size_t inside = 0; !heap.empty();) {
                const Step step = Nearest();
                if (step.first > way[step.second])
                    continue;
                if (++inside > most || IsHub(step.second, j, most))
                    return Half(step.first);
                for (Index next : mapping.graph.graph.adjacency[step.second])
                    if (step.first < way[next] && IsOpen(next, j) && mapping.Touches(j, reach, next)) {
                        float least = reach;
                        while (mapping.Touches(j, Half(least), next))
                            least = Half(least);
                        Offer(next, std::max(step.first, least));
                    }
            }
            return reach;
        }

        static float Half(float reach) { return reach > 1e-6f ? 0.5f * reach : 0; }

        /// Whether chains of node j may hold the patch.
        bool IsOpen(Index there, Index j) const {
            return mapping.patches.tag[there] == 1 || mapping.patches.tag[there] == mapping.patches.tag[j];
        }
        /// The middle of a star, whose neighbours would be looked through once for each of them.
        bool IsHub(Index there, Index j, std::size_t most) const {
            return there != j && mapping.graph.graph.adjacency[there].size() > most;
        }

        void Start(Index j) {
            for (Index there : patch)
                way[there] = unreached;
            patch.clear();
            heap.clear();
            Offer(j, 0);
        }
        void Offer(Index there, float length) {
            if (length >= way[there])
                return;
            if (way[there] == unreached)
                patch.push_back(there);
            way[there] = length;
            heap.emplace_back(length, there);
            std::push_heap(heap.begin(), heap.end(), std::greater<Step>());
        }
        Step Nearest() {
            std::pop_heap(heap.begin(), heap.end(), std::greater<Step>());
            const Step step = heap.back();
            heap.pop_back();
            return step;
        }

        static constexpr float unreached = std::numeric_limits<float>::infinity();
        const GraphMapping &mapping;
        std::vector<Index> patch;
        std::vector<float> way; ///< or, for LargestReach, the least reach
        std::vector<Step> heap;
    };

    /// Where two neighbouring vertices lie inside a node's ball, their patches are both on a chain or neither is, so
    /// the set of nodes changes only where their weight is zero. The share of the weight is known at the patches; to
    /// the vertices it is carried by a blend with small balls, which is along the surface down to the size of a patch.
    void FindAlongSurface(std::size_t most, double influence, const Progress &progress, std::vector<Candidate> &found,
                          std::vector<float> &share) {
        const Index k = graph.Size();
        const Eigen::Matrix3Xf &x = graph.graph.position;
        const std::size_t grain = std::size_t(k) / 32 + 1;
        std::vector<std::vector<std::pair<Index, detail::Ball>>> small(k / grain + 1);
        ParallelFor(progress.Slice(0, 0.3), "Preparing the mapping", k, grain,
                    [&](std::size_t first, std::size_t last) {
                        Chains chains(*this);
                        for (Index j = Index(first); j < Index(last); ++j) {
                            if (patches.tag[j] != 1)
                                continue;
                            float radius = reach[j] * float(std::min(1.0, shape.shareBall / influence));
                            chains.Find(j, radius, most);
                            for (Index patch : chains.Patches())
                                small[first / grain].emplace_back(patch, BallOf(j, radius));
                        }
                    });
        for (const auto &part : small)
            for (const auto &each : part)
                nearby[each.first].push_back(each.second);
        for (std::vector<detail::Ball> &balls : nearby)
            if (balls.size() > mostNearby) // the middle of a star: all that is connected counts there
                balls.clear();

        struct Part {
            std::vector<Candidate> found;
            std::vector<float> share;
        };
        std::vector<Part> parts(k / grain + 1);
        ParallelFor(
            progress.Slice(0.3, 1), "Preparing the mapping", k, grain, [&](std::size_t first, std::size_t last) {
                Chains chains(*this);
                Part part;
                for (Index j = Index(first); j < Index(last); ++j) {
                    chains.Find(j, reach[j], most);
                    for (Index patch : chains.Patches()) {
                        if (patches.tag[patch] != 1)
                            continue;
                        float least = 1, greatest = 0;
                        const std::size_t begin = part.share.size();
                        for (const detail::Ball &near : nearby[patch]) {
                            const float way = chains.Way(near.node);
                            // Where the ball of j ends, so does its weight: patches beyond do not matter.
                            const bool all = near.node == j || (std::isinf(way) && !Touches(j, reach[j], near.node));
                            part.share.push_back(
                                all ? 1 : Share(way, (x.col(j) - x.col(near.node)).norm(), reach[j] / influence));
                            least = std::min(least, part.share.back());
                            greatest = std::max(greatest, part.share.back());
                        }
                        if (greatest > 0 || nearby[patch].empty())
                            part.found.push_back({patch, j, least < 1, begin});
                        if (greatest == 0 || least == 1)
                            part.share.resize(begin);
                    }
                }
                parts[first / grain] = std::move(part);
            });
        for (Part &part : parts) {
            for (Candidate &c : part.found) {
                c.share += share.size();
                found.push_back(c);
            }
            share.insert(share.end(), part.share.begin(), part.share.end());
        }
    }

    /// Makes the ball of each node so small that it holds at most \p most other nodes.
    void LimitReach(std::size_t most) {
        NodeTree tree(graph.graph.position);
        vcg::KdTree<float>::PriorityQueue nearest;
        for (Index j = 0; j < graph.Size(); ++j)
            for (std::size_t wanted : {std::size_t(64), most}) { // few of them tell of most nodes that all is well
                tree->doQueryK(tree.Point(graph.graph.position.col(j)), int(wanted) + 1, nearest);
                const float d = std::sqrt(nearest.getTopWeight());
                if (d >= reach[j])
                    break;
                if (wanted == most)
                    reach[j] = std::max(d, 1e-6f);
            }
    }

    /// For each free node the held regions within the fade's width along the surface, and how far they are: the
    /// distance to the nearest border node of the region, handed on from neighbour to neighbour.
    void FindHeldNearby(double fade, const Progress &progress) {
        const Index n = surface.Size();
        struct Border {
            Index tag, node;
        };
        std::vector<Border> border;
        for (Index u = 0; u < n; ++u)
            if (tag[u] != 1)
                for (Index v : surface.adjacency[u])
                    if (tag[v] == 1) {
                        border.push_back({tag[u], u});
                        break;
                    }
        auto width = [&](Index u) {
            const Index j = patches.patchOf[u];
            return patches.tag[j] == 1 ? float(std::min(fade, shape.smallRunOver * std::max(patches.radius[j], 1e-6f)))
                                       : float(fade);
        };
        std::stable_sort(border.begin(), border.end(), [](const Border &a, const Border &b) { return a.tag < b.tag; });
        struct Found {
            Index node;
            Held held;
        };
        struct Offered {
            float distance; // over the width at the source
            Index node, source;
        };
        constexpr std::size_t classes = 256; // of distance; a node may be visited again when a nearer source turns up
        std::vector<std::vector<Offered>> queue(classes);
        std::vector<Found> found;
        std::vector<float> best(n, std::numeric_limits<float>::infinity());
        std::vector<Index> touched;
        std::size_t visits = 0;
        for (std::size_t b = 0; b < border.size();) {
            const Index t = border[b].tag;
            const double done = double(b) / double(border.size());
            heldTag.push_back(t);
            auto spread = [&](Index from, Index source, std::size_t current) {
                const float w = width(source);
                for (Index v : surface.adjacency[from]) {
                    if (tag[v] != 1)
                        continue;
                    const float d = (surface.position.col(v) - surface.position.col(source)).norm() / w;
                    if (d < best[v] && d < 1) {
                        if (std::isinf(best[v]))
                            touched.push_back(v);
                        best[v] = d;
                        queue[std::max(current, std::size_t(classes * d))].push_back({d, v, source});
                    }
                }
            };
            for (; b < border.size() && border[b].tag == t; ++b)
                spread(border[b].node, border[b].node, 0);
            for (std::size_t c = 0; c < classes; ++c) {
                for (std::size_t i = 0; i < queue[c].size(); ++i) {
                    const Offered o = queue[c][i];
                    if ((++visits & 0xffff) == 0)
                        progress(done, "Preparing the mapping");
                    if (o.distance <= best[o.node])
                        spread(o.node, o.source, c);
                }
                queue[c].clear();
            }
            for (Index v : touched) {
                found.push_back({v, {Index(heldTag.size()) - 1, std::max(1e-4f, best[v]), Eigen::Vector3f::Zero()}});
                best[v] = std::numeric_limits<float>::infinity();
            }
            touched.clear();
        }
        heldBegin.assign(std::size_t(n) + 1, 0);
        for (const Found &f : found)
            ++heldBegin[f.node + 1];
        for (Index u = 0; u < n; ++u)
            heldBegin[u + 1] += heldBegin[u];
        held.resize(found.size());
        std::vector<std::uint32_t> end(heldBegin.begin(), heldBegin.end() - 1);
        for (const Found &f : found)
            held[end[f.node]++] = f.held;
    }

    /// The way from the border for each entry of held: straight into the free surface, as the held patches nearby see
    /// it, blended so that it turns smoothly along the border.
    void FindWaysAway(double fade, const Progress &progress) {
        const Index k = graph.Size();
        std::vector<Index> border;
        Eigen::Matrix3Xf inward = Eigen::Matrix3Xf::Zero(3, k);
        for (Index r = 0; r < k; ++r) {
            if (!graph.IsHeld(r))
                continue;
            for (std::uint32_t e = graph.graph.adjacency.begin[r]; e < graph.graph.adjacency.begin[r + 1]; ++e)
                inward.col(r) -= graph.weight[e] * graph.edge.col(e);
            if (!(inward.col(r).norm() > 0))
                continue;
            inward.col(r).normalize();
            border.push_back(r);
        }
        if (border.empty() || held.empty())
            return;
        NodeTree tree(graph.graph.position, border);
        const float reach = float(2 * fade);
        std::vector<std::vector<Index>> nearby(
            k); // of each free patch: the nodes of held patches that its vertices may see
        std::vector<unsigned> inside;
        std::vector<float> squares;
        for (Index j = 0; j < k; ++j) {
            if (graph.IsHeld(j))
                continue;
            inside.clear();
            squares.clear();
            tree->doQueryDist(tree.Point(graph.graph.position.col(j)), reach + graph.radius[j], inside, squares);
            for (unsigned i : inside)
                nearby[j].push_back(border[i]);
            std::sort(nearby[j].begin(), nearby[j].end());
        }
        ParallelFor(
            progress, "Preparing the mapping", surface.Size(), 1 << 12, [&](std::size_t first, std::size_t last) {
                for (std::size_t u = first; u < last; ++u)
                    for (std::uint32_t h = heldBegin[u]; h < heldBegin[u + 1]; ++h) {
                        const Eigen::Vector3f x = surface.position.col(Eigen::Index(u));
                        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
                        for (Index r : nearby[patches.patchOf[u]]) {
                            const float t = 1 - (graph.graph.position.col(r) - x).squaredNorm() / (reach * reach);
                            if (t > 0 && patches.tag[r] == heldTag[held[h].index])
                                sum += t * t * inward.col(r);
                        }
                        const float length = sum.norm();
                        if (length > 0)
                            held[h].away = sum * (held[h].distance * float(fade) / length);
                    }
            });
    }

    const Graph &surface;
    const std::vector<Index> &tag;
    const Patches &patches;
    const DeformationGraph &graph;
    ShapeConstants shape;
    static constexpr std::size_t mostNearby = 64; ///< small balls near a patch
    std::vector<float> reach;
    Csr candidates;                     ///< for each patch, the nodes that may influence it
    std::vector<detail::Ball> ball;     ///< of each candidate
    std::vector<std::uint32_t> partial; ///< for each patch, the first of its candidates that keep a share only
    std::vector<std::vector<detail::Ball>>
        nearby;                           ///< for each patch, the small balls that carry the shares to its vertices
    std::vector<std::size_t> sharesBegin; ///< k + 1 offsets into shares
    std::vector<float> shares;            ///< of each partial candidate: at each ball nearby
    std::vector<Index> heldTag;           ///< the tags of the held regions that have a free neighbour, ascending
    std::vector<std::uint32_t> heldBegin; ///< n + 1 offsets into held
    std::vector<Held> held;
};

} // namespace fcd
} // namespace vcg

#endif
