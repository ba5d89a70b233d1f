// SPDX-License-Identifier: GPL-3.0-or-later
#include "inherited.h"
#include "kept_aside.h"
#include "layer_contents.h"
#include "mesh_copy.h"
#include "rest_shape.h"

#include <vcg_ext/base/lists.h>

#include <algorithm>
#include <utility>

// --- rest shapes ---

/// For each vertex slot of \p mesh, the slot in \p rest of its original; empty unless all are copies.
/// \param matrix that copies were moved by; null: none
static std::vector<std::size_t> copiedSlots(const CMeshO &mesh, const RestState &rest, const Matrix44m *matrix) {
    const auto isAt = [matrix](const PosedVertex &vertex, const Point3m &p) {
        return matrix ? *matrix * toPoint(vertex.place()) == p : vertex.isAt(p);
    };
    std::vector<std::size_t> from;
    std::size_t next = 0;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
        if (mesh.vert[i].IsD())
            continue;
        while (next < rest.vertex.size() &&
               !(rest.vertex[next].isKnown() && isAt(rest.vertex[next], mesh.vert[i].cP())))
            ++next;
        if (next == rest.vertex.size())
            return {};
        from.resize(mesh.vert.size()); // late, since each pose asks this of all layers
        from[i] = next++;
    }
    return from;
}

/// The part of \p shape for copies. \param from slot of each copy's original \param matrix as in copiedSlots
static Shape copyOf(const Shape &shape, const std::vector<std::size_t> &from, const Matrix44m *matrix) {
    Shape copy;
    Eigen::Matrix4d move = Eigen::Matrix4d::Identity();
    if (matrix)
        matrix->ToEigenMatrix(move);
    const Eigen::Matrix3d turn = move.topLeftCorner<3, 3>().inverse().transpose();
    copy.position.reserve(from.size());
    copy.normal.reserve(from.size());
    for (const std::size_t slot : from) {
        copy.position.push_back(matrix ? *matrix * shape.position[slot] : shape.position[slot]);
        copy.normal.push_back(matrix ? toPoint((turn * toVector(shape.normal[slot])).stableNormalized())
                                     : shape.normal[slot]);
    }
    return copy;
}

std::optional<RestState> inheritedRest(const MeshModel &layer, const std::vector<const LayerState *> &others) {
    const CMeshO &mesh = layer.cm;
    std::vector<const RestState *> all;
    for (const LayerState *other : others)
        for (const std::optional<RestState> *each : {&other->rest, &other->whole})
            if (*each)
                all.push_back(&**each);
    for (const RestState *their : all) {
        const Matrix44m *matrix = nullptr;
        std::vector<std::size_t> from = copiedSlots(mesh, *their, matrix);
        if (from.empty() && !(their->matrix == Matrix44m::Identity()))
            from = copiedSlots(mesh, *their, matrix = &their->matrix);
        if (from.empty())
            continue;
        RestState rest;
        static_cast<Shape &>(rest) = copyOf(*their, from, matrix);
        for (const Shape &earlier : their->earlier)
            rest.earlier.push_back(copyOf(earlier, from, matrix));
        rest.vertex.resize(from.size());
        bool isOther = !rest.earlier.empty();
        forVertices(mesh, [&](std::size_t i) {
            const Point3m &p = mesh.vert[i].cP();
            rest.vertex[i] = {{p[0], p[1], p[2]}, RestShape::placeOf(p)};
        });
        for (std::size_t i = 0; !isOther && i < from.size(); ++i)
            isOther = !mesh.vert[i].IsD() && mesh.vert[i].cP() != rest.position[i];
        if (!isOther)
            continue;
        rest.faces = facesOf(mesh);
        rest.vertexSlots = mesh.vert.size();
        rest.ownNormals = their->ownNormals;
        rest.normalsNow = rest.normalsBefore = rest.ownNormals ? normalsOf(mesh) : 0;
        return rest;
    }
    return {};
}

bool handDownRest(const MeshDocument &document, const LayerState &state) {
    return handDown(document, state, &LayerState::rest,
                    [&state](const MeshModel &layer) { return inheritedRest(layer, {&state}); });
}

// --- what tags stand in the place of ---

namespace {

/// Finds the vertices of a tagged layer by their positions: when it was tagged and after its last pose, in layer and in
/// world coordinates, since hosts merge layers in the world.
class TaggedPlaces {
  public:
    explicit TaggedPlaces(const LayerState &state) : state(state), scan(*state.scan) {
        for (const TaggedVertex &each : scan.vertices)
            if (each.hasColor && (colors.empty() || each.tagColor != colors.back()))
                colors.push_back(each.tagColor);
        vcg::fcd::SortUnique(colors);
    }

    const KeptScan &kept() const { return scan; }

    /// The number of the tagged vertex with the position, and with the tag's colour or quality, of \p vertex; of
    /// several, the next one after the last found. 0: none.
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
    std::vector<std::pair<std::uint64_t, std::uint32_t>> places; ///< positions and numbers, ascending
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
        TaggedVertex &copy = scan.vertices[number] = {vertex.cP(), numberOf(vertex.cC()), TaggedVertex::noTag, false};
        for (TaggedPlaces &source : tagged) {
            const KeptScan &kept = source.kept();
            const std::uint32_t found = copy.hasColor || copy.hasQuality() ? 0 : source.find(vertex);
            if (found == 0)
                continue;
            copy.hasColor = kept.color;
            copy.tag = source.isTag(vertex, found) ? int(vertex.cQ()) : TaggedVertex::noTag;
            if (copy.hasColor)
                scan.colors[number] = kept.colors[found - 1];
            if (copy.hasQuality())
                scan.qualities[number] = kept.qualities[found - 1];
            scan.color |= copy.hasColor;
            scan.quality |= copy.hasQuality();
            scan.hadColor |= copy.hasColor && kept.hadColor;
            scan.hadQuality |= copy.hasQuality() && kept.hadQuality;
            scan.countedQuality |= copy.hasQuality() && kept.countedQuality;
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

bool handDownScan(const MeshDocument &document, const LayerState &state) {
    return handDown(document, state, &LayerState::scan,
                    [&state](const MeshModel &layer) { return inheritedScan(layer, {&state}); });
}

void inheritScan(const MeshDocument &document, MeshModel &layer) {
    if (!LayerState::known(layer).scan)
        if (std::optional<KeptScan> found = inheritedScan(layer, LayerState::ofOthers(document, layer)))
            LayerState::made(document, layer).scan = std::move(found);
}

void inheritState(const MeshDocument &document, MeshModel &layer) {
    RestShape::inherit(document, layer);
    inheritScan(document, layer);
}
