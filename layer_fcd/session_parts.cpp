// SPDX-License-Identifier: GPL-3.0-or-later
#include "session_format.h" // which includes others before Qt
#include "bend_state.h"
#include "kept_tool.h"
#include "layer_contents.h"
#include "layer_matrix.h"
#include "rest_shape.h"
#include "session_file.h"
#include "weight_sources.h"

#include <QFile>

using vcg::fcd::Error;

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
        live.read(from.array<std::uint8_t>("whereabouts", 1), 1, [&](std::size_t i, const std::uint8_t *kind) {
            if (*kind > moved)
                from.fail("whereabouts is out of range");
            isAtHome[i] = *kind == atHome;
            if (*kind == moved)
                rest.vertex[i] = posedAt(posed[i]);
        });
    }
    rest.faces = facesOf(live.mesh);
    rest.vertexSlots = n;
    return rest;
}

static QCborValue valueOf(const Matrix44m &matrix) {
    std::vector<double> values(16);
    for (int k = 0; k < 16; ++k)
        values[std::size_t(k)] = double(matrix[k % 4][k / 4]);
    return arrayOf(std::move(values));
}

/// The saved matrix, if the layer has it, or has none and shall get it. \throw Error the layer has another matrix
static Matrix44m matrixThen(const Reader &from, const MeshModel &layer, const QString &file) {
    Matrix44m matrix;
    const std::vector<double> values = from.array<double>("matrix", 16, 1);
    for (int k = 0; k < 16; ++k)
        matrix[k % 4][k / 4] = Scalarm(values[std::size_t(k)]);
    Eigen::Affine3d then;
    matrix.ToEigenMatrix(then.matrix());
    if (then.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1) || !std::isnormal(then.linear().determinant()))
        from.fail("matrix is none that a layer can have");
    const Eigen::Affine3d now = matrixOf(layer);
    const double rounding = 1e-5; // a project has six digits
    const bool isSame = now.linear().isApprox(then.linear(), rounding) &&
                        (now.translation() - then.translation()).norm() <= rounding * then.translation().norm();
    if (!isSame && !now.matrix().isIdentity(0))
        throw Error(inQuotes(file) + " was saved with another matrix than " + inQuotes(layer) +
                    " has now, and its motions or fit are in world coordinates. Reset the layer's matrix, and load the "
                    "session again: it brings the saved matrix.");
    return matrix;
}

QCborMap mapOf(const ToolState &tool) {
    return {{QString("state"), QString::fromStdString(tool.text)},
            {QString("posed"), tool.isPosed},
            {QString("matrix"), valueOf(tool.matrix)}};
}

std::shared_ptr<ToolState> toolOf(const Reader &all, const MeshModel &layer, const QString &file) {
    if (!all.has("tool"))
        return nullptr;
    const Reader from = all.in("tool");
    const auto tool = std::make_shared<ToolState>(
        ToolState{from.text("state"), from.flag("posed"), 0, matrixThen(from, layer, file)});
    if (tool->isPosed && !all.has("rest"))
        from.fail("rest is missing");
    readBendText(tool->text, file.toStdString(), liveSlots(layer.cm), layer.cm.vert.size()); // throws if it is wrong
    return tool;
}

QCborArray arrayOf(const std::vector<FitPair> &pairs, const LiveVertices &live) {
    QCborArray array;
    for (const FitPair &pair : pairs) {
        QCborMap map{{QString("name"), QString::fromStdString(pair.name)}};
        if (pair.slot && !live.mesh.vert[*pair.slot].IsD())
            map.insert(QString("vertex"), qint64(live.numberOf(*pair.slot)));
        const auto numbers = [](const Eigen::Vector3d &p) { return arrayOf(std::vector<double>{p[0], p[1], p[2]}); };
        if (pair.place)
            map.insert(QString("place"), numbers(*pair.place));
        if (!pair.offset.isZero(0))
            map.insert(QString("offset"), numbers(pair.offset));
        array.append(map);
    }
    return array;
}

QCborMap mapOf(const FitToolState &fit, const MeshModel &layer, const LiveVertices &live) {
    QCborMap map{{QString("stiffness"), fit.options.stiffness},
                 {QString("start"), int(fit.options.start)},
                 {QString("largest_distance"), fit.options.largestDistance},
                 {QString("weights"), int(fit.options.weights)},
                 {QString("target_weights"), int(fit.options.targetWeights)},
                 {QString("target"), QString::fromStdString(fit.target)},
                 {QString("curves"), QString::fromStdString(fit.curves)}};
    if (const FitShape shown = fitShownBy(layer); shown != FitShape::Rest) {
        map.insert(QString("shown"), int(shown));
        map.insert(QString("matrix"), valueOf(fit.matrix));
    }
    if (const std::vector<float> weights = paintedWeights(layer); !weights.empty())
        map.insert(QString("painted"),
                   live.array<double>(1, [&](std::size_t i, auto *to) { *to = double(weights[i]); }));
    return map;
}

