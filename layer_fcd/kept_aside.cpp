// SPDX-License-Identifier: GPL-3.0-or-later
#include "inherited.h"
#include "kept_aside.h"
#include "kept_tool.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "mesh_copy.h"
#include "parameters.h"
#include "rest_shape.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

using vcg::fcd::Error;

/// What is kept aside for a layer; null: nothing.
static KeptScan *scanOf(const MeshModel &layer) {
    LayerState *state = LayerState::of(layer);
    return state && state->scan ? &*state->scan : nullptr;
}

/// What is kept aside for \p layer, which owns it, or for its original; null: nothing.
static std::shared_ptr<const KeptScan> keptOf(const MeshDocument &document, const MeshModel &layer) {
    if (const KeptScan *scan = scanOf(layer))
        return {std::shared_ptr<void>(), scan};
    std::optional<KeptScan> found = inheritedScan(layer, LayerState::ofOthers(document, layer));
    return found ? std::make_shared<const KeptScan>(std::move(*found)) : nullptr;
}

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

std::vector<int> writtenTags(const MeshModel &layer) {
    std::vector<int> tag(layer.cm.vert.size(), 1);
    if (const KeptScan *scan = scanOf(layer); scan && scan->quality) {
        const KeptVertices kept(layer, *scan);
        forVertices(layer.cm, [&](std::size_t i) { tag[i] = kept.tag(i); });
    }
    return tag;
}

