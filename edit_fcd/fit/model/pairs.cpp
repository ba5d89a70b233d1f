// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/point_tree.h> // these before Qt
#include <vcg_ext/base/words.h>
#include <vcg_ext/handles/handle_file.h>

#include "edit_fcd/fit/model/pairs.h"

#include <layer_fcd/layer_contents.h>
#include <layer_fcd/layer_labels.h>
#include <layer_fcd/layer_matrix.h>
#include <layer_fcd/picked_points.h>
#include <layer_fcd/point_sources.h>
#include <layer_fcd/save_files.h>

#include <algorithm>
#include <utility>

using vcg::fcd::Error;

namespace {

const std::size_t mostBytes = 100000000; // of a file

QByteArray bytesOf(const QString &file) {
    return QByteArray::fromStdString(vcg::fcd::ReadFile(pathOf(file), mostBytes));
}

bool isPicked(const QString &file) { return file.endsWith(".pp", Qt::CaseInsensitive); }

std::vector<Eigen::Vector3d> inWorld(const MeshModel &layer, const Point3m *rest,
                                     const std::vector<std::size_t> &slot) {
    const Eigen::Affine3d world = invertibleMatrixOf(layer);
    std::vector<Eigen::Vector3d> position;
    position.reserve(slot.size());
    for (const std::size_t i : slot)
        position.push_back(world * toVector(rest[i]));
    return position;
}

/// The live vertices of a layer at rest, world.
struct RestPlaces {
    std::vector<std::size_t> slot;
    std::vector<Eigen::Vector3d> position;
    vcg::fcd::PointTree<double> tree;

    RestPlaces(const MeshModel &layer, const Point3m *rest)
        : slot(liveSlots(layer.cm)), position(inWorld(layer, rest, slot)), tree(position) {}
    std::size_t nearest(const Eigen::Vector3d &place) const { return std::size_t(tree.Nearest(place)); }
};

/// The mean distance of the points of a .pp file from a layer, world.
double farFrom(const MeshModel &layer, const Point3m *rest, const QString &file) {
    const std::vector<Eigen::Vector3d> points = readActivePoints(bytesOf(file), inQuotes(file));
    const RestPlaces places(layer, rest);
    double sum = 0;
    for (const Eigen::Vector3d &p : points)
        sum += (places.position[places.nearest(p)] - p).norm();
    return points.empty() ? 0 : sum / double(points.size());
}

/// The names of the pairs of a file: of picked points, those of the first ends; in a list, what follows #, or empty.
std::vector<std::string> namesIn(const QString &file, bool isOfPairs) {
    std::vector<std::string> names;
    if (isPicked(file)) {
        const std::vector<std::string> all = namesOfPickedPoints(bytesOf(file), inQuotes(file));
        for (std::size_t i = 0; i < all.size(); i += isOfPairs ? 2 : 1)
            names.push_back(all[i]);
        return names;
    }
    for (const QByteArray &line : bytesOf(file).split('\n')) {
        const int at = line.indexOf('#');
        const QByteArray numbers = (at < 0 ? line : line.left(at)).trimmed();
        if (!numbers.isEmpty() && QByteArray("+-.0123456789").contains(numbers[0]))
            names.push_back(at < 0 ? "" : line.mid(at + 1).trimmed().toStdString());
    }
    return names;
}

std::string inNumbers(const Eigen::Vector3d &place) {
    using vcg::fcd::detail::ToText;
    return ToText(place[0]) + ", " + ToText(place[1]) + ", " + ToText(place[2]);
}

} // namespace

