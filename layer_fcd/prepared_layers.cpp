// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_contents.h"
#include "prepared_layers.h"

#include <algorithm>

#include <xxhash.h>

using vcg::fcd::ParallelFor;
using vcg::fcd::SurfaceView;

namespace {

/// The latest deformer is kept, and others up to so many vertices in all: a vertex takes about 100 bytes.
const std::size_t mostVertices = 8000000;

PreparedLayers::Key::Hash hashOf(const NumberBytes &bytes) {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    return {hash.low64, hash.high64};
}

/// Adds the hashes of consecutive ranges of n items, with \p each numbers of type T. \param range range(first, last,
/// to) gives the numbers of a range, in \p to or elsewhere
template <class T, class Range>
void addHashes(NumberBytes &bytes, std::size_t n, std::size_t each, const Range &range) {
    const std::size_t grain = 1 << 14;
    std::vector<XXH128_hash_t> hashes((n + grain - 1) / grain);
    ParallelFor(0, n, grain, [&](std::size_t first, std::size_t last) {
        thread_local std::vector<T> buffer;
        buffer.resize(each * grain);
        const T *data = range(first, last, buffer.data());
        hashes[first / grain] = XXH3_128bits(data, each * (last - first) * sizeof(T));
    });
    bytes.add(n);
    for (const XXH128_hash_t &hash : hashes)
        bytes.add(hash.low64, hash.high64);
}

/// The ranges of a surface in arrays.
struct ArrayRanges {
    const SurfaceView &surface;
    std::uint64_t faces = facesOf(surface);
    std::size_t vertexSlots = surface.vertexSlots, edges = surface.edges;

    bool isDeleted(std::size_t i) const { return surface.IsDeleted(i); }
    const double *positions(std::size_t first, std::size_t, double *) const { return surface.position + 3 * first; }
    const std::uint32_t *ends(std::size_t first, std::size_t, std::uint32_t *) const { return surface.end + 2 * first; }
};

/// The same of a mesh.
struct MeshRanges {
    const CMeshO &mesh;
    const Point3m *rest;
    std::uint64_t faces;
    std::size_t vertexSlots = mesh.vert.size(), edges = mesh.edge.size();
    bool isCompact = std::size_t(mesh.vn) == mesh.vert.size();

    bool isDeleted(std::size_t i) const { return !isCompact && mesh.vert[i].IsD(); }
    const double *positions(std::size_t first, std::size_t last, double *to) const {
        for (std::size_t i = first; i < last; ++i)
            for (int d = 0; d < 3; ++d)
                to[3 * (i - first) + d] = rest ? rest[i][d] : mesh.vert[i].cP()[d];
        return to;
    }
    const std::uint32_t *ends(std::size_t first, std::size_t last, std::uint32_t *to) const {
        for (std::size_t e = first; e < last; ++e)
            vcg::tri::ReadSlots(mesh, mesh.edge[e], 2, to + 2 * (e - first));
        return to;
    }
};

template <class Ranges>
PreparedLayers::Key keyOfRanges(const Ranges &surface, const vcg::fcd::Handles &handles,
                                const vcg::fcd::DeformerParam &param) {
    NumberBytes bytes, held;
    addHashes<double>(bytes, surface.vertexSlots, 3, [&](std::size_t first, std::size_t last, double *to) {
        return surface.positions(first, last, to);
    });
    addHashes<int>(held, surface.vertexSlots, 1, [&](std::size_t first, std::size_t last, int *tag) {
        for (std::size_t i = first; i < last; ++i)
            tag[i - first] = surface.isDeleted(i) ? vcg::fcd::noVertex : std::max(-1, handles.tag[i]);
        return tag;
    });
    bytes.add(surface.faces);
    addHashes<std::uint32_t>(bytes, surface.edges, 2, [&](std::size_t first, std::size_t last, std::uint32_t *to) {
        return surface.ends(first, last, to);
    });
    for (const vcg::fcd::PointHandle &point : handles.point)
        held.add(point.vertex);
    for (int i = 0; i < 9; ++i)
        bytes.add(handles.world.linear()(i / 3, i % 3));
    for (Eigen::Index i = 0; i < param.nodes.size(); ++i)
        bytes.add(param.nodes.data()[i]);
    std::apply([&](const auto &...number) { bytes.add(number...); }, param.Numbers());
    return {hashOf(bytes), hashOf(held)};
}

} // namespace

PreparedLayers::Key PreparedLayers::keyOf(const SurfaceView &surface, const vcg::fcd::Handles &handles,
                                          const vcg::fcd::DeformerParam &param) {
    return keyOfRanges(ArrayRanges{surface}, handles, param);
}

PreparedLayers::Key PreparedLayers::keyOf(const CMeshO &mesh, const Point3m *rest, std::uint64_t faces,
                                          const vcg::fcd::Handles &handles, const vcg::fcd::DeformerParam &param) {
    return keyOfRanges(MeshRanges{mesh, rest, faces}, handles, param);
}

std::shared_ptr<Prepared> PreparedLayers::find(const Key &key) {
    const auto found =
        std::find_if(entries.begin(), entries.end(), [&](const Entry &entry) { return entry.key == key; });
    if (found == entries.end())
        return nullptr;
    entries.splice(entries.begin(), entries, found);
    found->prepared->seconds = 0;
    return found->prepared;
}

void PreparedLayers::follow(const MeshDocument &document) {
    entries.remove_if([](const Entry &entry) { return !entry.document->getMesh(entry.layer); });
    QObject::disconnect(&document, nullptr, &context, nullptr);
    QObject::connect(&document, &QObject::destroyed, &context, [this, gone = &document] {
        entries.remove_if([gone](const Entry &entry) { return entry.document == gone; });
    });
}

std::shared_ptr<Prepared> PreparedLayers::add(const Key &key, const MeshDocument &document, int layer,
                                              const SurfaceView &surface, const vcg::fcd::Handles &handles,
                                              const vcg::fcd::DeformerParam &param,
                                              const vcg::fcd::Progress &progress) {
    std::shared_ptr<const vcg::fcd::Deformer> before; // whose regions may be reused
    for (const Entry &entry : entries)
        if (!before && entry.document == &document && entry.layer == layer && entry.key.surface == key.surface)
            before = entry.prepared->deformer;
    entries.remove_if([&](const Entry &entry) { return entry.document == &document && entry.layer == layer; });
    const vcg::fcd::Stopwatch watch;
    auto prepared = std::make_shared<Prepared>();
    prepared->tags = vcg::fcd::CountHandles(handles, surface.vertexSlots, surface.deleted);
    prepared->deformer = vcg::fcd::PrepareDeformer(surface, handles, param, progress, before.get());
    prepared->moving.assign(surface.vertexSlots, 0);
    prepared->deformer->ForMoving([&](std::size_t slot) { prepared->moving[slot] = 1; });
    prepared->seconds = watch.Seconds();
    entries.push_front({key, &document, layer, prepared});
    std::size_t vertices = 0;
    for (auto entry = entries.begin(); entry != entries.end();) {
        vertices += entry->prepared->moving.size();
        entry = vertices > mostVertices && entry != entries.begin() ? entries.erase(entry) : std::next(entry);
    }
    return prepared;
}
