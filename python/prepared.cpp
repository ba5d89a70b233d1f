// SPDX-License-Identifier: GPL-3.0-or-later
#include "prepared.h"

#include <vcg_ext/base/point_tree.h>
#include <vcg_ext/surface/face_normals.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <mutex>
#include <set>

using vcg::fcd::DeformationGraph;
using vcg::fcd::Deformer;
using vcg::fcd::Index;
using vcg::fcd::ParallelFor;
using vcg::fcd::Progress;

namespace {

std::shared_ptr<const Deformer> deformerOf(const Prepared &prepared, const Progress &progress,
                                           const Deformer *kept = nullptr) {
    return vcg::fcd::PrepareDeformer(prepared.view, prepared.handles, prepared.param, progress, kept);
}

} // namespace

vcg::fcd::SurfaceView viewOf(const Rows &vertices, const std::optional<Corners> &faces) {
    vcg::fcd::SurfaceView view;
    view.position = vertices.data();
    view.vertexSlots = vertices.shape(0);
    if (faces) {
        view.corner = faces->data();
        view.faces = faces->shape(0);
    }
    view.isCloud = view.faces == 0;
    return view;
}

Prepared::Prepared(const Rows &vertices, const std::optional<Corners> &faces,
                   const Given<std::int32_t, nb::ndim<1>> &tags, const Given<std::int64_t, nb::ndim<1>> &points,
                   const vcg::fcd::DeformationParam &param, unsigned threads, const nb::object &report,
                   const Prepared *kept)
    : vertices(vertices), faces(faces), param(param), threads(threads) {
    handles.tag.assign(tags.data(), tags.data() + tags.shape(0));
    for (std::size_t k = 0; k < points.shape(0); ++k)
        handles.point.push_back({std::size_t(points.data()[k]), Eigen::Vector3d::Zero()});
    prepare(report, [kept](const Prepared &prepared, const Progress &progress) {
        return deformerOf(prepared, progress, kept ? kept->deformer.get() : nullptr);
    });
}

Prepared::Prepared(const Rows &vertices, const std::optional<Corners> &faces, const vcg::fcd::DeformationParam &param,
                   unsigned threads, const nb::object &report)
    : vertices(vertices), faces(faces), param(param), threads(threads) {
    handles.tag.assign(vertices.shape(0), 1);
    prepare(report, [](const Prepared &prepared, const Progress &progress) { return deformerOf(prepared, progress); });
}

Prepared::Prepared(const Rows &vertices, const std::optional<Corners> &faces,
                   const Given<std::int32_t, nb::ndim<1>> &tags, const vcg::fcd::DeformationParam &param,
                   unsigned threads, const nb::object &report, const Make &make)
    : vertices(vertices), faces(faces), param(param), threads(threads) {
    handles.tag.assign(tags.data(), tags.data() + tags.shape(0));
    prepare(report, make);
}

void Prepared::prepare(const nb::object &report, const Make &make) {
    view = viewOf(vertices, faces);
    Listener::Run(report, threads, [&](const Progress &progress) {
        const vcg::fcd::Stopwatch watch;
        param.Validate();
        view.Validate(progress.Slice(0, 0.02));
        tags = param.bendsUnheld ? vcg::fcd::CountTags(handles.tag, nullptr)
                                 : vcg::fcd::CountHandles(handles, view.vertexSlots, nullptr);
        deformer = make(*this, progress.Slice(0.02, 1));
        findStill(progress);
        std::mutex lock; // for box
        ParallelFor(threads, view.vertexSlots, 1 << 16, [&](std::size_t first, std::size_t last) {
            Eigen::AlignedBox3d part;
            for (std::size_t i = first; i < last; ++i)
                if (view.At(i).allFinite())
                    part.extend(Eigen::Vector3d(view.At(i)));
            const std::lock_guard<std::mutex> guard(lock);
            box.extend(part);
        });
        seconds = watch.Seconds();
    });
}

void Prepared::findStill(const Progress &progress) {
    std::vector<char> moves(view.vertexSlots, 0);
    deformer->ForMoving([&](std::size_t slot) { moves[slot] = 1; });
    still = vcg::fcd::NumbersThat<std::uint32_t>(progress.Slice(1, 1), "Preparing the mapping", moves.size(),
                                                 [&](std::size_t slot) { return !moves[slot]; });
}

nb::tuple Prepared::graph() const {
    const auto k = std::size_t(deformer->Nodes());
    double *node, *center, *radius;
    nb::object nodes = newArray({k, 3}, node), centers = newArray({k, 3}, center), radii = newArray({k}, radius);
    std::vector<std::array<std::int32_t, 2>> edge;
    std::int32_t first = 0;
    for (const auto &region : deformer->regions) {
        const vcg::fcd::Frame &frame = region->surface.frame;
        const DeformationGraph &graph = region->graph;
        for (Index j = 0; j < graph.Size(); ++j) {
            const Index at = region->patches.center[std::size_t(j)];
            const auto number = std::size_t(first + j);
            rowOf(node, number) = frame.FromFrame(graph.graph.position.col(j).cast<double>());
            rowOf(center, number) = frame.FromFrame(region->surface.graph.position.col(at).cast<double>());
            radius[number] = double(graph.radius[std::size_t(j)]) * frame.scale;
            for (Index i : graph.graph.adjacency[j])
                if (j < i)
                    edge.push_back({first + j, first + i});
        }
        first += graph.Size();
    }
    std::int32_t *pair;
    nb::object edges = newArray({edge.size(), 2}, pair);
    for (const auto &each : edge)
        pair = std::copy(each.begin(), each.end(), pair);
    return nb::make_tuple(nodes, edges, radii, centers);
}

