// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/elementary.h>
#include <vcg_ext/map/kept_volume.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace vcg::fcd {

namespace {

using Face = KeptVolume::Face;

/// The most places of a patch: as many vertices as are mapped at a time.
constexpr std::size_t mostPlaces = detail::lanes;

/// Largest area of the caps over loops with free nodes, over the area of the faces. It is a quarter for a tube as long
/// as wide with one open end, a half for a hemisphere, and all for a sheet.
constexpr double mostOpen = 0.25;

/// The least volume that is kept, over that of a cube of the same area. A plate has it if it is about a thousandth as
/// thick as wide. The two sides of a sheet enclose only rounding errors.
constexpr double leastVolume = 1e-3;

/// Tolerance of a volume, as a share of it: nobody sees a thousandth.
constexpr double volumeError = 1e-3;
constexpr int mostSteps = 3;

/// The largest move outwards and inwards, over volume / area, which is half the radius of a limb.
constexpr double mostOut = 2, mostIn = 1;

/// Smoothing passes over neighbours: of strain, which differs from patch to patch, then of each node's direction.
constexpr int evenedStrain = 8, evenedDirection = 2;

Eigen::Vector3d AreaOf(const Eigen::Vector3d &a, const Eigen::Vector3d &b, const Eigen::Vector3d &c) {
    return 0.5 * (b - a).cross(c - a);
}

/// The boundary edges of faces, reversed, as caps without a middle; repeated as often as faces have them unpaired.
std::vector<Face> BoundOf(const std::vector<Face> &faces) {
    struct Edge {
        Index from, to, sign; // from < to; sign: -1 if the face has it from `to` to `from`
        bool operator<(const Edge &o) const { return from != o.from ? from < o.from : to < o.to; }
    };
    std::vector<Edge> edges;
    for (const Face &f : faces)
        for (std::size_t i = 0; i < 3; ++i) {
            const Index a = f[i], b = f[(i + 1) % 3];
            edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
        }
    std::sort(edges.begin(), edges.end());
    std::vector<Face> bound;
    for (std::size_t first = 0, next; first < edges.size(); first = next) {
        Index net = 0;
        for (next = first; next < edges.size() && !(edges[first] < edges[next]); ++next)
            net += edges[next].sign;
        const Face cap =
            net > 0 ? Face{edges[first].to, edges[first].from, -1} : Face{edges[first].from, edges[first].to, -1};
        bound.insert(bound.end(), std::size_t(std::abs(net)), cap);
    }
    return bound;
}

/// The volume within faces and caps. \param at 3 x places \param change if not null: 3 x places; the gradient of the
/// volume is added
double VolumeOf(const std::vector<Face> &faces, const std::vector<std::vector<Face>> &caps, const Eigen::Matrix3Xd &at,
                Eigen::Matrix3Xd *change = nullptr) {
    const Eigen::Vector3d middle = at.col(faces.front()[0]); // an origin near the part, for less rounding
    const auto from = [&](Index p) { return Eigen::Vector3d(at.col(p) - middle); };
    double six = 0;
    for (const Face &f : faces) {
        const Eigen::Vector3d a = from(f[0]), b = from(f[1]), c = from(f[2]), normal = b.cross(c);
        six += a.dot(normal);
        if (change) {
            change->col(f[0]) += normal / 6;
            change->col(f[1]) += c.cross(a) / 6;
            change->col(f[2]) += a.cross(b) / 6;
        }
    }
    for (const std::vector<Face> &cap : caps) {
        Eigen::Vector3d top = Eigen::Vector3d::Zero(), normals = Eigen::Vector3d::Zero();
        for (const Face &f : cap) {
            top += from(f[0]) / double(cap.size());
            normals += from(f[0]).cross(from(f[1]));
        }
        six += top.dot(normals);
        if (change)
            for (const Face &f : cap) {
                change->col(f[0]) += (from(f[1]).cross(top) + normals / double(cap.size())) / 6;
                change->col(f[1]) += top.cross(from(f[0])) / 6;
            }
    }
    return six / 6;
}

} // namespace

