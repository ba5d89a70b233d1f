// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // these before Qt
#include <vcg_ext/line/line_points.h>

#include "point_sources.h" // which includes others before Qt
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "picked_points.h"

#include <algorithm>
#include <sstream>

using vcg::fcd::Error;
using vcg::fcd::Index;
using vcg::fcd::Landmark;
using vcg::fcd::PointHandle;
using vcg::fcd::PointPair;

static std::vector<PointPair> readPairs(const QString &path, const QString &targets, std::size_t mostBytes) {
    const auto read = [&](const QString &file) {
        return QByteArray::fromStdString(vcg::fcd::ReadFile(pathOf(file), mostBytes));
    };
    const auto isPicked = [](const QString &file) { return file.endsWith(".pp", Qt::CaseInsensitive); };
    if (!targets.isEmpty()) {
        if (!isPicked(path) || !isPicked(targets))
            throw Error("Points are matched by name where both files are picked points (.pp) of MeshLab.");
        return matchPickedPoints(read(path), inQuotes(path), read(targets), inQuotes(targets));
    }
    if (!isPicked(path))
        return vcg::fcd::ReadPointHandleFile(pathOf(path), mostBytes);
    return readPickedPoints(read(path), inQuotes(path));
}

VertexFinder::VertexFinder(const MeshModel &layer, const Point3m *rest)
    : world(invertibleMatrixOf(layer)), layer(layer), rest(rest), live(liveSlots(layer.cm)) {}

std::size_t VertexFinder::numbered(std::int64_t number, const QString &file) const {
    if (std::size_t(number) >= live.size()) // files number them as MeshLab saves them
        throw Error(inQuotes(file) + " names vertex " + std::to_string(number) + ", but the layer has vertices 0 to " +
                    std::to_string(live.size() - 1) + ".");
    return live[std::size_t(number)];
}

void VertexFinder::plant() {
    Eigen::AlignedBox3d box;
    for (std::size_t i : live)
        if (const Eigen::Vector3d p = world * at(i); p.allFinite()) {
            slot.push_back(i);
            place.push_back(p);
            box.extend(p);
        }
    if (place.empty())
        throw Error("The coordinates of the layer are not finite numbers, so no vertex is nearest to a point.");
    size = box.diagonal().norm();
    tree = std::make_unique<vcg::fcd::PointTree<double>>(place);
}

std::size_t VertexFinder::nearestTo(const Eigen::Vector3d &point, std::size_t number) {
    if (!tree)
        plant();
    const auto nearest = std::size_t(tree->Nearest(point));
    if (const double off = (place[nearest] - point).norm(); off > size) {
        if (strays.empty() || strays.back() != number) // of a pair, both may be
            strays.push_back(number);
        farthest = std::max(farthest, off);
    }
    return slot[nearest];
}

Eigen::Vector3d VertexFinder::beside(std::size_t vertex, const Eigen::Vector3d &point) const {
    const Eigen::Vector3d off = point - world * at(vertex);
    return off.norm() > 1e-6 * size ? off : Eigen::Vector3d::Zero();
}

void VertexFinder::tellFar(const QString &file, const Remark &remark) {
    if (remark && !strays.empty()) {
        std::ostringstream text;
        text << (strays.size() == 1 ? "Point " : "Points ");
        for (std::size_t i = 0; i < strays.size() && i < 10; ++i) // enough to find them in the file
            text << (i > 0 ? ", " : "") << strays[i];
        text << (strays.size() > 10 ? ", ..." : "") << " of " << inQuotes(file) << ", counted from 0, "
             << (strays.size() == 1 ? "is " : "are up to ") << farthest << " from " << inQuotes(layer) << ", which is "
             << size << " large. The nearest vertex stands for a point: look whether the coordinates are right.";
        remark(text.str());
    }
    strays.clear();
    farthest = 0;
}

std::vector<PointPair> readPointPairs(const MeshModel &layer, const QString &file) {
    return readPairs(file, QString(), mostBytes(layer, 1000));
}

std::vector<Landmark> readLandmarks(const MeshModel &layer, const Point3m *rest, const QString &file,
                                    const QString &targets, const Remark &remark) {
    const std::vector<PointPair> pairs = readPairs(file, targets, mostBytes(layer, 1000));
    VertexFinder vertices(layer, rest);
    std::vector<Landmark> landmarks;
    for (const PointPair &pair : pairs)
        if (pair.vertex >= 0) {
            landmarks.push_back({vertices.numbered(pair.vertex, file), pair.target});
        } else {
            const std::size_t vertex = vertices.nearestTo(pair.start, landmarks.size());
            landmarks.push_back({vertex, pair.target, vertices.beside(vertex, pair.start)});
        }
    vertices.tellFar(file, remark);
    return landmarks;
}

std::vector<PointHandle> readPointHandles(const MeshModel &layer, const Point3m *rest, const QString &file,
                                          const Remark &remark) {
    const Eigen::Affine3d toLayer = invertibleMatrixOf(layer).inverse();
    std::vector<PointHandle> handles;
    for (const Landmark &each : readLandmarks(layer, rest, file, QString(), remark))
        handles.push_back({each.vertex, toLayer * each.target - toLayer.linear() * each.offset});
    return handles;
}

Eigen::Matrix3Xd readLine(const MeshModel &layer) {
    std::vector<std::array<Index, 2>> edges;
    const CMeshO &mesh = layer.cm;
    for (const auto &edge : mesh.edge)
        if (!edge.IsD())
            edges.push_back({Index(edge.cV(0) - mesh.vert.data()), Index(edge.cV(1) - mesh.vert.data())});
    const std::vector<Index> path = vcg::fcd::PathOfEdges(std::move(edges), "The layer " + inQuotes(layer));
    const Eigen::Affine3d matrix = matrixOf(layer);
    Eigen::Matrix3Xd points(3, Eigen::Index(path.size()));
    for (std::size_t i = 0; i < path.size(); ++i)
        points.col(Eigen::Index(i)) = matrix * toVector(mesh.vert[std::size_t(path[i])].cP());
    return points;
}

Eigen::Matrix3Xd readLine(const QString &file) {
    const std::size_t most = 100000000; // bytes, of a million points
    const std::string text = vcg::fcd::ReadFile(pathOf(file), most);
    if (!file.endsWith(".pp", Qt::CaseInsensitive))
        return vcg::fcd::ReadLineText(text, file.toStdString());
    const std::vector<Eigen::Vector3d> picked = readActivePoints(QByteArray::fromStdString(text), inQuotes(file));
    Eigen::Matrix3Xd points(3, Eigen::Index(picked.size()));
    for (std::size_t i = 0; i < picked.size(); ++i)
        points.col(Eigen::Index(i)) = picked[i];
    return points;
}
