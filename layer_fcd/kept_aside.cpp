// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "kept_aside.h"
#include "layer_contents.h"
#include "marks.h"
#include "mesh_copy.h"

#include <vcg/complex/allocate.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <type_traits>

using vcg::fcd::Error;

namespace {

using Quality = CVertexO::QualityType;

const char *const colorName = "fcd_color", *const qualityName = "fcd_quality", *const tagName = "fcd_tagged_1",
                  *const asideName = "fcd_aside_2";

/// What a layer keeps aside. Who changes it changes the number in asideName.
struct Aside {
    bool color = false, quality = false;       ///< kept, or known not to have been there
    bool hadColor = false, hadQuality = false; ///< and there was some
    bool countedQuality = false;               ///< the layer said that it had some, be it 0
};
static_assert(std::is_trivially_copyable<Aside>::value, "plain data, whoever has made it");

/// What tags have left of a vertex, zero for one that something else makes. Who changes it changes the number in
/// tagName.
struct TaggedVertex {
    std::uint32_t color;
    bool hasColor, hasQuality; ///< of it is kept aside
};
static_assert(std::is_trivial<TaggedVertex>::value, "plain data, zero for new vertices");

Aside *asideOf(const CMeshO &mesh) { return host::meshAttribute<Aside>(mesh, asideName); }

void drop(CMeshO &mesh, const char *name) {
    if (vcg::tri::HasPerVertexAttribute(mesh, name))
        vcg::tri::Allocator<CMeshO>::DeletePerVertexAttribute(mesh, name);
}

std::uint32_t numberOf(const vcg::Color4b &c) {
    return std::uint32_t(c[0]) | std::uint32_t(c[1]) << 8 | std::uint32_t(c[2]) << 16 | std::uint32_t(c[3]) << 24;
}

/// What is kept aside of the vertices of a layer.
class KeptVertices {
  public:
    explicit KeptVertices(const CMeshO &mesh)
        : color(host::vertexAttribute<vcg::Color4b>(mesh, colorName)),
          quality(host::vertexAttribute<Quality>(mesh, qualityName)),
          tagged(host::vertexAttribute<TaggedVertex>(mesh, tagName)), mesh(mesh) {
        // Tags may be changed by whoever computes a quality; what is no whole number is no tag, and then none is one.
        std::atomic<bool> whole{tagged && quality};
        if (whole)
            forVertices(mesh, [&](std::size_t i) {
                const auto q = mesh.vert[i].cQ();
                if (tagged[i].hasQuality && q != std::round(q))
                    whole = false;
            });
        areTags = whole;
    }

    bool isColorOfTag(std::size_t i) const {
        return tagged && color && tagged[i].hasColor && tagged[i].color == numberOf(mesh.vert[i].cC());
    }
    bool isQualityTag(std::size_t i) const { return areTags && tagged[i].hasQuality; }

    vcg::Color4b *const color;
    Quality *const quality;
    TaggedVertex *const tagged;

  private:
    const CMeshO &mesh;
    bool areTags;
};

} // namespace

bool isAside(const std::string &attribute) {
    return attribute == colorName || attribute == qualityName || attribute == tagName;
}

void keepAside(MeshModel &layer, bool color, bool quality) {
    CMeshO &mesh = layer.cm;
    Aside &aside = host::madeMeshAttribute<Aside>(mesh, asideName);
    host::madeVertexAttribute<TaggedVertex>(mesh, tagName);
    if (color)
        host::madeVertexAttribute<vcg::Color4b>(mesh, colorName);
    if (quality)
        host::madeVertexAttribute<Quality>(mesh, qualityName);
    const KeptVertices kept(mesh);
    if (color) {
        std::atomic<bool> any{false};
        const bool has = layer.hasDataMask(MeshModel::MM_VERTCOLOR);
        forVertices(mesh, [&](std::size_t i) {
            if (kept.isColorOfTag(i))
                return;
            kept.color[i] = has ? mesh.vert[i].cC() : vcg::Color4b(vcg::Color4b::White);
            kept.tagged[i].hasColor = true;
            any = true;
        });
        if (any)
            aside.hadColor = has;
        aside.color = true;
    }
    if (quality) {
        const bool has = hasQuality(layer);
        std::atomic<bool> areTags{false};
        forVertices(mesh, [&](std::size_t i) {
            if (has && kept.isQualityTag(i)) {
                areTags = true;
                return;
            }
            kept.quality[i] = has ? mesh.vert[i].cQ() : 0;
            kept.tagged[i].hasQuality = true;
        });
        if (!areTags) {
            aside.hadQuality = has;
            aside.countedQuality = layer.hasDataMask(MeshModel::MM_VERTQUALITY);
        }
        aside.quality = true;
    }
}

void coloredByTags(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    if (auto *tagged = asideOf(mesh) ? host::vertexAttribute<TaggedVertex>(mesh, tagName) : nullptr)
        forVertices(mesh, [&](std::size_t i) { tagged[i].color = numberOf(mesh.vert[i].cC()); });
}

int bringBack(MeshModel &layer) {
    CMeshO &mesh = layer.cm;
    const Aside *aside = asideOf(mesh);
    const bool hadMarks = hasMarks(layer);
    dropMarks(layer);
    if (!aside && hadMarks)
        return 0;
    if (!aside)
        throw Error("The layer '" + layer.label().toStdString() +
                    "' has no tags of an FCD filter and no marks of the tool, so there is nothing to bring back.");
    const KeptVertices kept(mesh);
    std::atomic<int> others{0}, otherColors{0}, otherQualities{0};
    forVertices(mesh, [&](std::size_t i) {
        CVertexO &vertex = mesh.vert[i];
        const bool color = aside->color && kept.isColorOfTag(i), quality = aside->quality && kept.isQualityTag(i);
        if (color)
            vertex.C() = kept.color[i];
        if (quality)
            vertex.Q() = kept.quality[i];
        otherColors += aside->color && !color;
        otherQualities += aside->quality && !quality;
        others += (aside->color && !color) || (aside->quality && !quality);
    });
    if (aside->color && !aside->hadColor && otherColors == 0)
        layer.clearDataMask(MeshModel::MM_VERTCOLOR);
    if (aside->quality && !aside->countedQuality && otherQualities == 0)
        layer.clearDataMask(MeshModel::MM_VERTQUALITY);
    drop(mesh, colorName);
    drop(mesh, qualityName);
    drop(mesh, tagName);
    vcg::tri::Allocator<CMeshO>::DeletePerMeshAttribute(mesh, asideName);
    return others;
}

void bringBackTo(MeshModel &copy, const MeshModel &layer) {
    const CMeshO &from = layer.cm;
    const Aside *aside = asideOf(from);
    if (!aside)
        return;
    const KeptVertices kept(from);
    std::atomic<bool> otherColors{false};
    Packing(from.vert, from.vn).forEach([&](std::size_t i, std::size_t j) {
        CVertexO &to = copy.cm.vert[j];
        // Colours that were changed after tagging are meant to be seen.
        if (aside->color && kept.isColorOfTag(i))
            to.C() = kept.color[i];
        else
            otherColors = true;
        if (aside->quality && aside->hadQuality && kept.isQualityTag(i))
            to.Q() = kept.quality[i];
    });
    if (aside->color && !aside->hadColor && !otherColors)
        copy.clearDataMask(MeshModel::MM_VERTCOLOR);
}
