// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/centroidal_deformation.h> // before Qt

#include "kept_aside.h"
#include "layer_contents.h"
#include "mesh_copy.h"

#include <vcg/complex/allocate.h>

#include <cstdint>
#include <type_traits>

using vcg::fcd::Error;

namespace {

using Quality = CVertexO::QualityType;

const char *const colorName = "fcd_color", *const qualityName = "fcd_quality", *const asideName = "fcd_aside_1";

/// What a layer keeps aside, and by what tags are recognised. Who changes it changes the number in asideName.
struct Aside {
    bool color = false, quality = false;       ///< kept, or known not to have been there
    bool hadColor = false, hadQuality = false; ///< and there was some
    bool countedQuality = false;               ///< the layer said that it had some, be it 0
    std::uint64_t tagColors = 0;               ///< sum over the colours of the tags
};
static_assert(std::is_trivially_copyable<Aside>::value, "plain data, whoever has made it");

Aside *asideOf(const CMeshO &mesh) { return host::meshAttribute<Aside>(mesh, asideName); }

template <class T, class ValueOf>
void keep(CMeshO &mesh, const char *name, const ValueOf &valueOf) {
    T *value = host::madeVertexAttribute<T>(mesh, name);
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        value[i] = valueOf(mesh.vert[i]);
}

void drop(CMeshO &mesh, const char *name) {
    if (vcg::tri::HasPerVertexAttribute(mesh, name))
        vcg::tri::Allocator<CMeshO>::DeletePerVertexAttribute(mesh, name);
}

/// A number for the colours of all vertices.
std::uint64_t sumOfColors(const CMeshO &mesh) {
    std::uint64_t sum = 0, place = 0;
    for (const CVertexO &vertex : mesh.vert) {
        const vcg::Color4b rgba = vertex.cC();
        const std::uint64_t color = rgba[0] + 256 * (rgba[1] + 256 * (rgba[2] + std::uint64_t(256) * rgba[3]));
        sum += (color + 1) * (++place * 2 + 1) * 0x9E3779B97F4A7C15U;
    }
    return sum;
}

} // namespace

bool isAside(const std::string &attribute) { return attribute == colorName || attribute == qualityName; }

void keepAside(MeshModel &layer, bool color, bool quality) {
    CMeshO &mesh = layer.cm;
    Aside *aside = &host::madeMeshAttribute<Aside>(mesh, asideName);
    if (color && !(aside->color && aside->tagColors == sumOfColors(mesh))) {
        aside->hadColor = layer.hasDataMask(MeshModel::MM_VERTCOLOR);
        if (aside->hadColor)
            keep<vcg::Color4b>(mesh, colorName, [](const CVertexO &vertex) { return vertex.cC(); });
        aside->color = true;
    }
    if (quality && !(aside->quality && mayHaveTags(layer))) {
        aside->countedQuality = layer.hasDataMask(MeshModel::MM_VERTQUALITY);
        aside->hadQuality = hasQuality(layer);
        if (aside->hadQuality)
            keep<Quality>(mesh, qualityName, [](const CVertexO &vertex) { return vertex.cQ(); });
        aside->quality = true;
    }
}

void coloredByTags(const MeshModel &layer) {
    if (Aside *aside = asideOf(layer.cm))
        aside->tagColors = sumOfColors(layer.cm);
}

void bringBack(MeshModel &layer) {
    CMeshO &mesh = layer.cm;
    const Aside *aside = asideOf(mesh);
    if (!aside)
        throw Error("The layer '" + layer.label().toStdString() +
                    "' has no tags that an FCD filter gave it, so there is nothing to bring back.");
    if (aside->color) {
        if (const auto *color = aside->hadColor ? host::vertexAttribute<vcg::Color4b>(mesh, colorName) : nullptr)
            for (std::size_t i = 0; i < mesh.vert.size(); ++i)
                mesh.vert[i].C() = color[i];
        else {
            for (CVertexO &vertex : mesh.vert)
                vertex.C() = vcg::Color4b(vcg::Color4b::White);
            layer.clearDataMask(MeshModel::MM_VERTCOLOR);
        }
    }
    if (aside->quality) {
        const auto *quality = aside->hadQuality ? host::vertexAttribute<Quality>(mesh, qualityName) : nullptr;
        for (std::size_t i = 0; i < mesh.vert.size(); ++i)
            mesh.vert[i].Q() = quality ? quality[i] : 0;
        if (!aside->countedQuality)
            layer.clearDataMask(MeshModel::MM_VERTQUALITY);
    }
    drop(mesh, colorName);
    drop(mesh, qualityName);
    vcg::tri::Allocator<CMeshO>::DeletePerMeshAttribute(mesh, asideName);
}

void bringBackTo(MeshModel &copy, const MeshModel &layer) {
    const CMeshO &from = layer.cm;
    const Aside *aside = asideOf(from);
    if (!aside)
        return;
    // Colours that were changed after tagging are meant to be seen.
    const bool color = aside->color && aside->tagColors == sumOfColors(from);
    const auto *colors = color && aside->hadColor ? host::vertexAttribute<vcg::Color4b>(from, colorName) : nullptr;
    const auto *quality =
        aside->quality && aside->hadQuality ? host::vertexAttribute<Quality>(from, qualityName) : nullptr;
    if (color || quality)
        Packing(from.vert, from.vn).forEach([&](std::size_t i, std::size_t j) {
            CVertexO &to = copy.cm.vert[j];
            if (color)
                to.C() = colors ? colors[i] : vcg::Color4b(vcg::Color4b::White);
            if (quality)
                to.Q() = quality[i];
        });
    if (color && !colors)
        copy.clearDataMask(MeshModel::MM_VERTCOLOR);
}