static std::vector<FitPair> pairsOf(const Reader &from, const char *key, const LiveVertices &live) {
    const std::vector<std::size_t> liveSlot = liveSlots(live.mesh);
    std::vector<FitPair> pairs;
    for (const auto value : from.list(key)) {
        const Reader each = from.in(QCborValue(value), key);
        FitPair &pair = pairs.emplace_back();
        pair.name = each.text("name");
        if (each.has("vertex"))
            pair.slot = liveSlot[std::size_t(each.whole("vertex", int(liveSlot.size()) - 1))];
        if (each.has("place"))
            pair.place = Eigen::Map<const Eigen::Vector3d>(each.array<double>("place", 3, 1).data());
        if (each.has("offset"))
            pair.offset = Eigen::Map<const Eigen::Vector3d>(each.array<double>("offset", 3, 1).data());
    }
    return pairs;
}

std::shared_ptr<FitToolState> fitOf(const Reader &from, const LiveVertices &live, const MeshModel &layer,
                                    const QString &file) {
    FitToolState fit;
    if (from.has("pairs"))
        fit.pairs = pairsOf(from, "pairs", live);
    if (from.has("fit")) {
        const Reader part = from.in("fit");
        FitOptions &options = fit.options;
        options.stiffness = part.number("stiffness", FitOptions::leastStiffness, FitOptions::mostStiffness);
        options.start = vcg::fcd::FitStart(part.whole("start", int(vcg::fcd::FitStart::TriedAxes)));
        options.largestDistance = part.number("largest_distance", 0, FitOptions::mostDistance);
        options.weights = FitMeshParam::Weights(part.whole("weights", FitMeshParam::WeightsAttribute));
        options.targetWeights = FitMeshParam::Weights(part.whole("target_weights", FitMeshParam::WeightsAttribute));
        fit.target = part.text("target");
        fit.curves = part.text("curves");
        if (part.has("shown")) {
            fit.shown = FitShape(part.whole("shown", int(FitShape::Pulled)));
            fit.matrix = matrixThen(part, layer, file);
            if (!from.has("rest"))
                part.fail("rest is missing");
        }
    }
    const bool isEmpty = fit.pairs.empty() && !fit.isSet() && fit.shown == FitShape::Rest;
    return isEmpty ? nullptr : std::make_shared<FitToolState>(std::move(fit));
}

std::vector<float> paintedOf(const Reader &from, const LiveVertices &live) {
    std::vector<float> weights;
    const char *const key = "painted";
    if (!from.has("fit") || !from.in("fit").has(key))
        return weights;
    const std::vector<double> painted = from.in("fit").array<double>(key, 1);
    if (!std::all_of(painted.begin(), painted.end(), [](double weight) { return weight >= 0 && weight <= 1; }))
        from.fail(std::string(key) + " is out of range");
    weights.assign(live.mesh.vert.size(), 1);
    live.read(painted, 1, [&](std::size_t i, const double *weight) { weights[i] = float(*weight); });
    return weights;
}

std::string unfitOf(const FitToolState &fit, const MeshDocument &document, const MeshModel &layer) {
    std::string all;
    const auto add = [&all](const std::string &what) { all += (all.empty() ? "" : ", and ") + what; };
    const MeshModel *target = layerNamed(fit.target, document, layer);
    if (!fit.target.empty() && !target)
        add("no other layer is called " + inQuotes(QString::fromStdString(fit.target)) + ", its target");
    if (!fit.curves.empty() && !QFile::exists(QString::fromStdString(fit.curves)))
        add("its curves are not there, " + inQuotes(QString::fromStdString(fit.curves)));
    const auto look = [&](const MeshModel &on, FitMeshParam::Weights weights, const std::string &name) {
        if (weights == FitMeshParam::WeightsQuality && !hasQuality(on))
            add(name + " has no quality, which says what counts");
        if (weights == FitMeshParam::WeightsAttribute && paintedWeights(on).empty())
            add("nothing is painted on " + name + ", which says what counts");
    };
    look(layer, fit.options.weights, "this layer");
    if (target)
        look(*target, fit.options.targetWeights, "the target");
    return all;
}
