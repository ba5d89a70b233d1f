// SPDX-License-Identifier: GPL-3.0-or-later
#include "picked_points.h"

#include <cmath>

#include <QXmlStreamReader>

using vcg::fcd::Error;
using vcg::fcd::PointPair;

std::vector<Eigen::Vector3d> readActivePoints(const QByteArray &text, const std::string &name) {
    QXmlStreamReader xml(text);
    const auto here = [&] { return name + ", line " + std::to_string(xml.lineNumber()) + ": "; };
    std::vector<Eigen::Vector3d> points;
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
            points.push_back(p);
        }
    if (xml.hasError()) {
        std::string reason; // may quote the file
        for (QChar c : xml.errorString().left(100))
            reason += c >= ' ' && c <= '~' ? c.toLatin1() : '?';
        while (!reason.empty() && reason.back() == '.')
            reason.pop_back();
        throw Error(here() + "expected the XML of picked points: " + reason + ".");
    }
    return points;
}

std::vector<PointPair> readPickedPoints(const QByteArray &text, const std::string &name) {
    const std::vector<Eigen::Vector3d> points = readActivePoints(text, name);
    if (points.empty() || points.size() % 2)
        throw Error(name + " holds " + std::to_string(points.size()) +
                    " active points; expected pairs of them: start, target, start, target, ...");
    std::vector<PointPair> pairs(points.size() / 2);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        pairs[i].start = points[2 * i];
        pairs[i].target = points[2 * i + 1];
    }
    return pairs;
}
