// SPDX-License-Identifier: GPL-3.0-or-later
#include "session_parts.h" // which includes others before Qt

#include "layer_contents.h"
#include "rest_shape.h"

namespace {

// What a session tells of a vertex, if something else has moved or made some since the last pose.
enum Whereabouts : std::uint8_t { made, atHome, moved };

void readPoints(const Reader &from, const LiveVertices &live, const char *key, std::vector<Point3m> &points) {
    points.resize(live.mesh.vert.size());
    live.read(from.array<double>(key, 3), 3, [&](std::size_t i, const double *p) {
        points[i] = Point3m(Scalarm(p[0]), Scalarm(p[1]), Scalarm(p[2]));
    });
}

} // namespace

QCborMap mapOf(const KeptScan &scan, const LiveVertices &live) {
    const CMeshO &mesh = live.mesh;
    const auto vertexOf = [&](std::size_t i) {
        return scan.number[i] ? scan.vertices[scan.number[i] - 1]
                              : TaggedVertex{Point3m(), 0, TaggedVertex::noTag, false};
    };
    const auto copy = [](const vcg::Color4b &color, std::uint8_t *to) { std::copy_n(&color[0], 4, to); };
    QCborMap map{{QString("color"), scan.color},
                 {QString("quality"), scan.quality},
                 {QString("had_color"), scan.hadColor},
                 {QString("had_quality"), scan.hadQuality},
                 {QString("counted_quality"), scan.countedQuality},
                 {QString("low_tag"), scan.lowTag},
                 {QString("high_tag"), scan.highTag},
                 {QString("has_color"),
                  live.array<std::uint8_t>(1, [&](std::size_t i, auto *to) { *to = vertexOf(i).hasColor; })},
                 {QString("tag"), live.array<std::int32_t>(1, [&](std::size_t i, auto *to) { *to = vertexOf(i).tag; })},
                 {QString("tag_color"),
                  live.array<std::uint32_t>(1, [&](std::size_t i, auto *to) { *to = vertexOf(i).tagColor; })},
                 {QString("shown_color"),
                  live.array<std::uint8_t>(4, [&](std::size_t i, auto *to) { copy(mesh.vert[i].cC(), to); })},
                 {QString("shown_quality"),
                  live.array<double>(1, [&](std::size_t i, auto *to) { *to = double(mesh.vert[i].cQ()); })}};
    if (scan.color)
        map.insert(QString("colors"), live.array<std::uint8_t>(4, [&](std::size_t i, auto *to) {
            copy(scan.number[i] ? scan.colors[scan.number[i] - 1] : mesh.vert[i].cC(), to);
        }));
    if (scan.quality)
        map.insert(QString("qualities"), live.array<double>(1, [&](std::size_t i, auto *to) {
            *to = double(scan.number[i] ? scan.qualities[scan.number[i] - 1] : mesh.vert[i].cQ());
        }));
    for (const auto &[name, color] :
         {std::make_pair("low_color", scan.lowColor), std::make_pair("high_color", scan.highColor)})
        map.insert(QString(name), arrayOf(std::vector<std::uint8_t>(&color[0], &color[0] + 4)));
    return map;
}