std::vector<FitPair> loadPairs(const MeshModel &layer, const Point3m *rest, const QStringList &files) {
    QString own = files[0], other = files.size() == 2 ? files[1] : QString();
    if (isPicked(own) && isPicked(other) && farFrom(layer, rest, other) < farFrom(layer, rest, own))
        std::swap(own, other);
    const std::vector<vcg::fcd::Landmark> read = readLandmarks(layer, rest, own, other);
    std::vector<std::string> names = namesIn(own, other.isEmpty());
    names.resize(read.size());
    const Eigen::Matrix3d toLayer = invertibleMatrixOf(layer).linear().inverse();
    std::vector<FitPair> pairs;
    pairs.reserve(read.size());
    for (std::size_t i = 0; i < read.size(); ++i)
        pairs.push_back({names[i].empty() ? std::to_string(i + 1) : names[i], read[i].vertex, read[i].target,
                         toLayer * read[i].offset});
    return pairs;
}

void savePairs(const MeshModel &layer, const Point3m *rest, const std::vector<FitPair> &pairs, const QString &file) {
    expectSavable(pairs);
    const std::vector<std::size_t> live = liveSlots(layer.cm); // files number live vertices
    const Eigen::Affine3d world = invertibleMatrixOf(layer);
    std::vector<std::pair<std::string, Eigen::Vector3d>> points;
    std::string list = "# vertex, x, y, z of its place on the target # name\n";
    for (const FitPair &each : pairs) {
        if (!each.slot || !each.place)
            continue; // never: expectSavable()
        const std::size_t slot = *each.slot;
        const Eigen::Vector3d start = world * (toVector(rest[slot]) + each.offset), place = *each.place;
        points.emplace_back(each.name, start);
        points.emplace_back(each.name, place);
        if (each.offset.isZero(0))
            list += vcg::fcd::detail::ToText(std::lower_bound(live.begin(), live.end(), slot) - live.begin());
        else
            list += inNumbers(start);
        list += ", " + inNumbers(place) + " # " + each.name + "\n";
    }
    saveFiles({{file, isPicked(file) ? pickedPointsText(points).toStdString() : list}});
}

void expectSavable(const std::vector<FitPair> &pairs) {
    if (pairs.empty())
        throw Error("There is no pair of landmarks to be saved.");
    expectWhole(pairs);
}

void expectWhole(const std::vector<FitPair> &pairs) {
    for (const FitPair &each : pairs)
        if (!each.isWhole())
            throw Error("The pair '" + each.name +
                        "' is on one layer only. Click its point on the other one, or remove the pair.");
}

void addPair(std::vector<FitPair> &pairs, std::size_t slot) {
    int number = int(pairs.size()) + 1;
    const auto isTaken = [&](const std::string &name) {
        return std::any_of(pairs.begin(), pairs.end(), [&](const FitPair &p) { return p.name == name; });
    };
    while (isTaken(std::to_string(number)))
        ++number;
    pairs.emplace_back().name = std::to_string(number);
    try {
        setSource(pairs, pairs.size() - 1, slot);
    } catch (...) {
        pairs.pop_back();
        throw;
    }
}

void setSource(std::vector<FitPair> &pairs, std::size_t pair, std::size_t slot) {
    for (std::size_t i = 0; i < pairs.size(); ++i)
        if (i != pair && pairs[i].slot == slot)
            throw Error("The pair '" + pairs[i].name +
                        "' is at that vertex already. Drag its point elsewhere, or "
                        "click another place.");
    pairs[pair].slot = slot;
    pairs[pair].offset.setZero();
}

std::shared_ptr<const FitLines> loadLines(const MeshModel &layer, const Point3m *rest, const std::string &file) {
    auto lines = std::make_shared<FitLines>();
    lines->file = file;
    lines->curves = vcg::fcd::ReadCurveFile(pathOf(QString::fromStdString(file)));
    const RestPlaces places(layer, rest);
    for (const vcg::fcd::CurvePair &curve : lines->curves) {
        std::vector<std::size_t> &nearest = lines->nearest.emplace_back();
        for (const Eigen::Vector3d &corner : curve.source)
            nearest.push_back(places.slot[places.nearest(corner)]);
    }
    return lines;
}