nb::object Prepared::patchOf() const {
    std::int32_t *patch;
    nb::object patches = newArray({view.vertexSlots}, patch);
    const nb::gil_scoped_release release;
    const std::vector<std::int32_t> first = firstNodes();
    for (std::size_t i = 0; i < view.vertexSlots; ++i) {
        const auto place = deformer->At(i);
        const Index own = place.region ? place.region->patches.patchOf[std::size_t(place.node)] : -1;
        patch[i] = own < 0 ? -1 : first[place.number] + own;
    }
    return patches;
}

std::vector<std::int32_t> Prepared::firstNodes() const {
    std::vector<std::int32_t> first(1, 0);
    for (const auto &region : deformer->regions)
        first.push_back(first.back() + region->graph.Size());
    return first;
}

nb::tuple Prepared::weights(const nb::object &report) const {
    // The columns: nodes, held tags (0 first), landmarks.
    const std::vector<std::int32_t> first = firstNodes();
    std::set<Index> tagged{0};
    std::map<Index, std::int32_t> ofTag;
    std::map<std::size_t, std::int32_t> ofPoint;                                 // by slot
    std::vector<std::map<Index, std::int32_t>> column(deformer->regions.size()); // of each region's tags
    const auto findColumns = [&] {
        for (int tag : handles.tag)
            if (tag != 1)
                tagged.insert(std::max(0, tag));
        std::int32_t next = first.back();
        for (Index tag : tagged)
            ofTag[tag] = next++;
        for (const auto &point : handles.point)
            ofPoint[point.vertex] = next++;
        for (std::size_t r = 0; r < column.size(); ++r) {
            const vcg::fcd::RegionDeformer &region = deformer->Region(r);
            column[r] = ofTag;
            for (std::size_t p = 0; p < region.Points().size(); ++p)
                column[r][region.held.pointTag[p]] = ofPoint.at(region.Points()[p]);
            for (std::size_t s = 0; s < region.held.original.size(); ++s)
                if (region.held.original[s] >= 0)
                    column[r][-1 - Index(s)] = ofTag.at(region.held.original[s]);
        }
    };

    constexpr std::size_t grain = 1 << 12;
    struct Part {
        std::vector<std::int32_t> count, item;
        std::vector<float> weight;
    };
    std::vector<Part> parts((view.vertexSlots + grain - 1) / grain);
    const auto of = [&](std::size_t i, vcg::fcd::GraphMapping::Influences &influences, Part &part) {
        const vcg::fcd::MovingSurface::Place place = deformer->At(i);
        const std::size_t before = part.item.size();
        const auto add = [&](std::int32_t item, float weight) {
            part.item.push_back(item);
            part.weight.push_back(weight);
        };
        if (place.region && place.region->IsFree(place.node)) {
            place.region->mapping->InfluencesAt(place.node, influences);
            for (const auto &[j, weight] : influences.nodes)
                add(first[place.number] + std::int32_t(j), weight);
            for (const auto &[tag, weight] : influences.held)
                add(column[place.number].at(tag), weight);
        } else if (place.region) {
            add(column[place.number].at(place.region->held.tag[std::size_t(place.node)]), 1);
        } else if (ofPoint.count(i) > 0) {
            add(ofPoint.at(i), 1);
        } else if (deformer->slotTag[i] != 1) {
            add(ofTag.at(std::max(0, deformer->slotTag[i])), 1);
        }
        part.count.push_back(std::int32_t(part.item.size() - before));
    };
    Listener::Run(report, threads, [&](const Progress &progress) {
        findColumns();
        ParallelFor(progress, "Weighing", view.vertexSlots, grain, [&](std::size_t begin, std::size_t end) {
            vcg::fcd::GraphMapping::Influences influences;
            for (std::size_t i = begin; i < end; ++i)
                of(i, influences, parts[begin / grain]);
        });
    });
    std::size_t items = 0;
    for (const Part &part : parts)
        items += part.item.size();
    std::int64_t *begin;
    std::int32_t *item;
    float *weight;
    nb::object begins = newArray({view.vertexSlots + 1}, begin), indices = newArray({items}, item),
               values = newArray({items}, weight);
    const auto gather = [&] {
        const nb::gil_scoped_release release;
        std::int64_t at = 0;
        *begin++ = 0;
        for (const Part &part : parts) {
            for (std::int32_t count : part.count)
                *begin++ = at += count;
            item = std::copy(part.item.begin(), part.item.end(), item);
            weight = std::copy(part.weight.begin(), part.weight.end(), weight);
        }
    };
    gather();
    nb::list tagsOfColumns;
    for (Index tag : tagged)
        tagsOfColumns.append(int(tag));
    return nb::make_tuple(begins, indices, values, tagsOfColumns);
}

