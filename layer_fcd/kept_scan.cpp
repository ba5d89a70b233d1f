// SPDX-License-Identifier: GPL-3.0-or-later
#include "affine_map.h"
#include "kept_scan.h"
#include "layer_contents.h"
#include "parameters.h"
#include "rest_shape.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace {

/// The longest edge at each vertex.
std::vector<double> longestEdges(const CMeshO &mesh) {
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

} // namespace

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
    Eigen::Vector4d mean = Eigen::Vector4d::Zero();
    double sum = 0;
    for (const Near &each : nearTo(i)) {
        const vcg::Color4b &c = scan.colors[each.kept];
        mean += each.weight * Eigen::Vector4d(c[0], c[1], c[2], c[3]);
        sum += each.weight;
    }
    if (sum == 0)
        return {};
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
    double mean = 0, sum = 0;
    for (const Near &each : nearTo(i)) {
        mean += each.weight * double(scan.qualities[each.kept]);
        sum += each.weight;
    }
    return sum == 0 ? std::nullopt : std::optional<CVertexO::QualityType>(CVertexO::QualityType(mean));
}