BroughtBack bringBack(const MeshDocument &document, MeshModel &layer) {
    if (const LayerState *state = LayerState::of(layer))
        handDownScan(document, *state);
    const bool hadMarks = hasMarks(layer);
    dropMarks(layer);
    if (!scanOf(layer) && hadMarks)
        return {};
    const std::shared_ptr<const KeptScan> scan = keptOf(document, layer);
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

/// The colours of \p layer by slot, those before tagging where they are known; empty: there were none.
/// \param kept null: its colours are its own \param hadColor whether it had colours before tagging
static std::vector<vcg::Color4b> ownColors(const MeshModel &layer, const KeptVertices *kept, bool hadColor) {
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

void bringBackTo(const MeshDocument &document, MeshModel &copy, const MeshModel &layer) {
    const std::shared_ptr<const KeptScan> scan = keptOf(document, layer);
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
    const std::shared_ptr<const KeptScan> scan = keptOf(document, layer);
    if (!scan || !scan->color)
        return ownColors(layer, nullptr, true);
    const KeptVertices kept(layer, *scan);
    return ownColors(layer, &kept, scan->hadColor);
}

/// The longest edge at each vertex.
static std::vector<double> longestEdges(const CMeshO &mesh) {
    std::vector<double> longest(mesh.vert.size(), 0);
    for (const CFaceO &face : mesh.face)
        for (int k = 0; !face.IsD() && k < 3; ++k) {
            const std::size_t a = vcg::tri::Index(mesh, face.cV(k)), b = vcg::tri::Index(mesh, face.cV((k + 1) % 3));
            const double length = (toVector(mesh.vert[a].cP()) - toVector(mesh.vert[b].cP())).norm();
            longest[a] = std::max(longest[a], length);
            longest[b] = std::max(longest[b], length);
        }
    return longest;
}

std::uint32_t numberOf(const vcg::Color4b &c) {
    return std::uint32_t(c[0]) | std::uint32_t(c[1]) << 8 | std::uint32_t(c[2]) << 16 | std::uint32_t(c[3]) << 24;
}

KeptVertices::KeptVertices(const MeshModel &layer, const KeptScan &scan)
    : scan(scan), mesh(layer.cm), isKnown(mesh.vert.size(), 0) {
    std::atomic<bool> isAnyMoved{false}, isAnyNew{false};
    forVertices(mesh, [&](std::size_t i) {
        isKnown[i] = scan.number[i] != 0;
        if (!isKnown[i])
            isAnyNew = true;
        else if (mesh.vert[i].cP() != vertexOf(i).place)
            isAnyMoved = true;
    });
    const bool isSameMesh =
        isAnyMoved && !isAnyNew && scan.vertexSlots == mesh.vert.size() && scan.faces == facesOf(mesh);
    const bool wasPosed = RestShape::exists(layer);
    std::optional<Eigen::Affine3d> move;
    if (isAnyMoved && !isSameMesh) { // perhaps something has moved all that were tagged by one affine map
        std::vector<Eigen::Vector3d> from, to;
        for (std::size_t i = 0; i < mesh.vert.size(); ++i)
            if (isKnown[i]) {
                from.push_back(toVector(vertexOf(i).place));
                to.push_back(toVector(mesh.vert[i].cP()));
            }
        move = affineMapOf(from, to, layerRounding);
    }
    if (isAnyMoved && !isSameMesh && !move) {
        const std::vector<double> longest = longestEdges(mesh);
        const std::optional<RestState> &rest = LayerState::known(layer).rest;
        const PosedVertex *posed = rest ? rest->vertex.data() : nullptr;
        forVertices(mesh, [&](std::size_t i) {
            const Eigen::Vector3d p = toVector(mesh.vert[i].cP());
            const auto isNear = [&](const Eigen::Vector3d &place) { return (place - p).norm() <= longest[i] / 2; };
            if (!isKnown[i] || isNear(toVector(vertexOf(i).place)) ||
                (posed && posed[i].isKnown() && isNear(posed[i].place())))
                return;
            isKnown[i] = 0;
            isAnyNew = true;
        });
    }
    if (isAnyNew && !wasPosed && !scan.vertices.empty()) {
        points.reserve(scan.vertices.size());
        const Eigen::Affine3d moved = move.value_or(Eigen::Affine3d::Identity());
        for (const TaggedVertex &each : scan.vertices)
            points.push_back(moved * toVector(each.place));
        tree = std::make_unique<vcg::fcd::PointTree<double>>(points);
    }
    // Is the new quality other tags, of another filter? These are whole numbers, none larger than before, or half of
    // those above 0 unchanged. Any other quality, as a count of something, stays.
    const auto number = [&](const auto &is) {
        return sumOfVertices(mesh, [&](std::size_t i) { return isOld(i) && is(vertexOf(i).tag, mesh.vert[i].cQ()); });
    };
    areTags = number([](int tag, double now) { return tag != TaggedVertex::noTag && now != std::round(now); }) == 0 &&
              (number([&](int tag, double now) {
                   return tag != TaggedVertex::noTag && (now < scan.lowTag || now > scan.highTag);
               }) == 0 ||
               2 * number([](int tag, double now) { return tag > 0 && now == tag; }) >=
                   number([](int tag, double) { return tag > 0; }));
}

std::vector<KeptVertices::Near> KeptVertices::nearTo(std::size_t i) const {
    const Eigen::Vector3d p = toVector(mesh.vert[i].cP());
    std::vector<vcg::fcd::PointTree<double>::Neighbour> found;
    tree->Nearest(p, 4, found); // two triangles at an edge have four corners
    double span = 0, least = std::numeric_limits<double>::infinity(), sum = 0;
    for (const auto &a : found) {
        least = std::min(least, a.square);
        for (const auto &b : found)
            span = std::max(span, (points[std::size_t(a.point)] - points[std::size_t(b.point)]).squaredNorm());
    }
    std::vector<Near> near;
    if (!(least <= span)) // it does not lie between them
        return near;
    for (const auto &each : found) {
        near.push_back({std::size_t(each.point), 1 / std::max(each.square, 1e-12 * span)});
        sum += near.back().weight;
    }
    for (Near &each : near)
        each.weight /= sum;
    return near;
}

std::optional<vcg::Color4b> KeptVertices::color(std::size_t i) const {
    if (isColorOfTag(i))
        return scan.colors[scan.number[i] - 1];
    const vcg::Color4b &now = mesh.vert[i].cC();
    bool isMixed = scan.color && !isOld(i) && tree; // or the colour of one tag
    for (int k = 0; k < 3 && isMixed; ++k)
        isMixed = now[k] >= scan.lowColor[k] && now[k] <= scan.highColor[k];
    if (!isMixed)
        return {};
    const std::vector<Near> near = nearTo(i);
    if (near.empty())
        return {};
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();
    for (const Near &each : near) {
        const vcg::Color4b &c = scan.colors[each.kept];
        mean += each.weight * Eigen::Vector4d(c[0], c[1], c[2], c[3]);
    }
    vcg::Color4b color;
    for (int k = 0; k < 4; ++k)
        color[k] = (unsigned char)std::lround(mean[k]);
    return color;
}

std::optional<CVertexO::QualityType> KeptVertices::quality(std::size_t i) const {
    if (isQualityTag(i))
        return scan.qualities[scan.number[i] - 1];
    const double now = double(mesh.vert[i].cQ());
    if (!scan.quality || !areTags || isOld(i) || !tree || now < scan.lowTag || now > scan.highTag)
        return {};
    const std::vector<Near> near = nearTo(i);
    if (near.empty())
        return {};
    double mean = 0;
    for (const Near &each : near)
        mean += each.weight * double(scan.qualities[each.kept]);
    return CVertexO::QualityType(mean);
}
