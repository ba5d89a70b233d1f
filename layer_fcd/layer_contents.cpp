// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_contents.h"
#include "layer_normals.h"

#include <algorithm>

#include <xxhash.h>

namespace {

/// The contents of elements, as bytes to hash.
class ContentBytes : public NumberBytes {
  public:
    template <class Vector>
    void addEach(const Vector &values, int count) {
        for (int i = 0; i < count; ++i)
            add(values[i]);
    }
    void addText(const std::string &text) {
        add(text.size());
        for (const char c : text)
            add(c);
    }
    template <class TexCoord>
    void addTexture(const TexCoord &place) {
        add(place.u(), place.v(), place.n());
    }
    std::uint64_t hash(std::uint64_t seed) const { return XXH3_64bits_withSeed(data(), size(), seed); }
};

/// A hash of the live elements. \param add add(element, bytes): adds the contents of one
template <class Elements, class Add>
std::uint64_t elementsSum(const Elements &elements, std::uint64_t seed, const Add &add) {
    return sumOf(elements.size(), [&](std::size_t first, std::size_t last) {
        ContentBytes bytes;
        for (std::size_t i = first; i < last; ++i) {
            bytes.add(elements[i].IsD());
            if (!elements[i].IsD())
                add(elements[i], bytes);
        }
        return bytes.hash(4 * first + seed);
    });
}

/// Adds the values of an attribute if it has one of these types.
template <class... Plain>
void addValues(const vcg::PointerToAttribute &attribute, std::size_t count, ContentBytes &bytes) {
    if (count > 0 && (host::isOfType<Plain>(attribute) || ...))
        bytes.add(XXH3_64bits(attribute._handle->DataBegin(), count * std::size_t(attribute._sizeof)));
}

} // namespace

std::uint64_t contentsOf(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    const bool isVertexTextured = vcg::tri::HasPerVertexTexCoord(mesh),
               isWedgeTextured = vcg::tri::HasPerWedgeTexCoord(mesh), hasFaceColor = vcg::tri::HasPerFaceColor(mesh),
               hasFaceQuality = vcg::tri::HasPerFaceQuality(mesh);
    const auto addCorners = [&mesh](const auto &element, int count, ContentBytes &bytes) {
        for (int k = 0; k < count; ++k)
            bytes.add(vcg::tri::Index(mesh, element.cV(k)));
    };
    const bool isCloud = mesh.fn == 0;
    ContentBytes all;
    all.add(elementsSum(mesh.vert, 1, [&](const CVertexO &vertex, ContentBytes &bytes) {
        bytes.addEach(vertex.cP(), 3);
        if (isCloud)
            bytes.addEach(vertex.cN(), 3);
        bytes.addEach(vertex.cC(), 4);
        bytes.add(vertex.cQ());
        if (isVertexTextured)
            bytes.addTexture(vertex.cT());
    }));
    all.add(elementsSum(mesh.face, 2, [&](const CFaceO &face, ContentBytes &bytes) {
        addCorners(face, 3, bytes);
        if (hasFaceColor)
            bytes.addEach(face.cC(), 4);
        if (hasFaceQuality)
            bytes.add(face.cQ());
        for (int k = 0; k < 3 && isWedgeTextured; ++k)
            bytes.addTexture(face.cWT(k));
    }));
    all.add(elementsSum(mesh.edge, 3, [&](const CEdgeO &edge, ContentBytes &bytes) { addCorners(edge, 2, bytes); }));
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            all.add(mesh.Tr.ElementAt(i, j));
    for (const std::string &texture : mesh.textures)
        all.addText(texture);
    for (const auto *attributes : {&mesh.vert_attr, &mesh.face_attr, &mesh.edge_attr}) {
        for (const vcg::PointerToAttribute &attribute : *attributes)
            if (!attribute._name.empty()) { // else scratch data
                all.addText(attribute._name);
                addValues<char, bool, int, unsigned, float, double, Point3m, vcg::Point3f, vcg::Color4b>(
                    attribute,
                    attributes == &mesh.vert_attr   ? mesh.vert.size()
                    : attributes == &mesh.face_attr ? mesh.face.size()
                                                    : mesh.edge.size(),
                    all);
            }
        all.addText("");
    }
    return all.hash(0);
}

std::vector<std::size_t> liveSlots(const CMeshO &mesh) {
    std::vector<std::size_t> live;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        if (!mesh.vert[i].IsD())
            live.push_back(i);
    return live;
}

Eigen::Matrix3Xd positionsOf(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    Eigen::Matrix3Xd position(3, Eigen::Index(mesh.vert.size()));
    forEach(mesh.vert.size(),
            [&](std::size_t i) { position.col(Eigen::Index(i)) = vcg::tri::PositionOf(mesh.vert[i]); });
    return position;
}

std::size_t mostBytes(const MeshModel &layer, std::size_t each) { return 1000000 + each * std::size_t(layer.cm.vn); }

std::vector<char> onSelectedFaces(const MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    std::vector<char> on(mesh.vert.size(), 0);
    for (const CFaceO &face : mesh.face)
        if (!face.IsD() && face.IsS())
            for (int k = 0; k < 3; ++k)
                on[vcg::tri::Index(mesh, face.cV(k))] = 1;
    return on;
}

bool hasQuality(const MeshModel &layer) {
    return layer.hasDataMask(MeshModel::MM_VERTQUALITY) &&
           std::any_of(layer.cm.vert.begin(), layer.cm.vert.end(),
                       [](const CVertexO &vertex) { return !vertex.IsD() && vertex.cQ() != 0; });
}

std::uint64_t normalsOf(const CMeshO &mesh) {
    return sumOfVertices(
        mesh, [&mesh](std::size_t i) { return XXH3_64bits_withSeed(&mesh.vert[i].cN()[0], 3 * sizeof(Scalarm), i); });
}

bool hasDirections(const MeshModel &layer) {
    return layer.hasDataMask(MeshModel::MM_VERTCURVDIR) || hasOwnNormals(layer);
}

static std::uint64_t cornersTerm(const std::uint32_t *corner, std::size_t first, std::size_t last) {
    return XXH3_64bits_withSeed(corner, 3 * (last - first) * sizeof *corner, first);
}

std::uint64_t facesOf(const vcg::fcd::SurfaceView &surface) {
    return sumOf(surface.faces, [&](std::size_t first, std::size_t last) {
        return cornersTerm(surface.corner + 3 * first, first, last);
    });
}

std::uint64_t facesOf(const CMeshO &mesh) {
    return sumOf(mesh.face.size(), [&](std::size_t first, std::size_t last) {
        thread_local std::vector<std::uint32_t> corner;
        corner.resize(3 * (last - first));
        for (std::size_t f = first; f < last; ++f) {
            vcg::fcd::Prefetch(&mesh.face[std::min(f + 16, last - 1)]);
            vcg::tri::ReadSlots(mesh, mesh.face[f], 3, &corner[3 * (f - first)]);
        }
        return cornersTerm(corner.data(), first, last);
    });
}