KeptScan scanOf(const Reader &from, const LiveVertices &live, const Shape &shown) {
    const CMeshO &mesh = live.mesh;
    KeptScan scan;
    scan.color = from.flag("color");
    scan.quality = from.flag("quality");
    scan.hadColor = from.flag("had_color");
    scan.hadQuality = from.flag("had_quality");
    scan.countedQuality = from.flag("counted_quality");
    scan.lowTag = from.number("low_tag");
    scan.highTag = from.number("high_tag");
    for (const auto &[name, color] :
         {std::make_pair("low_color", &scan.lowColor), std::make_pair("high_color", &scan.highColor)}) {
        const auto values = from.array<std::uint8_t>(name, 4, 1);
        *color = vcg::Color4b(values[0], values[1], values[2], values[3]);
    }
    const auto ofColor = from.array<std::uint8_t>("has_color", 1);
    const auto tag = from.array<std::int32_t>("tag", 1);
    const auto tagColor = from.array<std::uint32_t>("tag_color", 1);
    scan.number.assign(mesh.vert.size(), 0);
    scan.vertices.resize(std::size_t(mesh.vn));
    live.read(ofColor, 1, [&](std::size_t i, const std::uint8_t *value) {
        const auto j = std::size_t(value - ofColor.data());
        scan.number[i] = std::uint32_t(j + 1);
        scan.vertices[j] = {shown.position[i], tagColor[j], tag[j], ofColor[j] != 0};
    });
    if (scan.color) {
        const auto values = from.array<std::uint8_t>("colors", 4);
        for (std::size_t j = 0; j < scan.vertices.size(); ++j)
            scan.colors.emplace_back(values[4 * j], values[4 * j + 1], values[4 * j + 2], values[4 * j + 3]);
    }
    if (scan.quality)
        for (const double value : from.array<double>("qualities", 1))
            scan.qualities.push_back(CVertexO::QualityType(value));
    scan.faces = facesOf(mesh);
    scan.vertexSlots = mesh.vert.size();
    scan.matrix = mesh.Tr;
    return scan;
}

QCborMap mapOf(const RestState &state, const LiveVertices &live) {
    const CMeshO &mesh = live.mesh;
    const auto whereaboutsOf = [&](std::size_t i) {
        const Point3m &p = mesh.vert[i].cP();
        return RestShape::isAtHome(state, i, p, RestShape::placeOf(p)) ? atHome
               : state.vertex[i].isKnown()                             ? moved
                                                                       : made;
    };
    bool areAllAtHome = true;
    Shape rest = state; // of a vertex that something else made: as it is
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        if (!mesh.vert[i].IsD()) {
            areAllAtHome = areAllAtHome && whereaboutsOf(i) == atHome;
            if (!state.vertex[i].isKnown()) {
                rest.position[i] = mesh.vert[i].cP();
                rest.normal[i] = mesh.vert[i].cN();
            }
        }
    QCborMap map = live.shape(rest);
    map.insert(QString("own_normals"), state.ownNormals);
    QCborArray earlier;
    for (const Shape &shape : state.earlier)
        earlier.append(live.shape(shape));
    map.insert(QString("earlier"), earlier);
    if (!areAllAtHome) {
        map.insert(QString("whereabouts"),
                   live.array<std::uint8_t>(1, [&](std::size_t i, auto *to) { *to = whereaboutsOf(i); }));
        map.insert(QString("posed"), live.points([&](std::size_t i) {
            return state.vertex[i].isKnown() ? toPoint(state.vertex[i].place()) : mesh.vert[i].cP();
        }));
    }
    return map;
}

Shape shapeOf(const Reader &from, const LiveVertices &live) {
    Shape shape;
    readPoints(from, live, "position", shape.position);
    readPoints(from, live, "normal", shape.normal);
    return shape;
}

PosedVertex posedAt(const Point3m &p) { return {{p[0], p[1], p[2]}, RestShape::placeOf(p)}; }

RestState restOf(const Reader &from, const LiveVertices &live, std::vector<char> &isAtHome) {
    RestState rest;
    static_cast<Shape &>(rest) = shapeOf(from, live);
    rest.ownNormals = from.flag("own_normals");
    const QCborArray earlier = from.list("earlier");
    if (std::size_t(earlier.size()) > RestShape::mostEarlier)
        from.fail("earlier has too many shapes");
    for (const auto shape : earlier)
        rest.earlier.push_back(shapeOf(from.in(QCborValue(shape), "earlier"), live));
    const std::size_t n = live.mesh.vert.size();
    rest.vertex.resize(n);
    isAtHome.assign(n, 1);
    if (from.has("whereabouts")) {
        std::vector<Point3m> posed;
        readPoints(from, live, "posed", posed);
        live.read(from.array<std::uint8_t>("whereabouts", 1), 1, [&](std::size_t i, const std::uint8_t *its) {
            if (*its > moved)
                from.fail("whereabouts is out of range");
            isAtHome[i] = *its == atHome;
            if (*its == moved)
                rest.vertex[i] = posedAt(posed[i]);
        });
    }
    rest.faces = facesOf(live.mesh);
    rest.vertexSlots = n;
    return rest;
}
