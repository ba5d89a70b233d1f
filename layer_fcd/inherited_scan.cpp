// SPDX-License-Identifier: GPL-3.0-or-later
#include "inherited_scan.h"
#include "kept_scan.h"
#include "layer_contents.h"
#include "mesh_copy.h"
#include "rest_shape.h"

#include <algorithm>

namespace {

/// The vertices of a tagged layer by the places where they were: when it was tagged, and after its last pose, in the
/// layer and in the world, into which a host merges.
class TaggedPlaces {
  public:
    explicit TaggedPlaces(const LayerState &state) : state(state), scan(*state.scan) {
        for (const TaggedVertex &each : scan.vertices)
            if (each.hasColor && (colors.empty() || each.tagColor != colors.back()))
                colors.push_back(each.tagColor);
        std::sort(colors.begin(), colors.end());
        colors.erase(std::unique(colors.begin(), colors.end()), colors.end());
    }

    const KeptScan &kept() const { return scan; }

    /// The number of the vertex whose place, and whose tag's colour or quality, \p vertex has: of several, the next one
    /// after that which was found last. 0: none.
    std::uint32_t find(const CVertexO &vertex) {
        const std::uint32_t color = numberOf(vertex.cC());
        if (scan.color && !std::binary_search(colors.begin(), colors.end(), color))
            return 0;
        if (places.empty())
            sort();
        const std::uint64_t place = RestShape::placeOf(vertex.cP());
        std::uint32_t found = 0;
        for (auto at = std::lower_bound(places.begin(), places.end(), std::make_pair(place, std::uint32_t(0)));
             at != places.end() && at->first == place && found <= last; ++at)
            if (const TaggedVertex &tag = tagOf(at->second);
                scan.color ? tag.hasColor && tag.tagColor == color : isTag(vertex, at->second))
                found = found && at->second <= last ? found : at->second;
        return last = found ? found : last, found;
    }

    bool isTag(const CVertexO &vertex, std::uint32_t number) const {
        return scan.quality && tagOf(number).hasQuality() && vertex.cQ() == tagOf(number).tag;
    }

  private:
    const TaggedVertex &tagOf(std::uint32_t number) const { return scan.vertices[number - 1]; }

    void sort() {
        for (std::uint32_t number = 1; number <= scan.vertices.size(); ++number)
            add(tagOf(number).place, number);
        for (std::size_t i = 0; state.rest && i < scan.number.size(); ++i)
            if (scan.number[i] != 0 && state.rest->vertex[i].isKnown())
                add(toPoint(state.rest->vertex[i].place()), scan.number[i]);
        for (const auto &[place, number] : scan.gone)
            add(place, number);
        std::sort(places.begin(), places.end());
    }

    void add(const Point3m &p, std::uint32_t number) {
        places.emplace_back(RestShape::placeOf(p), number);
        if (const Point3m there = scan.matrix * p; there != p)
            places.emplace_back(RestShape::placeOf(there), number);
    }

    const LayerState &state;
    const KeptScan &scan;
    std::vector<std::uint32_t> colors;                           ///< of tags, ascending
    std::vector<std::pair<std::uint64_t, std::uint32_t>> places; ///< and numbers, ascending; as well
    std::uint32_t last = 0;
};

} // namespace

std::optional<KeptScan> inheritedScan(const MeshModel &layer, const std::vector<const LayerState *> &sources) {
    std::vector<TaggedPlaces> tagged;
    for (const LayerState *source : sources)
        if (source->scan &&
            layer.hasDataMask(source->scan->color ? MeshModel::MM_VERTCOLOR : MeshModel::MM_VERTQUALITY))
            tagged.emplace_back(*source);
    if (tagged.empty())
        return {};
    const CMeshO &mesh = layer.cm;
    KeptScan scan;
    scan.vertices.resize(std::size_t(mesh.vn));
    scan.colors.resize(std::size_t(mesh.vn));
    scan.qualities.resize(std::size_t(mesh.vn));
    scan.number.assign(mesh.vert.size(), 0);
    std::uint32_t number = 0;
    bool isFirst = true;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
        const CVertexO &vertex = mesh.vert[i];
        if (vertex.IsD())
            continue;
        scan.colors[number] = vertex.cC();
        scan.qualities[number] = vertex.cQ();
        scan.number[i] = number + 1;
        TaggedVertex &its = scan.vertices[number] = {vertex.cP(), numberOf(vertex.cC()), TaggedVertex::noTag, false};
        for (TaggedPlaces &source : tagged) {
            const KeptScan &kept = source.kept();
            const std::uint32_t found = its.hasColor || its.hasQuality() ? 0 : source.find(vertex);
            if (found == 0)
                continue;
            its.hasColor = kept.color;
            its.tag = source.isTag(vertex, found) ? int(vertex.cQ()) : TaggedVertex::noTag;
            if (its.hasColor)
                scan.colors[number] = kept.colors[found - 1];
            if (its.hasQuality())
                scan.qualities[number] = kept.qualities[found - 1];
            scan.color |= its.hasColor;
            scan.quality |= its.hasQuality();
            scan.hadColor |= its.hasColor && kept.hadColor;
            scan.hadQuality |= its.hasQuality() && kept.hadQuality;
            scan.countedQuality |= its.hasQuality() && kept.countedQuality;
            for (int k = 0; k < 3; ++k) {
                scan.lowColor[k] = isFirst ? kept.lowColor[k] : std::min(scan.lowColor[k], kept.lowColor[k]);
                scan.highColor[k] = isFirst ? kept.highColor[k] : std::max(scan.highColor[k], kept.highColor[k]);
            }
            scan.lowTag = std::min(scan.lowTag, kept.lowTag);
            scan.highTag = std::max(scan.highTag, kept.highTag);
            isFirst = false;
        }
        ++number;
    }
    if (isFirst)
        return {};
    scan.faces = facesOf(mesh);
    scan.vertexSlots = mesh.vert.size();
    scan.matrix = mesh.Tr;
    return scan;
}

bool handDown(const MeshDocument &document, const LayerState &state) {
    bool isGiven = false;
    for (const MeshModel *layer : host::layers(document))
        if (state.scan && !LayerState::known(*layer).scan)
            if (std::optional<KeptScan> scan = inheritedScan(*layer, {&state})) {
                LayerState::made(document, const_cast<MeshModel &>(*layer)).scan = std::move(scan);
                isGiven = true;
            }
    return isGiven;
}