KeptVolume::KeptVolume(const std::vector<Face> &faces, const Graph &surface, const std::vector<Index> &tag,
                       const Patches &patches) {
    if (faces.empty()) {
        open = 1;
        return;
    }
    const std::vector<Index> placeOf = FindPlaces(surface, tag, patches);
    const auto isFree = [&](Index p) { return place[std::size_t(p)].tag == 1; };
    std::vector<Face> all; // numbers of places
    DisjointSets joined(Index(place.size()));
    for (std::size_t p = 1; p < place.size(); ++p)
        if (isFree(Index(p)) && isFree(Index(p - 1)) && place[p].patch == place[p - 1].patch)
            joined.Join(Index(p - 1), Index(p));
    for (const Face &each : faces) {
        const Face f{placeOf[std::size_t(each[0])], placeOf[std::size_t(each[1])], placeOf[std::size_t(each[2])]};
        if (*std::min_element(f.begin(), f.end()) < 0 || f[0] == f[1] || f[1] == f[2] || f[2] == f[0])
            continue;
        all.push_back(f);
        for (std::size_t i = 0; i < 3; ++i)
            if (isFree(f[i]) && isFree(f[(i + 1) % 3]))
                joined.Join(f[i], f[(i + 1) % 3]);
    }
    std::map<Index, Body> found; // by the first of its free places
    for (std::size_t p = 0; p < place.size(); ++p)
        if (isFree(Index(p)))
            found[joined.Root(Index(p))];
    for (const Face &f : all)
        found[joined.Root(*std::find_if(f.begin(), f.end(), isFree))].face.push_back(f);
    Eigen::Matrix3Xd rest(3, Eigen::Index(place.size()));
    for (std::size_t p = 0; p < place.size(); ++p)
        rest.col(Eigen::Index(p)) = place[p].rest;
    std::map<Index, Index> number;
    for (auto &[first, body] : found) {
        const bool isClosed = Close(body);
        body.rest = body.face.empty() ? 0 : VolumeOf(body.face, body.caps, rest);
        const double side = std::sqrt(body.area / 6); // of a cube of this area
        if (!isClosed || !(std::abs(body.rest) > leastVolume * side * side * side)) {
            ++open;
            continue;
        }
        number[first] = Index(bodies.size());
        bodies.push_back(std::move(body));
    }
    bodyOf.assign(std::size_t(patches.Size()), -1);
    for (std::size_t p = 0; p < place.size(); ++p)
        if (isFree(Index(p)))
            if (const auto body = number.find(joined.Root(Index(p))); body != number.end())
                bodyOf[std::size_t(place[p].patch)] = body->second;
}

std::vector<Index> KeptVolume::FindPlaces(const Graph &surface, const std::vector<Index> &tag, const Patches &patches) {
    std::vector<std::vector<Index>> nodes(std::size_t(patches.Size())); // of each patch, in Morton order
    for (Index u = 0; u < surface.Size(); ++u)
        if (patches.patchOf[std::size_t(u)] >= 0)
            nodes[std::size_t(patches.patchOf[std::size_t(u)])].push_back(u);
    std::vector<Index> placeOf(std::size_t(surface.Size()), -1);
    for (std::size_t j = 0; j < nodes.size(); ++j) {
        std::vector<Index> &ofPatch = nodes[j];
        const auto add = [&](std::size_t first, std::size_t end) {
            const Index u = ofPatch[(first + end) / 2];
            for (std::size_t i = first; i < end; ++i)
                placeOf[std::size_t(ofPatch[i])] = Index(place.size());
            place.push_back({u, Index(j), tag[std::size_t(u)], surface.position.col(u).cast<double>()});
        };
        // Each node of a small held part in the patch is a place of its own.
        const auto others = std::stable_partition(ofPatch.begin(), ofPatch.end(),
                                                  [&](Index u) { return tag[std::size_t(u)] == patches.tag[j]; });
        const auto own = std::size_t(others - ofPatch.begin());
        const std::size_t count = std::min(own, mostPlaces);
        for (std::size_t s = 0; s < count; ++s)
            add(own * s / count, own * (s + 1) / count);
        for (std::size_t i = own; i < ofPatch.size(); ++i)
            add(i, i + 1);
    }
    return placeOf;
}

