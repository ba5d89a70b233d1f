// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h> // these before Qt
#include <vcg_ext/handles/handle_file.h>

#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_matrix.h"
#include "picked_points.h"
#include "point_sources.h"

#include <algorithm>
#include <memory>

using vcg::fcd::Error;
using vcg::fcd::PointHandle;
using vcg::fcd::PointPair;

namespace {

std::vector<PointPair> readPairs(const QString &path, const QString &targets, std::size_t mostBytes) {
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

} // namespace

std::vector<PointPair> readPointPairs(const MeshModel &layer, const QString &file) {
    return readPairs(file, QString(), mostBytes(layer, 1000));
}

std::vector<PointHandle> readPointHandles(const MeshModel &layer, const Point3m *rest, const QString &file,
                                          const QString &targets) {
    const std::vector<PointPair> pairs = readPairs(file, targets, mostBytes(layer, 1000));
    const CMeshO &mesh = layer.cm;
    const Eigen::Affine3d toLayer = invertibleMatrixOf(layer).inverse();

    const std::vector<std::size_t> live = liveSlots(mesh); // files number them as MeshLab saves them

    // To find the vertex nearest to a point.
    std::vector<std::size_t> slot;
    std::vector<Eigen::Vector3d> position;
    if (std::any_of(pairs.begin(), pairs.end(), [](const PointPair &pair) { return pair.vertex < 0; }))
        for (std::size_t i : live) {
            const Eigen::Vector3d p = toVector(rest ? rest[i] : mesh.vert[i].cP());
            if (p.allFinite()) {
                slot.push_back(i);
                position.push_back(p);
            }
        }
    std::unique_ptr<vcg::fcd::PointTree<double>> tree;
    if (!position.empty())
        tree = std::make_unique<vcg::fcd::PointTree<double>>(position);

    std::vector<PointHandle> handles;
    for (const PointPair &pair : pairs) {
        PointHandle handle;
        handle.target = toLayer * pair.target;
        if (pair.vertex >= 0) {
            if (std::size_t(pair.vertex) >= live.size())
                throw Error(inQuotes(file) + " names vertex " + std::to_string(pair.vertex) +
                            ", but the layer has vertices 0 to " + std::to_string(live.size() - 1) + ".");
            handle.vertex = live[std::size_t(pair.vertex)];
        } else if (tree) {
            const Eigen::Vector3d start = toLayer * pair.start;
            const auto nearest = std::size_t(tree->Nearest(start));
            handle.vertex = slot[nearest];
            handle.target += position[nearest] - start;
        } else {
            throw Error("The coordinates of the layer are not finite numbers, so no vertex is nearest to a point.");
        }
        handles.push_back(handle);
    }
    return handles;
}
