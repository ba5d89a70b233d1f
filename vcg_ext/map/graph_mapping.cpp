// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/rotation_fit.h>
#include <vcg_ext/map/graph_mapping.h>
#include <vcg_ext/map/mapping_candidates.h>
#include <vcg_ext/map/constraint_blend.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace vcg::fcd {

namespace detail {

static Space SpaceOf(const Frame &frame) {
    Space space;
    Eigen::Map<Eigen::Matrix3d>(space.toFrame) = frame.metric / frame.scale;
    Eigen::Map<Eigen::Matrix3d>(space.fromFrame) = frame.inverseMetric * frame.scale;
    Eigen::Map<Eigen::Matrix3d>(space.metric) = frame.metric;
    Eigen::Map<Eigen::Matrix3d>(space.inverseMetric) = frame.inverseMetric;
    space.isSame = frame.isSame;
    return space;
}

} // namespace detail

GraphMapping::GraphMapping(const Graph &surface, const std::vector<Index> &tag, const Patches &patches,
                           const DeformationGraph &graph, MappingWeights weights, double influence, double fade,
                           const Progress &progress, const ShapeConstants &shape, const BeyondPaper &beyond)
    : surface(surface), tag(tag), patches(patches), graph(graph), isSmooth(beyond.smoothMapping),
      candidates(std::make_unique<MappingCandidates>(patches, graph, weights, isSmooth ? influence : 1,
                                                     progress.Slice(0, 0.2), shape)),
      constraintBlend(std::make_unique<ConstraintBlend>(surface, tag, patches, graph, isSmooth ? fade : 0,
                                                        progress.Slice(0.2, 1), shape)) {}

GraphMapping::~GraphMapping() = default;

/// Calls add(j, weight) for each node j with a weight by Eq. 8 as printed.
template <class Add>
void GraphMapping::ForPrintedWeights(Index node, const Add &add) const {
    const Index patch = patches.patchOf[node];
    for (std::uint32_t c = candidates->nodes.begin[patch]; c < candidates->nodes.begin[patch + 1]; ++c) {
        const detail::Ball &ball = candidates->ball[c];
        const Eigen::Vector3f offset = surface.position.col(node) - Eigen::Map<const Eigen::Vector3f>(ball.center);
        const double left = 1 - std::sqrt(double(offset.squaredNorm()) * ball.inverse);
        if (left > 0)
            add(ball.node, left * left);
    }
}

void GraphMapping::InfluencesAt(Index node, Influences &influences) const {
    influences.nodes.clear();
    influences.held.clear();
    const Index patch = patches.patchOf[node];
    const auto x = surface.position.col(node);
    if (!isSmooth) {
        ForPrintedWeights(node, [&](Index j, double weight) { influences.nodes.emplace_back(j, float(weight)); });
    } else {
        thread_local Posed::Scratch scratch;
        PutCandidates(patch, scratch);
        detail::Blending &b = scratch.blending;
        std::vector<float> &none = scratch.strainTerm; // zeros: only the weights are read
        none.assign(b.n * detail::terms, 0);
        b.term = reinterpret_cast<const float(*)[detail::terms]>(none.data());
        for (int l = 0; l < detail::lanes; ++l)
            for (int d = 0; d < 3; ++d)
                b.x[d][l] = x[d];
        detail::Blend(b);
        for (std::size_t a = 0; a < b.used; ++a)
            if (b.weight[a][0] > 0)
                influences.nodes.emplace_back(b.ball[b.active[a]].node, b.weight[a][0]);
    }
    if (influences.nodes.empty()) // its patch's node has all weight
        influences.nodes.emplace_back(patch, 1.f);
    double sum = 0, total = 1;
    for (const auto &each : influences.nodes)
        sum += double(each.second);
    for (std::size_t h = constraintBlend->begin[node]; h < constraintBlend->begin[node + 1]; ++h) {
        influences.held.emplace_back(constraintBlend->heldTag[constraintBlend->held[h].index],
                                     constraintBlend->held[h].share);
        total += double(constraintBlend->held[h].share);
    }
    for (auto &each : influences.nodes)
        each.second = float(double(each.second) / sum / total);
    for (auto &each : influences.held)
        each.second = float(double(each.second) / total);
}

Eigen::Vector3d GraphMapping::Posed::operator()(Index node, const Eigen::Vector3d &p, Eigen::Matrix3f *linear) const {
    if (mapping.tag[node] != 1) {
        const Eigen::Affine3d &held = motion.at(mapping.tag[node]);
        if (linear)
            *linear = held.linear().cast<float>();
        return held * p;
    }
    thread_local Scratch scratch;
    scratch.vertices.SetRest(0, p);
    Map(&node, 1, linear != nullptr, scratch);
    if (linear)
        *linear = scratch.vertices.Linear(0);
    return scratch.vertices.Moved(0);
}