bool KeptVolume::Close(Body &body) const {
    const auto at = [&](Index p) -> const Eigen::Vector3d & { return place[std::size_t(p)].rest; };
    double openArea = 0;
    for (const Face &f : body.face)
        body.area += AreaOf(at(f[0]), at(f[1]), at(f[2])).norm();
    const std::vector<Face> bound = BoundOf(body.face);
    std::map<Index, Index> number; // of the places on the boundary
    for (const Face &f : bound)
        number.emplace(f[0], Index(number.size()));
    DisjointSets loops(Index(number.size())); // each edge begins where another ends
    for (const Face &f : bound)
        loops.Join(number.at(f[0]), number.at(f[1]));
    std::map<Index, std::vector<Face>> ofLoop;
    for (const Face &f : bound)
        ofLoop[loops.Root(number.at(f[0]))].push_back(f);
    for (auto &[first, loop] : ofLoop) {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (const Face &f : loop)
            middle += at(f[0]) / double(loop.size());
        for (const Face &f : loop)
            if (place[std::size_t(f[0])].tag == 1 || place[std::size_t(f[1])].tag == 1)
                openArea += AreaOf(at(f[0]), at(f[1]), middle).norm();
        body.caps.push_back(std::move(loop));
    }
    return body.area > 0 && openArea <= mostOpen * body.area;
}

void KeptVolume::Map(const GraphMapping::Posed &mapped, Eigen::Matrix3Xd &at) const {
    GraphMapping::Posed::Scratch scratch;
    Index node[detail::lanes];
    for (std::size_t first = 0, next; first < place.size(); first = next) {
        const Place &one = place[first];
        next = first + 1;
        if (one.tag != 1) {
            at.col(Eigen::Index(first)) = mapped(one.node, one.rest);
            continue;
        }
        while (next < place.size() && place[next].tag == 1 && place[next].patch == one.patch)
            ++next;
        for (std::size_t p = first; p < next; ++p) {
            node[p - first] = place[p].node;
            scratch.vertices.SetRest(int(p - first), place[p].rest);
        }
        mapped.Map(node, int(next - first), false, scratch);
        for (std::size_t p = first; p < next; ++p)
            at.col(Eigen::Index(p)) = scratch.vertices.Moved(int(p - first));
    }
}

/// Moves each column half-way to the mean of its neighbours in the same part, \p times times.
Eigen::MatrixXd KeptVolume::Evened(const DeformationGraph &graph, Eigen::MatrixXd column, int times) const {
    for (; times > 0; --times) {
        const Eigen::MatrixXd before = column;
        for (Index j = 0; j < graph.Size(); ++j) {
            Eigen::VectorXd sum = Eigen::VectorXd::Zero(column.rows());
            double all = 0;
            for (std::uint32_t e = graph.graph.adjacency.begin[std::size_t(j)];
                 e < graph.graph.adjacency.begin[std::size_t(j) + 1]; ++e)
                if (const Index i = graph.graph.adjacency.item[e]; bodyOf[std::size_t(i)] == bodyOf[std::size_t(j)]) {
                    sum += double(graph.weight[e]) * before.col(i);
                    all += double(graph.weight[e]);
                }
            if (bodyOf[std::size_t(j)] >= 0 && all > 0)
                column.col(j) = 0.5 * (before.col(j) + sum / all);
        }
    }
    return column;
}

Eigen::Matrix3Xd KeptVolume::Bulge(const DeformationGraph &graph, const PartsDeformer &parts, const GraphPose &pose,
                                   const Eigen::Matrix3Xd &push) const {
    const Index k = graph.Size();
    // Even pressure on a plate: the move begins smoothly at held nodes.
    Eigen::VectorXd pressure = Eigen::VectorXd::Zero(k);
    // The rms change of length of a node's edges, over their rms length.
    Eigen::MatrixXd strain = Eigen::MatrixXd::Zero(1, k);
    Eigen::Matrix3Xd out = Eigen::Matrix3Xd::Zero(3, k);
    for (Index j = 0; j < k; ++j) {
        const double size = push.col(j).norm();
        if (bodyOf[std::size_t(j)] < 0 || !(size > 0))
            continue;
        pressure[j] = size;
        out.col(j) = push.col(j) / size;
        double off = 0, all = 0;
        for (std::uint32_t e = graph.graph.adjacency.begin[std::size_t(j)];
             e < graph.graph.adjacency.begin[std::size_t(j) + 1]; ++e) {
            const Index i = graph.graph.adjacency.item[e];
            const double length = double((graph.graph.position.col(i) - graph.graph.position.col(j)).norm()),
                         now = (pose.position.col(i) - pose.position.col(j)).norm();
            off += double(graph.weight[e]) * detail::Squared(now - length);
            all += double(graph.weight[e]) * detail::Squared(length);
        }
        strain(0, j) = all > 0 ? std::sqrt(off / all) : 0;
    }
    strain = Evened(graph, strain, evenedStrain);
    // A plate would move without bound along a free limb: the mean move of strained nodes is the limit.
    const Eigen::RowVectorXd plate = parts.Spread(pressure).cwiseMax(0).transpose();
    const double far = plate.dot(strain.row(0)) / std::max(strain.sum(), 1e-300);
    const Eigen::RowVectorXd much = strain.row(0).array() * plate.array() / (plate.array() + std::max(far, 1e-300));
    return Evened(graph, out * much.asDiagonal(), evenedDirection);
}

