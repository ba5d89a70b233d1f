// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_matrix.h"
#include "inherited.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_normals.h"
#include "rest_shape.h"

#include <vcg/complex/algorithms/update/bounding.h>

#include <algorithm>
#include <optional>
#include <utility>

#include <xxhash.h>

using vcg::fcd::ParallelFor;

namespace {

/// A number for the positions of the live vertices.
template <class PositionOf>
std::uint64_t shapeSum(const CMeshO &mesh, const PositionOf &positionOf) {
    return sumOfVertices(mesh, [&](std::size_t i) {
        const Point3m &position = positionOf(i);
        return XXH3_64bits_withSeed(&position[0], 3 * sizeof(Scalarm), i);
    });
}

/// Flips the normals of a shape that point to the other side than those of the faces.
void turnToFaces(const CMeshO &mesh, Shape &shape) {
    std::vector<Eigen::Vector3d> sum(mesh.vert.size(), Eigen::Vector3d::Zero());
    for (const CFaceO &face : mesh.face)
        if (!face.IsD()) {
            std::uint32_t corner[3];
            vcg::tri::ReadSlots(mesh, face, 3, corner);
            const auto at = [&](int k) { return toVector(shape.position[corner[k]]); };
            const Eigen::Vector3d p = at(0), n = (at(1) - p).cross(at(2) - p);
            for (std::uint32_t slot : corner)
                sum[slot] += n;
        }
    forVertices(mesh, [&](std::size_t i) {
        if (toVector(shape.normal[i]).dot(sum[i]) < 0)
            shape.normal[i] = -shape.normal[i];
    });
}

/// Swaps the positions and normals of a mesh and of a shape.
void exchangeShapes(CMeshO &mesh, Shape &shape) {
    forVertices(mesh, [&](std::size_t i) {
        std::swap(mesh.vert[i].P(), shape.position[i]);
        std::swap(mesh.vert[i].N(), shape.normal[i]);
    });
}

/// Computes the normals of a shape from its faces. The caller has to compute those of the mesh again.
void takeNormals(CMeshO &mesh, Shape &shape) {
    exchangeShapes(mesh, shape);
    computeNormals(mesh);
    exchangeShapes(mesh, shape);
}

} // namespace

/// The rest state of a layer; null: none.
static RestState *restOf(const MeshModel &layer) {
    LayerState *state = LayerState::of(layer);
    return state && state->rest && !state->rest->vertex.empty() ? &*state->rest : nullptr;
}

bool RestShape::exists(const MeshModel &layer) { return restOf(layer) != nullptr; }

bool RestShape::inherit(const MeshDocument &document, MeshModel &layer) {
    if (!exists(layer))
        if (std::optional<RestState> found = inheritedRest(layer, LayerState::ofOthers(document, layer)))
            LayerState::made(document, layer).rest = std::move(found);
    return exists(layer);
}

void RestShape::keep(const MeshDocument &document, MeshModel &layer) {
    const CMeshO &mesh = layer.cm;
    RestState kept;
    kept.position.resize(mesh.vert.size());
    kept.normal.resize(mesh.vert.size());
    kept.vertex.resize(mesh.vert.size());
    forVertices(mesh, [&](std::size_t i) {
        const Point3m &p = mesh.vert[i].cP();
        kept.position[i] = p;
        kept.normal[i] = mesh.vert[i].cN();
        kept.vertex[i] = {{p[0], p[1], p[2]}, placeOf(p)};
    });
    kept.faces = facesOf(mesh);
    kept.vertexSlots = mesh.vert.size();
    kept.ownNormals = ::hasOwnNormals(layer);
    kept.normalsNow = kept.normalsBefore = kept.ownNormals ? normalsOf(mesh) : 0;
    LayerState &all = LayerState::made(document, layer);
    if (inherit(document, layer)) {
        RestShape last(layer);
        if (last.countStrangers() == 0 || last.followMove()) {
            const bool isOther = last.shape() != shapeOf(mesh);
            std::vector<Shape> &earlier = last.state.earlier;
            earlier.reserve(mostEarlier + 1); // nothing can fail from here on
            if (earlier.size() == mostEarlier)
                earlier.erase(earlier.begin() + 1); // the first is that of the file
            if (isOther)
                earlier.push_back(std::move(static_cast<Shape &>(last.state)));
            kept.earlier = std::move(earlier);
        }
    }
    all.rest = std::move(kept);
}

RestShape::RestShape(MeshModel &layer) : layer(layer), mesh(layer.cm), state(*restOf(layer)) { state.matrix = mesh.Tr; }

std::uint64_t RestShape::placeOf(const Point3m &position) {
    return std::max(XXH3_64bits(&position[0], 3 * sizeof(Scalarm)), XXH64_hash_t(1));
}

std::uint64_t RestShape::shape() const {
    return shapeSum(mesh, [this](std::size_t i) { return state.position[i]; });
}

