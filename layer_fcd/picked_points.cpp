// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h> // before Qt

#include "picked_points.h"

#include <cmath>
#include <map>

#include <QXmlStreamReader>
#include <QXmlStreamWriter>

using vcg::fcd::Error;
using vcg::fcd::PointPair;

namespace {

struct Picked {
    QString name;
    Eigen::Vector3d point;
};

std::vector<Picked> readActive(const QByteArray &text, const std::string &name) {
    QXmlStreamReader xml(text);
    const auto here = [&] { return name + ", line " + std::to_string(xml.lineNumber()) + ": "; };
    std::vector<Picked> points;
    while (!xml.atEnd())
        if (xml.readNext() == QXmlStreamReader::StartElement && xml.name() == QLatin1String("point")) {
            const QXmlStreamAttributes attributes = xml.attributes();
            const QString active = attributes.value("active").toString();
            if (active == "0" || active.compare("false", Qt::CaseInsensitive) == 0)
                continue;
            Eigen::Vector3d p;
            const char *const coordinate[3] = {"x", "y", "z"};
            for (int d = 0; d < 3; ++d) {
                bool ok = false;
                p[d] = attributes.value(coordinate[d]).toDouble(&ok);
                if (!ok || !std::isfinite(p[d]))
                    throw Error(here() + "expected a number as " + coordinate[d] + " of the point.");
            }
            points.push_back({attributes.value("name").toString(), p});
        }
    if (xml.hasError()) {
        std::string reason = vcg::fcd::detail::Printable(xml.errorString().toStdString(), 100); // may quote the file
        while (!reason.empty() && reason.back() == '.')
            reason.pop_back();
        throw Error(here() + "expected the XML of picked points: " + reason + ".");
    }
    return points;
}

/// A name as a message may hold it.
std::string plain(const QString &name) {
    const std::string text = name.toStdString();
    return vcg::fcd::detail::Excerpt(text, 0, text.size());
}

std::map<QString, Eigen::Vector3d> byName(const std::vector<Picked> &points, const std::string &file) {
    std::map<QString, Eigen::Vector3d> found;
    for (const Picked &each : points)
        if (!found.emplace(each.name, each.point).second)
            throw Error(file + " holds two active points with the name " + plain(each.name) +
                        ". Give each a name of its own, or switch one off.");
    return found;
}

} // namespace

std::vector<PointPair> matchPickedPoints(const QByteArray &starts, const std::string &startsName,
                                         const QByteArray &targets, const std::string &targetsName) {
    const std::vector<Picked> from = readActive(starts, startsName);
    byName(from, startsName);
    const auto to = byName(readActive(targets, targetsName), targetsName);
    std::vector<PointPair> pairs;
    for (const Picked &each : from)
        if (const auto found = to.find(each.name); found != to.end()) {
            pairs.emplace_back();
            pairs.back().start = each.point;
            pairs.back().target = found->second;
        }
    if (pairs.empty() || pairs.size() < from.size() || pairs.size() < to.size())
        throw Error(startsName + " holds " + std::to_string(from.size()) + " active points and " + targetsName + " " +
                    std::to_string(to.size()) + ", of which " + std::to_string(pairs.size()) +
                    " have the same names. Name each pair alike in both, and switch the others off.");
    return pairs;
}

std::vector<Eigen::Vector3d> readActivePoints(const QByteArray &text, const std::string &name) {
    std::vector<Eigen::Vector3d> points;
    for (const Picked &each : readActive(text, name))
        points.push_back(each.point);
    return points;
}

std::vector<PointPair> readPickedPoints(const QByteArray &text, const std::string &name) {
    const std::vector<Picked> points = readActive(text, name);
    if (points.empty() || points.size() % 2)
        throw Error(name + " holds " + std::to_string(points.size()) +
                    " active points; expected pairs of them: start, target, start, target, ...");
    std::vector<PointPair> pairs(points.size() / 2);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].start = points[2 * i].point;
        pairs[i].target = points[2 * i + 1].point;
    }
    return pairs;
}

std::vector<std::string> namesOfPickedPoints(const QByteArray &text, const std::string &name) {
    std::vector<std::string> names;
    for (const Picked &each : readActive(text, name))
        names.push_back(each.name.toStdString());
    return names;
}

QByteArray pickedPointsText(const std::vector<std::pair<std::string, Eigen::Vector3d>> &points) {
    QByteArray text;
    QXmlStreamWriter xml(&text);
    xml.setAutoFormatting(true);
    xml.writeDTD("<!DOCTYPE PickedPoints>");
    xml.writeStartElement("PickedPoints");
    for (const auto &[name, point] : points) {
        xml.writeEmptyElement("point");
        const char *const coordinate[3] = {"x", "y", "z"};
        for (int d = 0; d < 3; ++d)
            xml.writeAttribute(coordinate[d], QString::fromStdString(vcg::fcd::detail::ToText(point[d])));
        xml.writeAttribute("name", QString::fromStdString(name));
        xml.writeAttribute("active", "1");
    }
    xml.writeEndDocument();
    return text;
}