void GraphMapping::Posed::Map(const Index *node, int count, bool linear, Scratch &scratch) const {
    const Index patch = mapping.patches.patchOf[node[0]];
    detail::Vertices &vertices = scratch.vertices;
    vertices.Fill(count);
    if (!mapping.isSmooth) {
        for (int l = 0; l < detail::lanes; ++l)
            MapAsPrinted(node[std::min(l, count - 1)], l, linear, vertices);
        return;
    }
    mapping.PutCandidates(patch, scratch);
    detail::Blending &b = scratch.blending;
    b.term = reinterpret_cast<const float(*)[detail::terms]>(
        term.data() + std::size_t(mapping.candidates->nodes.begin[patch]) * detail::terms);
    for (int l = 0; l < detail::lanes; ++l)
        for (int d = 0; d < 3; ++d)
            b.x[d][l] = mapping.surface.position(d, node[std::min(l, count - 1)]);
    detail::Blend(b);
    detail::Carry(b, own[patch], space, linear, vertices);
    bool isStrainKnown = false;
    for (int l = 0; l < count; ++l) {
        if (mapping.constraintBlend->begin[node[l]] == mapping.constraintBlend->begin[node[l] + 1])
            continue;
        if (!isStrainKnown)
            SumStrain(scratch);
        isStrainKnown = true;
        RunIntoHeld(node[l], l, linear, scratch);
    }
}

/// Eqs. 7 and 8. If no node has a weight, as at the farthest vertex of a patch, its patch's node has all.
void GraphMapping::Posed::MapAsPrinted(Index node, int lane, bool linear, detail::Vertices &vertices) const {
    const Eigen::Vector3d rest = vertices.Rest(lane);
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
    double total = 0;
    const auto add = [&](Index j, double weight) {
        const Eigen::Map<const Eigen::Matrix3d> nodeTurn(own[j].turn);
        shift += weight * (nodeTurn * (rest - Eigen::Map<const Eigen::Vector3d>(own[j].center)) +
                           Eigen::Map<const Eigen::Vector3d>(own[j].shift));
        turn += weight * nodeTurn;
        total += weight;
    };
    mapping.ForPrintedWeights(node, add);
    if (total == 0)
        add(mapping.patches.patchOf[node], 1);
    vertices.SetMoved(lane, rest + shift / total);
    if (linear)
        vertices.SetLinear(lane, (Eigen::Matrix3d::Identity() + turn / total).cast<float>());
}

/// Sets the candidates of a patch, but not the terms.
void GraphMapping::PutCandidates(Index patch, Posed::Scratch &scratch) const {
    using Scratch = Posed::Scratch;
    const MappingCandidates &all = *candidates;
    const std::uint32_t first = all.nodes.begin[patch], end = all.nodes.begin[patch + 1];
    detail::Blending &b = scratch.blending;
    b.ball = all.ball.data() + first;
    b.n = end - first;
    b.whole = all.partial[patch] - first;
    b.shareBall = all.nearby[patch].data();
    b.share = all.shares.data() + all.sharesBegin[patch];
    b.m = all.nearby[patch].size();
    b.weight = Scratch::Rows(scratch.weight, b.n);
    b.shareWeight = Scratch::Rows(scratch.shareWeight, b.m);
    b.active = Scratch::AtLeast(scratch.active, b.n);
    b.shareActive = Scratch::AtLeast(scratch.shareActive, b.m);
}

/// Sums the nodes' strains by the weights of the blend.
void GraphMapping::Posed::SumStrain(Scratch &scratch) const {
    const detail::Blending &b = scratch.blending;
    auto *strainOf =
        reinterpret_cast<float(*)[detail::terms]>(Scratch::AtLeast(scratch.strainTerm, b.n * detail::terms));
    for (std::size_t a = 0; a < b.used; ++a)
        std::copy_n(nodeStrain[b.ball[b.active[a]].node].data(), 9, strainOf[b.active[a]]);
    detail::SumTerms(b, strainOf, scratch.strain);
}