double KeptVolume::Keep(const DeformationGraph &graph, const PartsDeformer &parts, const GraphMapping &mapping,
                        const std::map<Index, Eigen::Affine3d> &motion, const std::function<void(GraphPose &)> &fit,
                        GraphPose &pose) const {
    struct Growth {
        double step = 0, volume = 0;           // last step along the direction; volume at the best step
        double best = 0, off = 0;              // the step with the smallest error of the volume, and that error
        double slope = 0, least = 0, most = 0; // of the volume by the step; limits of the step
    };
    if (bodies.empty())
        return 0;
    std::vector<Growth> growth(bodies.size());
    Eigen::Matrix3Xd at(3, Eigen::Index(place.size())), change = Eigen::Matrix3Xd::Zero(3, at.cols()), direction;
    const Eigen::Matrix3Xd before = pose.position;
    const auto go = [&](double Growth::*step) {
        for (Eigen::Index j = 0; j < direction.cols(); ++j)
            if (const Index b = bodyOf[std::size_t(j)]; b >= 0)
                pose.position.col(j) = before.col(j) + growth[std::size_t(b)].*step * direction.col(j);
    };
    double off = 0; // largest error of a volume, over the volume
    for (int step = 0; step <= mostSteps; ++step) {
        GraphPose fitted = pose;
        fit(fitted);
        Map(GraphMapping::Posed(mapping, fitted, motion, {}, 1), at);
        off = 0;
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            Growth &now = growth[b];
            const double volume = VolumeOf(bodies[b].face, bodies[b].caps, at, step == 0 ? &change : nullptr),
                         left = std::abs(volume - bodies[b].rest);
            if (step > 0 && now.step != now.best)
                now.slope = (volume - now.volume) / (now.step - now.best);
            if (step == 0 || left < now.off) {
                now.best = now.step;
                now.off = left;
                now.volume = volume;
            }
            off = std::max(off, now.off / std::abs(bodies[b].rest));
        }
        if (off <= volumeError || step == mostSteps)
            break;
        if (step == 0) {
            Eigen::Matrix3Xd push = Eigen::Matrix3Xd::Zero(3, pose.position.cols());
            for (std::size_t p = 0; p < place.size(); ++p)
                if (place[p].tag == 1)
                    push.col(place[p].patch) += change.col(Eigen::Index(p));
            direction = Bulge(graph, parts, pose, push);
            std::vector<double> farthest(bodies.size(), 0);
            for (Eigen::Index j = 0; j < direction.cols(); ++j)
                if (const Index b = bodyOf[std::size_t(j)]; b >= 0) {
                    growth[std::size_t(b)].slope += push.col(j).dot(direction.col(j));
                    farthest[std::size_t(b)] = std::max(farthest[std::size_t(b)], direction.col(j).norm());
                }
            for (std::size_t b = 0; b < bodies.size(); ++b) {
                const double unit = bodies[b].rest / bodies[b].area / std::max(farthest[b], 1e-300); // < 0: inside out
                growth[b].least = std::min(-mostIn * unit, mostOut * unit);
                growth[b].most = std::max(-mostIn * unit, mostOut * unit);
            }
        }
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            Growth &now = growth[b];
            const double next = now.best + (bodies[b].rest - now.volume) / now.slope;
            const bool isNext = now.off > volumeError * std::abs(bodies[b].rest) && std::isfinite(next);
            now.step = isNext ? std::clamp(next, now.least, now.most) : now.best;
        }
        go(&Growth::step);
    }
    if (direction.size() > 0)
        go(&Growth::best);
    return off;
}

} // namespace vcg::fcd
