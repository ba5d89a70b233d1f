// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_MAPPING_H
#define VCG_FCD_GRAPH_MAPPING_H

#include "graph_deformer.h"
#include "handles.h"

namespace vcg {
namespace fcd {

/// What a node of the deformation graph may influence.
enum class MappingWeights {
    Surface,  ///< what is connected to it over free surface inside the ball of its influence
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
    /// \param fade greatest width of the run-over into held regions along the surface, units of the positions; 1.5
    ///        patch radii for held nodes in a patch of free ones
    GraphMapping(const Graph &surface, const std::vector<Index> &tag, const Patches &patches,
                 const DeformationGraph &graph, MappingWeights weights, double influence, double fade,
                 const Progress &progress = {})
        : surface(surface), tag(tag), patches(patches), graph(graph) {
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
        progress(0, "Preparing the mapping");
        FindCandidates(weights);
        progress(0.2, "Preparing the mapping");
        FindHeldNearby(fade, progress.Slice(0.2, 1));
    }

    /// The mapping of one pose: a function of a surface node and the position of a vertex there (frame units).
    class Posed {
      public:
        Eigen::Vector3d operator()(Index node, const Eigen::Vector3d &p) const {
            if (mapping.tag[node] != 1)
                return motion.at(mapping.tag[node]) * p;
            const Index patch = mapping.patches.patchOf[node];
            const Eigen::Vector3f x = mapping.surface.position.col(node);
            // What the candidates' motions differ by from that of the vertex's own patch is small, and float is enough.
            Difference blend = Difference::Zero();
            Eigen::Vector3f offset = Eigen::Vector3f::Zero(); // from x to the mean of the candidates
            float total = 0;
            for (std::uint32_t c = mapping.candidates.begin[patch]; c < mapping.candidates.begin[patch + 1]; ++c) {
                const Ball &ball = mapping.ball[c];
                const Eigen::Vector3f way = Eigen::Vector3f(ball.x, ball.y, ball.z) - x;
                const float u = 1 - way.squaredNorm() * ball.inverse;
                if (!(u > 0))
                    continue;
                const float w = Kernel(u);
                blend += w * difference[c];
                offset += w * way;
                total += w;
            }
            Eigen::Vector3d sum = own[patch] * p;
            if (total > 0) { // else no ball reaches here, as around an isolated vertex
                const Eigen::Vector3f center = mapping.graph.graph.position.col(patch);
                const Eigen::Vector3f local =
                    (p - center.cast<double>()).cast<float>() - 0.5f * (x - center + offset / total);
                sum += ((local[0] * blend.segment<3>(0) + local[1] * blend.segment<3>(3) +
                         local[2] * blend.segment<3>(6) + blend.segment<3>(9)) /
                        total)
                           .cast<double>();
            }
            double weight = 1;
            for (std::uint32_t h = mapping.heldBegin[node]; h < mapping.heldBegin[node + 1]; ++h) {
                // s falls from 1 at the held region to 0 at the end of the fade; s / (1 - s) grows beyond all bounds.
                const double s = Falloff(mapping.held[h].distance);
                sum += s / (1 - s) * (heldMotion[mapping.held[h].index] * p);
                weight += s / (1 - s);
            }
            return sum / weight;
        }

      private:
        friend class GraphMapping;
        using Difference = Eigen::Matrix<float, 12, 1>; // columns of a 3 x 4 affine map, about the patch's centre

        Posed(const GraphMapping &mapping, const GraphPose &pose, const std::map<Index, Eigen::Affine3d> &motion)
            : mapping(mapping), motion(motion), own(mapping.graph.Size()), difference(mapping.candidates.item.size()) {
            for (Index t : mapping.heldTag)
                heldMotion.push_back(motion.at(t));
            const auto rest = [&](Index j) { return mapping.graph.graph.position.col(j).cast<double>(); };
            for (Index j = 0; j < mapping.graph.Size(); ++j) {
                own[j] = Eigen::Affine3d::Identity();
                own[j].linear() = pose.linear[j];
                own[j].translation() = pose.position.col(j) - pose.linear[j] * rest(j);
            }
            for (Index patch = 0; patch < mapping.graph.Size(); ++patch)
                for (std::uint32_t c = mapping.candidates.begin[patch]; c < mapping.candidates.begin[patch + 1]; ++c) {
                    const Index j = mapping.candidates.item[c];
                    const Eigen::Matrix3d linear = pose.linear[j] - pose.linear[patch];
                    const Eigen::Vector3d shift =
                        0.5 * (pose.linear[j] + pose.linear[patch]) * (rest(patch) - rest(j)) + pose.position.col(j) -
                        pose.position.col(patch);
                    difference[c] << linear.col(0).cast<float>(), linear.col(1).cast<float>(),
                        linear.col(2).cast<float>(), shift.cast<float>();
                }
        }

        const GraphMapping &mapping;
        const std::map<Index, Eigen::Affine3d> &motion;
        std::vector<Eigen::Affine3d> heldMotion; // of each of mapping.heldTag
        std::vector<Eigen::Affine3d> own;
        std::vector<Difference, Eigen::aligned_allocator<Difference>> difference; // of each candidate
    };

