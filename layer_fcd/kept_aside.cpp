// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_aside.h"
#include "inherited.h"
#include "kept_scan.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "marks.h"
#include "mesh_copy.h"

#include <algorithm>
#include <atomic>

using vcg::fcd::Error;

namespace {

using Quality = CVertexO::QualityType;

/// What is kept aside for a layer; null: nothing.
KeptScan *scanOf(const MeshModel &layer) {
    LayerState *state = LayerState::of(layer);
    return state && state->scan ? &*state->scan : nullptr;
}

/// What is kept aside for \p layer, or for its original; null: nothing. \param found out: the latter
const KeptScan *keptOf(const MeshDocument &document, const MeshModel &layer, std::optional<KeptScan> &found) {
    if (const KeptScan *scan = scanOf(layer))
        return scan;
    found = inheritedScan(layer, LayerState::ofOthers(document, layer));
    return found ? &*found : nullptr;
}

} // namespace

void keepAside(const MeshDocument &document, MeshModel &layer, bool color, bool quality) {
    const CMeshO &mesh = layer.cm;
    std::optional<KeptScan> &scan = LayerState::made(document, layer).scan;
    if (!scan)
        scan = inheritedScan(layer, LayerState::ofOthers(document, layer));
    if (!scan) {
        scan.emplace();
        scan->number.resize(mesh.vert.size());
    }
    const bool had = layer.hasDataMask(MeshModel::MM_VERTCOLOR), hadQuality = hasQuality(layer);
    KeptScan next = *scan;
    const std::size_t live = std::size_t(mesh.vn);
    next.vertices.assign(live, TaggedVertex());
    next.gone.clear();
    next.colors.assign(color || next.color ? live : 0, vcg::Color4b(vcg::Color4b::White));
    next.qualities.assign(quality || next.quality ? live : 0, 0);
    next.number.assign(mesh.vert.size(), 0);
    std::atomic<bool> isAnyOther{false}, isAnyTag{false}; // colours, qualities
    const KeptVertices kept(layer, *scan);
    Packing(mesh.vert, mesh.vn).forEach([&](std::size_t i, std::size_t j) {
        const CVertexO &vertex = mesh.vert[i];
        next.number[i] = std::uint32_t(j + 1);
        next.vertices[j] = {vertex.cP(), kept.tagColor(i),
                            quality                ? 0
                            : kept.isQualityTag(i) ? int(vertex.cQ())
                                                   : TaggedVertex::noTag,
                            color || kept.isColorOfTag(i)};
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
    next.matrix = mesh.Tr;
    scan = std::move(next);
}

void takeTags(const MeshModel &layer, const std::vector<int> &tag, bool color, bool quality) {
    const CMeshO &mesh = layer.cm;
    KeptScan &scan = *scanOf(layer);
    bool isFirst = true;
    for (std::size_t i = 0; i < tag.size(); ++i) {
        const vcg::Color4b &c = mesh.vert[i].cC();
        if (mesh.vert[i].IsD())
            continue;
        if (quality) {
            scan.vertices[scan.number[i] - 1].tag = tag[i];
            scan.lowTag = std::min(isFirst ? 0 : scan.lowTag, double(tag[i]));
            scan.highTag = std::max(isFirst ? 0 : scan.highTag, double(tag[i]));
        }
        if (color) {
            scan.vertices[scan.number[i] - 1].tagColor = numberOf(c);
            for (int k = 0; k < 3; ++k) {
                scan.lowColor[k] = isFirst ? c[k] : std::min(scan.lowColor[k], c[k]);
                scan.highColor[k] = isFirst ? c[k] : std::max(scan.highColor[k], c[k]);
            }
        }
        isFirst = false;
    }
}

BroughtBack bringBack(const MeshDocument &document, MeshModel &layer) {
    if (const LayerState *state = LayerState::of(layer))
        handDownScan(document, *state);
    const bool hadMarks = hasMarks(layer);
    dropMarks(layer);
    if (!scanOf(layer) && hadMarks)
        return {};
    std::optional<KeptScan> found;
    const KeptScan *scan = keptOf(document, layer, found);
    if (!scan)
        throw Error("The layer " + inQuotes(layer) +
                    " has no tags of an FCD filter and no marks of the tool, so there is nothing to bring back.");
    std::atomic<int> others{0}, placed{0}, otherColors{0}, otherQualities{0};
    {
        CMeshO &mesh = layer.cm;
        const KeptVertices kept(layer, *scan);
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
    if (LayerState *state = LayerState::of(layer))
        state->scan.reset();
    return {others, placed};
}

namespace {

/// The colours of \p layer by slot, those before tagging where they are known; empty: there were none.
/// \param kept null: its colours are its own \param hadColor whether it had colours before tagging
std::vector<vcg::Color4b> ownColors(const MeshModel &layer, const KeptVertices *kept, bool hadColor) {
    const CMeshO &mesh = layer.cm;
    if (!layer.hasDataMask(MeshModel::MM_VERTCOLOR))
        return {};
    std::vector<vcg::Color4b> colors(mesh.vert.size());
    std::atomic<bool> isAny{!kept || hadColor};
    forVertices(mesh, [&](std::size_t i) {
        const auto color = kept ? kept->color(i) : std::nullopt;
        colors[i] = color ? *color : mesh.vert[i].cC();
        if (!color) // colours that were changed after tagging are meant to be seen
            isAny = true;
    });
    return isAny ? colors : std::vector<vcg::Color4b>();
}

} // namespace

void bringBackTo(const MeshDocument &document, MeshModel &copy, const MeshModel &layer) {
    std::optional<KeptScan> found;
    const KeptScan *scan = keptOf(document, layer, found);
    if (!scan)
        return;
    const KeptVertices kept(layer, *scan);
    const std::vector<vcg::Color4b> colors = ownColors(layer, scan->color ? &kept : nullptr, scan->hadColor);
    Packing(layer.cm.vert, layer.cm.vn).forEach([&](std::size_t i, std::size_t j) {
        if (!colors.empty())
            copy.cm.vert[j].C() = colors[i];
        if (const auto quality = scan->quality && scan->hadQuality ? kept.quality(i) : std::nullopt)
            copy.cm.vert[j].Q() = *quality;
    });
    if (colors.empty())
        copy.clearDataMask(MeshModel::MM_VERTCOLOR);
}

std::vector<vcg::Color4b> ownColors(const MeshDocument &document, const MeshModel &layer) {
    std::optional<KeptScan> found;
    const KeptScan *scan = keptOf(document, layer, found);
    if (!scan || !scan->color)
        return ownColors(layer, nullptr, true);
    const KeptVertices kept(layer, *scan);
    return ownColors(layer, &kept, scan->hadColor);
}