std::vector<std::uint64_t> RestShape::shapes() const {
    std::vector<std::uint64_t> all;
    all.reserve(state.earlier.size() + 1);
    for (const Shape &earlier : state.earlier)
        all.push_back(shapeSum(mesh, [&earlier](std::size_t i) { return earlier.position[i]; }));
    all.push_back(shape());
    return all;
}

void RestShape::backTo(std::size_t place) {
    if (place >= state.earlier.size())
        return;
    static_cast<Shape &>(state) = std::move(state.earlier[place]);
    state.earlier.resize(place);
}

bool RestShape::isAtHome(std::size_t slot) {
    const Point3m &p = mesh.vert[slot].cP();
    const std::uint64_t here = placeOf(p);
    if (!isAtHome(state, slot, p, here))
        return false;
    state.vertex[slot].before = here;
    return true;
}

std::uint64_t RestShape::countStrangers() {
    return sumOfVertices(mesh, [this](std::size_t i) { return isAtHome(i) ? 0 : 1; });
}

bool RestShape::isSameMesh() const {
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        if (!mesh.vert[i].IsD() && !state.vertex[i].isKnown())
            return false;
    return state.vertexSlots == mesh.vert.size() && state.faces == facesOf(mesh);
}

/// If something else has moved all vertices by one affine map, moves the rest shapes by it. \return whether it did
bool RestShape::followMove() {
    std::vector<Eigen::Vector3d> from, to;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
        if (mesh.vert[i].IsD())
            continue;
        if (!state.vertex[i].isKnown())
            return false;
        from.push_back(state.vertex[i].place());
        to.push_back(toVector(mesh.vert[i].cP()));
    }
    const std::optional<Eigen::Affine3d> found = affineMapOf(from, to, layerRounding);
    if (!found)
        return false;
    const Eigen::Affine3d &move = *found;
    const bool ofFaces = !state.ownNormals && mesh.fn > 0;
    const Eigen::Matrix3d turn = move.linear().inverse().transpose();
    const auto follow = [&](Shape &shape) {
        forVertices(mesh, [&](std::size_t i) {
            shape.position[i] = toPoint(move * toVector(shape.position[i]));
            const Eigen::Vector3d n = toVector(shape.normal[i]), turned = turn * n;
            if (turned.norm() > 0)
                shape.normal[i] = toPoint(turned * (n.norm() / turned.norm()));
        });
        if (ofFaces)
            takeNormals(mesh, shape);
    };
    follow(state);
    std::for_each(state.earlier.begin(), state.earlier.end(), follow);
    if (ofFaces)
        computeFaceNormals(mesh, {});
    forVertices(mesh, [&](std::size_t i) {
        place(i, mesh.vert[i].cP());
        state.vertex[i].before = placeOf(mesh.vert[i].cP());
    });
    return true;
}

void RestShape::checkVertices(const std::string &remedy, const Remark &remark) {
    const std::uint64_t strangers = countStrangers(), now = state.ownNormals ? normalsOf(mesh) : 0;
    const bool areOwn = now == state.normalsNow || now == state.normalsBefore;
    state.normalsBefore = now;
    if (strangers == 0) {
        if (remark && !areOwn)
            remark("Something else has computed the normals of " + inQuotes(layer) +
                   " since its last pose. The pose has replaced them by the turned normals of the rest shape: compute "
                   "them again.");
        return;
    }
    if (!followMove())
        throw vcg::fcd::Error("The layer " + inQuotes(layer) +
                              " was changed since its last pose: " + std::to_string(strangers) + " of its " +
                              std::to_string(mesh.vn) + " vertices were moved or made by something else. " + remedy);
    if (remark)
        remark("Something else has moved " + inQuotes(layer) +
               " as a whole since its last pose (turned, scaled, or shifted it). Its rest shape moves along.");
}

std::uint64_t RestShape::followFaces() {
    const std::uint64_t present = facesOf(mesh);
    state.vertexSlots = mesh.vert.size();
    if (present == state.faces)
        return present;
    state.faces = present;
    state.ownNormals = ::hasOwnNormals(layer);
    if (state.ownNormals || mesh.fn == 0)
        return present;
    turnToFaces(mesh, state);
    for (Shape &earlier : state.earlier)
        turnToFaces(mesh, earlier);
    return present;
}

void RestShape::restore() {
    forVertices(mesh, [this](std::size_t i) {
        place(i, state.position[i]);
        mesh.vert[i].N() = state.normal[i];
    });
    computeFaceNormals(mesh, {});
    vcg::tri::UpdateBounding<CMeshO>::Box(mesh);
    knowNormals();
}

void RestShape::knowNormals() {
    if (state.ownNormals)
        state.normalsNow = normalsOf(mesh);
}

AtRest::AtRest(MeshModel &layer) : mesh(layer.cm), other(*restOf(layer)) { exchangeShapes(mesh, other); }
AtRest::~AtRest() { exchangeShapes(mesh, other); }

std::uint64_t shapeOf(const CMeshO &mesh) {
    return shapeSum(mesh, [&mesh](std::size_t i) { return mesh.vert[i].cP(); });
}