    /// \param motion of each held tag, 0 included; must outlive the result, as the mapping must
    Posed At(const GraphPose &pose, const std::map<Index, Eigen::Affine3d> &motion) const {
        return Posed(*this, pose, motion);
    }

    /// Weight of a node at u = 1 - (distance / reach)^2. Like Eq. 8 it falls from 1 at the node to 0 at its reach, but
    /// without the cone's tip that (1 - r)^2 has at the node and the jump in curvature at its end: both show as
    /// ripples.
    static float Kernel(float u) { return u * u * u; }

  private:
    struct Ball {
        float x, y, z, inverse; // the node's position, 1 / reach^2
    };
    struct Held {
        Index index;    ///< in heldTag
        float distance; ///< to the held region over the fade's width, (0, 1)
    };

    /// From 1 at x = 0, where it is level, to 0 at x = 1 with two continuous derivatives. It leaves 1 soon: what it
    /// multiplies grows with x, and this shape keeps the curvature of the product low.
    static double Falloff(double x) {
        const double level = 0.1, y = x * x * (1 + level) / (x + level), y2 = y * y;
        return 1 - y * (15 - y2 * (10 - 3 * y2)) / 8;
    }

    /// The nodes that may influence each free patch. Along the surface: those from which a chain of touching free
    /// patches leads there, each of which the node's ball touches. Where two neighbouring vertices lie inside the ball,
    /// their patches are both on the chain or neither is, so the set of nodes changes only where their weight is zero.
    /// A ball that touches very many patches is made smaller, so that memory is enough for any graph.
    void FindCandidates(MappingWeights weights) {
        const Index k = graph.Size();
        const std::size_t most = std::max<std::size_t>(64, (1 << 22) / std::size_t(k)); // patches a ball
        auto position = [&](Index j) { return graph.graph.position.col(j); };
        auto touches = [&](Index j, Index patch) {
            return (position(j) - position(patch)).norm() < reach[j] + graph.radius[patch];
        };
        std::vector<std::pair<Index, Index>> pair; // patch, node
        if (weights == MappingWeights::Euclidean) {
            if (std::size_t(k) > most)
                LimitReach(most);
            // Patches of similar radius at a time, so that a few large ones do not widen the search for all.
            std::map<int, std::vector<Index>> bySize;
            for (Index patch = 0; patch < k; ++patch)
                if (patches.tag[patch] == 1)
                    bySize[std::ilogb(std::max(graph.radius[patch], 1e-6f))].push_back(patch);
            std::vector<unsigned> found;
            std::vector<float> squares;
            for (const auto &size : bySize) {
                NodeTree tree(graph.graph.position, size.second);
                const float widest = std::ldexp(2.f, size.first);
                for (Index j = 0; j < k; ++j) {
                    found.clear();
                    squares.clear();
                    tree->doQueryDist(tree.Point(position(j)), 1.001f * (reach[j] + widest), found, squares);
                    for (unsigned f : found)
                        if (touches(j, size.second[f]))
                            pair.emplace_back(size.second[f], j);
                }
            }
        } else {
            std::vector<Index> seen(k, -1), queue;
            for (Index j = 0; j < k;) {
                const Index own = patches.tag[j];
                queue.assign(1, j);
                seen[j] = j;
                for (std::size_t q = 0; q < queue.size() && queue.size() <= most; ++q)
                    for (Index next : graph.graph.adjacency[queue[q]]) {
                        const Index there = patches.tag[next];
                        if (seen[next] != j && (there == 1 || there == own) && touches(j, next)) {
                            seen[next] = j;
                            queue.push_back(next);
                            if (queue.size() > most)
                                break;
                        }
                    }
                if (queue.size() > most) {
                    for (Index patch : queue)
                        seen[patch] = -1;
                    reach[j] *= 0.5f;
                    continue;
                }
                for (Index patch : queue)
                    if (patches.tag[patch] == 1)
                        pair.emplace_back(patch, j);
                ++j;
            }
        }
        std::sort(pair.begin(), pair.end());
        candidates.begin.assign(std::size_t(k) + 1, 0);
        candidates.item.reserve(pair.size());
        for (const auto &p : pair) {
            ++candidates.begin[p.first + 1];
            candidates.item.push_back(p.second);
        }
        for (Index j = 0; j < k; ++j)
            candidates.begin[j + 1] += candidates.begin[j];
        ball.reserve(pair.size());
        for (Index j : candidates.item)
            ball.push_back({graph.graph.position(0, j), graph.graph.position(1, j), graph.graph.position(2, j),
                            1 / (reach[j] * reach[j])});
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
            return patches.tag[j] == 1 ? float(std::min(fade, 1.5 * std::max(patches.radius[j], 1e-6f))) : float(fade);
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
                found.push_back({v, {Index(heldTag.size()) - 1, std::max(1e-4f, best[v])}});
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

    const Graph &surface;
    const std::vector<Index> &tag;
    const Patches &patches;
    const DeformationGraph &graph;
    std::vector<float> reach;
    Csr candidates;                       ///< for each patch, the nodes that may influence it
    std::vector<Ball> ball;               ///< of each candidate
    std::vector<Index> heldTag;           ///< the tags of the held regions that have a free neighbour, ascending
    std::vector<std::uint32_t> heldBegin; ///< n + 1 offsets into held
    std::vector<Held> held;
};

} // namespace fcd
} // namespace vcg

#endif
