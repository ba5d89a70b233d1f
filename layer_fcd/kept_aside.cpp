// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "kept_aside.h"
#include "kept_scan.h"
#include "layer_contents.h"
#include "marks.h"
#include "mesh_copy.h"

#include <vcg/complex/allocate.h>

#include <algorithm>
#include <atomic>

using vcg::fcd::Error;

namespace {

using Quality = CVertexO::QualityType;

/// What is kept of a layer, null where nothing is.
KeptScan *scanOf(const CMeshO &mesh) {
    return host::vertexAttribute<TaggedVertex>(mesh, TaggedVertex::name)
               ? host::meshAttribute<KeptScan>(mesh, KeptScan::name)
               : nullptr;
}

void drop(CMeshO &mesh) {
    if (vcg::tri::HasPerVertexAttribute(mesh, TaggedVertex::name))
        vcg::tri::Allocator<CMeshO>::DeletePerVertexAttribute(mesh, TaggedVertex::name);
    vcg::tri::Allocator<CMeshO>::DeletePerMeshAttribute(mesh, KeptScan::name);
}

} // namespace

bool isAside(const std::string &attribute) { return attribute == TaggedVertex::name; }

void keepAside(MeshModel &layer, bool color, bool quality) {
    CMeshO &mesh = layer.cm;
    if (!scanOf(mesh)) {
        drop(mesh);
        host::madeMeshAttribute<KeptScan>(mesh, KeptScan::name);
        host::madeVertexAttribute<TaggedVertex>(mesh, TaggedVertex::name);
    }
    const bool had = layer.hasDataMask(MeshModel::MM_VERTCOLOR), hadQuality = hasQuality(layer);
    KeptScan next = *scanOf(mesh);
    const std::size_t live = std::size_t(mesh.vn);
    next.places.assign(live, Point3m());
    next.colors.assign(color || next.color ? live : 0, vcg::Color4b(vcg::Color4b::White));
    next.qualities.assign(quality || next.quality ? live : 0, 0);
    std::vector<TaggedVertex> tagged(mesh.vert.size(), TaggedVertex());
    std::atomic<bool> isAnyOther{false}, isAnyTag{false}; // colours, qualities
    const KeptVertices kept(layer);
    Packing(mesh.vert, mesh.vn).forEach([&](std::size_t i, std::size_t j) {
        const CVertexO &vertex = mesh.vert[i];
        tagged[i] = {std::uint32_t(j + 1), kept.colorNumber(i), color || kept.isColorOfTag(i),
                     quality || kept.isQualityTag(i)};
        next.places[j] = vertex.cP();
        if (!next.colors.empty()) {
            const auto own = kept.color(i);
            if (own || had)
                next.colors[j] = own ? *own : vertex.cC();
            if (!own)
                isAnyOther = true;
        }
        if (!next.qualities.empty() && hadQuality) {
            const auto own = kept.quality(i);
            next.qualities[j] = own ? *own : vertex.cQ();
            if (own)
                isAnyTag = true;
        }
    });
    if (color && isAnyOther)
        next.hadColor = had;
    if (quality && !isAnyTag) {
        next.hadQuality = hadQuality;
        next.countedQuality = layer.hasDataMask(MeshModel::MM_VERTQUALITY);
    }
    next.color |= color;
    next.quality |= quality;
    next.faces = facesOf(mesh);
    next.vertexSlots = mesh.vert.size();
    *scanOf(mesh) = std::move(next);
    std::copy(tagged.begin(), tagged.end(), host::vertexAttribute<TaggedVertex>(mesh, TaggedVertex::name));
}

void takeTags(const MeshModel &layer, const std::vector<int> &tag, bool color, bool quality) {
    const CMeshO &mesh = layer.cm;
    KeptScan &scan = *scanOf(mesh);
    auto *tagged = host::vertexAttribute<TaggedVertex>(mesh, TaggedVertex::name);
    bool isFirst = true;
    for (std::size_t i = 0; i < tag.size(); ++i) {
        const vcg::Color4b &c = mesh.vert[i].cC();
        if (mesh.vert[i].IsD())
            continue;
        if (quality) {
            scan.lowTag = std::min(isFirst ? 0 : scan.lowTag, double(tag[i]));
            scan.highTag = std::max(isFirst ? 0 : scan.highTag, double(tag[i]));
        }
        if (color) {
            tagged[i].color = numberOf(c);
            for (int k = 0; k < 3; ++k) {
                scan.lowColor[k] = isFirst ? c[k] : std::min(scan.lowColor[k], c[k]);
                scan.highColor[k] = isFirst ? c[k] : std::max(scan.highColor[k], c[k]);
            }
        }
        isFirst = false;
    }
}

BroughtBack bringBack(MeshModel &layer) {
    CMeshO &mesh = layer.cm;
    const KeptScan *scan = scanOf(mesh);
    const bool hadMarks = hasMarks(layer);
    dropMarks(layer);
    if (!scan && hadMarks)
        return {};
    if (!scan)
        throw Error("The layer '" + layer.label().toStdString() +
                    "' has no tags of an FCD filter and no marks of the tool, so there is nothing to bring back.");
    std::atomic<int> others{0}, placed{0}, otherColors{0}, otherQualities{0};
    {
        const KeptVertices kept(layer);
        forVertices(mesh, [&](std::size_t i) {
            CVertexO &vertex = mesh.vert[i];
            const auto color = scan->color ? kept.color(i) : std::nullopt;
            const auto quality = scan->quality ? kept.quality(i) : std::nullopt;
            if (color)
                vertex.C() = *color;
            if (quality)
                vertex.Q() = *quality;
            otherColors += scan->color && !color;
            otherQualities += scan->quality && !quality;
            const bool isOther = (scan->color && !color) || (scan->quality && !quality);
            others += isOther;
            placed += !isOther && !kept.isOld(i);
        });
    }
    if (scan->color && !scan->hadColor && otherColors == 0)
        layer.clearDataMask(MeshModel::MM_VERTCOLOR);
    if (scan->quality && !scan->countedQuality && otherQualities == 0)
        layer.clearDataMask(MeshModel::MM_VERTQUALITY);
    drop(mesh);
    return {others, placed};
}

void bringBackTo(MeshModel &copy, const MeshModel &layer) {
    const CMeshO &from = layer.cm;
    const KeptScan *scan = scanOf(from);
    if (!scan)
        return;
    const KeptVertices kept(layer);
    std::atomic<bool> otherColors{false};
    Packing(from.vert, from.vn).forEach([&](std::size_t i, std::size_t j) {
        CVertexO &to = copy.cm.vert[j];
        // Colours that were changed after tagging are meant to be seen.
        if (const auto color = scan->color ? kept.color(i) : std::nullopt)
            to.C() = *color;
        else
            otherColors = true;
        if (const auto quality = scan->quality && scan->hadQuality ? kept.quality(i) : std::nullopt)
            to.Q() = *quality;
    });
    if (scan->color && !scan->hadColor && !otherColors)
        copy.clearDataMask(MeshModel::MM_VERTCOLOR);
}