nb::dict Prepared::report() const {
    const vcg::fcd::SurfaceReport &surface = deformer->report;
    nb::dict all;
    all["nodes"] = deformer->Nodes();
    all["fixed"] = tags.fixed;
    all["handle"] = tags.handle;
    all["free"] = tags.free;
    all["outside"] = tags.outside;
    all["components"] = surface.components;
    all["loose_parts"] = deformer->loose.parts;
    all["welded"] = surface.welded;
    all["joined"] = surface.seams;
    all["gaps"] = surface.gaps;
    all["one_sided"] = surface.oneSided;
    all["unenclosed"] = surface.unenclosed;
    all["isolated"] = surface.isolated;
    all["non_manifold_edges"] = surface.nonManifoldEdges;
    all["degenerate_faces"] = surface.degenerateFaces;
    all["placed_nodes"] = deformer->placedNodes;
    all["seconds"] = seconds;
    return all;
}

nb::dict Prepared::centers() const {
    nb::dict all;
    for (const auto &[tag, middle] : deformer->center)
        all[nb::int_(int(tag))] = nb::make_tuple(middle[0], middle[1], middle[2]);
    return all;
}

void Prepared::normalsOf(const Rows &positions, const Written &out) const {
    expectRows(positions, view.vertexSlots);
    expectRows(out, view.vertexSlots);
    const double *position = positions.data();
    double *normal = out.data();
    Listener::Run(nb::none(), threads,
                  [&](const Progress &progress) { vcg::fcd::FaceNormals(view, position, normal, progress.threads); });
}

const vcg::fcd::NearestPlace &Prepared::places(const Progress &progress) const {
    std::call_once(placesMade, [&] {
        rest = view.Copy(threads);
        if (!rest.allFinite())
            throw vcg::fcd::BadInput("A coordinate of the vertices is no longer finite.");
        progress(0, vcg::fcd::readingStage);
        std::vector<std::array<Index, 3>> triangle(view.faces);
        for (std::size_t f = 0; f < view.faces; ++f)
            for (std::size_t k = 0; k < 3; ++k)
                triangle[f][k] = Index(view.corner[3 * f + k]);
        found = std::make_unique<vcg::fcd::NearestPlace>(rest, std::move(triangle),
                                                         std::vector<char>(view.vertexSlots, 1), progress);
    });
    return *found;
}

nb::object nearestVertices(const Rows &vertices, const Rows &points, unsigned threads, const nb::object &report) {
    std::int64_t *number;
    nb::object numbers = newArray({points.shape(0)}, number);
    Listener::Run(report, threads, [&](const Progress &progress) {
        std::vector<std::int64_t> slot;
        std::vector<Eigen::Vector3d> position;
        for (std::size_t i = 0; i < vertices.shape(0); ++i)
            if (const Eigen::Vector3d p = rowOf(vertices.data(), i); p.allFinite()) {
                slot.push_back(std::int64_t(i));
                position.push_back(p);
            }
        if (position.empty())
            throw vcg::fcd::BadInput("vertices holds no finite coordinates, so no vertex is nearest to a point");
        const double unit = vcg::fcd::detail::TakeUnit(position);
        const vcg::fcd::PointTree<double> tree(position);
        ParallelForEach(progress, "Looking for landmarks", points.shape(0), 64, [&](std::size_t k) {
            number[k] = slot[std::size_t(tree.Nearest(rowOf(points.data(), k) / unit))];
        });
    });
    return numbers;
}

std::uint64_t checksum(const Rows &rows, unsigned threads) {
    const std::size_t n = 3 * rows.shape(0), grain = 3 << 14;
    const double *number = rows.data();
    std::vector<std::uint64_t> part((n + grain - 1) / grain);
    const nb::gil_scoped_release release;
    ParallelFor(threads, n, grain, [&](std::size_t first, std::size_t last) {
        std::uint64_t sum[3] = {1, 2, 3}; // three independent sums, for speed
        for (std::size_t i = first; i < last; i += 3)
            for (std::size_t d = 0; d < 3; ++d) {
                std::uint64_t bits;
                std::memcpy(&bits, number + i + d, sizeof bits);
                // A step of FNV, which only carries bits upwards; the shift brings them down.
                sum[d] = (sum[d] ^ bits) * 0x100000001B3u;
                sum[d] ^= sum[d] >> 32;
            }
        part[first / grain] = sum[0] ^ sum[1] << 1 ^ sum[2] << 2;
    });
    std::uint64_t all = n;
    for (std::uint64_t each : part)
        all = (all ^ each) * 0x100000001B3u ^ all >> 32;
    return all;
}