/// Blends the motion of a vertex with those of the held regions nearby. \pre SumStrain was called
void GraphMapping::Posed::RunIntoHeld(Index node, int lane, bool linear, Scratch &scratch) const {
    detail::Vertices &vertices = scratch.vertices;
    const float blended = scratch.blending.sum[15][lane], inverse = blended > 0 ? 1 / blended : 0;
    Eigen::Matrix3f strain;
    for (int d = 0; d < 9; ++d)
        strain.data()[d] = scratch.strain[d][lane] * inverse;
    const Eigen::Vector3d rest = vertices.Rest(lane);
    const Eigen::Map<const Eigen::Matrix3d> fromFrame(space.fromFrame);
    double total = 1;
    for (std::size_t h = mapping.constraintBlend->begin[node]; h < mapping.constraintBlend->begin[node + 1]; ++h)
        total += mapping.constraintBlend->held[h].share;
    Eigen::Vector3d moved = vertices.Moved(lane) / total;
    Eigen::Matrix3d map = Eigen::Matrix3d::Zero();
    if (linear)
        map = vertices.Linear(lane).cast<double>() / total;
    for (std::size_t h = mapping.constraintBlend->begin[node]; h < mapping.constraintBlend->begin[node + 1]; ++h) {
        // A held region does not stretch, but the surface beside it may: strain times the vector from the border.
        const ConstraintBlend::Held &held = mapping.constraintBlend->held[h];
        const Eigen::Affine3d &regionMotion = *heldMotion[held.index];
        const double share = held.share / total;
        Eigen::Vector3f more = strain * held.away;
        if (!unstretched.empty()) // the held region stretches, too: only the strain beyond its own counts
            more = unstretched[std::size_t(held.index)] * (more + held.away) - held.away;
        moved += share * (regionMotion * (rest + fromFrame * more.cast<double>()));
        map += share * regionMotion.linear();
    }
    vertices.SetMoved(lane, moved);
    if (linear)
        vertices.SetLinear(lane, map.cast<float>());
}

GraphMapping::Posed::Posed(const GraphMapping &mapping, const GraphPose &pose,
                           const std::map<Index, Eigen::Affine3d> &inFrame, const Frame &frame, unsigned threads)
    : mapping(mapping), own(mapping.graph.Size()), nodeStrain(mapping.graph.Size()),
      term(mapping.candidates->nodes.item.size() * detail::terms), space(detail::SpaceOf(frame)) {
    for (const auto &[tag, each] : inFrame)
        motion[tag] = each.matrix().isIdentity(0) ? each : Eigen::Affine3d(frame.FromFrame(each));
    for (Index t : mapping.constraintBlend->heldTag)
        heldMotion.push_back(&motion.at(t));
    if (pose.affine)
        for (Index t : mapping.constraintBlend->heldTag) {
            const Eigen::Matrix3d &linear = inFrame.at(t).linear();
            const Eigen::Matrix3d back = (detail::RotationOf(linear).transpose() * linear).inverse();
            unstretched.emplace_back((back.allFinite() ? back : Eigen::Matrix3d::Identity()).cast<float>());
        }
    ParallelForEach(threads, std::size_t(mapping.graph.Size()), 64, [&](Index j) {
        SetOwn(j, pose, frame);
        SetTerms(j, pose);
    });
}

Eigen::Vector3d GraphMapping::Posed::RestOf(Index j) const {
    return mapping.graph.graph.position.col(j).cast<double>();
}

void GraphMapping::Posed::SetOwn(Index j, const GraphPose &pose, const Frame &frame) {
    const Eigen::Matrix3d turn = pose.linear[j] - Eigen::Matrix3d::Identity();
    Eigen::Map<Eigen::Vector3d>(own[j].center) = frame.FromFrame(RestOf(j));
    Eigen::Map<Eigen::Vector3d>(own[j].shift) =
        Eigen::Map<const Eigen::Matrix3d>(space.fromFrame) * (pose.position.col(j) - RestOf(j));
    Eigen::Map<Eigen::Matrix3d>(own[j].turn) =
        space.isSame ? turn : Eigen::Matrix3d(frame.inverseMetric * turn * frame.metric);
    const Eigen::Matrix3d stretch = detail::RotationOf(pose.linear[j]).transpose() * pose.linear[j];
    nodeStrain[j] = (stretch - Eigen::Matrix3d::Identity()).cast<float>();
}

/// Sets the terms of a patch's candidates.
void GraphMapping::Posed::SetTerms(Index patch, const GraphPose &pose) {
    const Csr &nodes = mapping.candidates->nodes;
    for (std::uint32_t c = nodes.begin[patch]; c < nodes.begin[patch + 1]; ++c) {
        const Index j = nodes.item[c];
        const Eigen::Matrix3d linear = pose.linear[j] - pose.linear[patch];
        const Eigen::Vector3d offset = RestOf(j) - RestOf(patch);
        const Eigen::Vector3d shift =
            pose.position.col(j) - pose.position.col(patch) - 0.5 * (pose.linear[j] + pose.linear[patch]) * offset;
        Eigen::Map<Eigen::Matrix<float, detail::terms, 1>> terms(term.data() + std::size_t(c) * detail::terms);
        terms << linear.col(0).cast<float>(), linear.col(1).cast<float>(), linear.col(2).cast<float>(),
            shift.cast<float>(), offset.cast<float>(), 1.f;
    }
}

} // namespace vcg::fcd
