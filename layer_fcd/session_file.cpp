// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // before Qt

#include "session_format.h" // which includes others before Qt
#include "kept_tool.h"
#include "layer_contents.h"
#include "layer_normals.h"
#include "rest_shape.h"
#include "save_files.h"
#include "session_file.h"
#include "weight_sources.h"

#include <vcg/complex/algorithms/update/bounding.h>

#include <cstdlib>
#include <limits>

#include <QCryptographicHash>

using vcg::fcd::Error;

namespace {

const char *const formatName = "FCD session";
const int version = 2;

/// The largest distance of a layer's vertices from a shape.
double distanceFrom(const CMeshO &mesh, const Shape &shape) {
    double most = 0;
    for (std::size_t i = 0; i < mesh.vert.size(); ++i)
        if (!mesh.vert[i].IsD())
            most = std::max(most, (toVector(mesh.vert[i].cP()) - toVector(shape.position[i])).norm());
    return most;
}

/// Whether a colour is another one, as a format may round it: OBJ by one.
bool isRounded(const vcg::Color4b &now, const std::uint8_t *color) {
    return std::equal(color, color + 4, &now[0], [](int a, int b) { return std::abs(a - b) <= 1; });
}

SessionContents contentsOf(const LayerState &state) {
    SessionContents contents;
    contents.marks = !state.marks.empty();
    contents.colors = state.scan.has_value();
    contents.rest = state.rest.has_value();
    contents.earlier = state.rest ? int(state.rest->earlier.size()) : 0;
    contents.poses = state.poses ? int(state.poses->pose.size()) : 0;
    contents.tool = state.tool != nullptr;
    contents.pairs = state.fit ? int(state.fit->pairs.size()) : 0;
    contents.fitOptions = state.fit && state.fit->isSet();
    contents.fitted = state.fit && state.fit->shown != FitShape::Rest;
    return contents;
}

} // namespace

SessionContents saveSession(const MeshModel &layer, const QString &file) {
    const CMeshO &mesh = layer.cm;
    const LayerState &state = LayerState::known(layer);
    const auto tool = toolOf(layer);
    const bool isFitted = fitShownBy(layer) != FitShape::Rest;
    if (state.marks.empty() && !state.scan && !state.rest && !state.poses && !state.fit && !tool)
        throw Error("Nothing is known of the layer " + inQuotes(layer) +
                    " that a session would keep. Tag, mark, pose or fit it first.");
    for (const CVertexO &vertex : mesh.vert)
        if (!vertex.IsD() && !toVector(vertex.cP()).allFinite())
            throw Error("The layer " + inQuotes(layer) +
                        " has a vertex with a coordinate that is no number. Delete it, and save the session again.");
    const LiveVertices live(mesh);
    QCborMap map{{QString("vertices"), mesh.vn},
                 {QString("faces"), mesh.fn},
                 {QString("corners"), live.corners()},
                 {QString("position"), live.points([&](std::size_t i) { return mesh.vert[i].cP(); })},
                 {QString("normal"), live.points([&](std::size_t i) { return mesh.vert[i].cN(); })}};
    if (!state.marks.empty())
        map.insert(QString("marks"),
                   live.array<std::int32_t>(1, [&](std::size_t i, auto *to) { *to = state.marks[i] + 1; }));
    if (state.scan)
        map.insert(QString("scan"), mapOf(*state.scan, live));
    if (state.rest)
        map.insert(QString("rest"), mapOf(*state.rest, live));
    if (state.poses)
        map.insert(QString("poses"), QString::fromStdString(PoseSequenceText(*state.poses)));
    if (tool)
        map.insert(QString("tool"), mapOf(*tool));
    if (state.fit && !state.fit->pairs.empty())
        map.insert(QString("pairs"), arrayOf(state.fit->pairs, live));
    if (state.fit && (state.fit->isSet() || isFitted))
        map.insert(QString("fit"), mapOf(*state.fit, layer, live));
    const QByteArray bytes = map.toCborValue().toCbor();
    const QByteArray all = QCborMap{{QString("format"), QString(formatName)},
                                    {QString("version"), version},
                                    {QString("sha256"), QCryptographicHash::hash(bytes, QCryptographicHash::Sha256)},
                                    {QString("layer"), bytes}}
                               .toCborValue()
                               .toCbor();
    saveFiles({{file, all.toStdString()}});
    SessionContents contents = contentsOf(state);
    contents.tool = tool != nullptr;
    contents.fitted = isFitted;
    return contents;
}

SessionContents loadSession(const MeshDocument &document, MeshModel &layer, const QString &file) {
    CMeshO &mesh = layer.cm;
    const std::string name = inQuotes(file);
    const std::size_t each = 15 * sizeof(double) + 49, shapes = RestShape::mostEarlier * 6 * sizeof(double);
    const std::string all = vcg::fcd::ReadFile(pathOf(file),
                                               100000000 + (each + shapes) * std::size_t(mesh.vn)); // poses are text
    const QCborMap outer = QCborValue::fromCbor(QByteArray::fromStdString(all)).toMap();
    if (outer.value(QString("format")).toString() != formatName)
        throw Error(name + " is no session of 'FCD: Save Session' (save_fcd_session).");
    if (outer.value(QString("version")).toInteger() != version)
        throw Error(name +
                    " is a session of another version. Load it with the program that wrote it, or save it again.");
    const Reader whole(outer, file, mesh.vn);
    const QByteArray bytes = whole.bytes("layer");
    if (QCryptographicHash::hash(bytes, QCryptographicHash::Sha256) != whole.bytes("sha256"))
        whole.fail("it was changed, or not written to its end");
    const QCborValue inner = QCborValue::fromCbor(bytes);
    if (!inner.isMap())
        whole.fail("layer is missing");
    const Reader from(inner.toMap(), file, mesh.vn);
    const int most = std::numeric_limits<int>::max();
    const int vertices = from.whole("vertices", most), faces = from.whole("faces", most);
    if (vertices != mesh.vn || faces != mesh.fn)
        throw Error(name + " is of a layer with " + std::to_string(vertices) + " vertices and " +
                    std::to_string(faces) + " faces, and " + inQuotes(layer) + " has " + std::to_string(mesh.vn) +
                    " and " + std::to_string(mesh.fn) + ". Open the file of that layer, and load the session for it.");
    const LiveVertices live(mesh);
    if (from.bytes("corners") != live.corners())
        throw Error(name + " is of a layer with other faces than " + inQuotes(layer) +
                    ", or in another order. Open the file of that layer, and load the session for it.");

    LayerState next;
    std::vector<char> isAtHome;
    const Shape shown = shapeOf(from, live);
    if (from.has("marks")) {
        next.marks.assign(mesh.vert.size(), 0);
        live.read(from.array<std::int32_t>("marks", 1), 1, [&](std::size_t i, const std::int32_t *tag) {
            next.marks[i] = std::max(*tag, std::numeric_limits<int>::lowest() + 1) - 1;
        });
    }
    if (from.has("rest"))
        next.rest = restOf(from.in("rest"), live, isAtHome);
    if (from.has("scan"))
        next.scan = scanOf(from.in("scan"), live, shown);
    if (from.has("poses"))
        next.poses = vcg::fcd::ReadPoseSequence(from.text("poses"), file.toStdString());
    const std::shared_ptr<ToolState> tool = toolOf(from, layer, file);
    const std::shared_ptr<FitToolState> fit = fitOf(from, live, layer, file);
    next.tool = tool;
    next.fit = fit;
    const std::vector<float> painted = paintedOf(from, live);

    // The layer may also be at rest, if its file was opened again.
    Eigen::AlignedBox3d box;
    for (const CVertexO &vertex : mesh.vert)
        if (!vertex.IsD())
            box.extend(toVector(vertex.cP()));
    const double near = 1e-6 * box.diagonal().norm(), distance = distanceFrom(mesh, shown);
    const bool isAtRest = distance > near && next.rest && distanceFrom(mesh, *next.rest) <= near;
    if (distance > near && !isAtRest)
        throw Error(inWords(name, " is of another shape than ", inQuotes(layer), " has: a vertex is ", distance,
                            " from where it was. Open the file of that layer, or undo what has moved it, and load the "
                            "session again."));
    const KeptScan *scan = next.scan ? &*next.scan : nullptr;
    std::vector<std::uint8_t> shownColor;
    std::vector<double> shownQuality;
    if (scan) {
        shownColor = from.in("scan").array<std::uint8_t>("shown_color", 4);
        shownQuality = from.in("scan").array<double>("shown_quality", 1);
    }

    // Nothing can fail from here on.
    LayerState &state = LayerState::made(document, layer);
    SessionContents contents = contentsOf(next);
    if (!painted.empty())
        paintWeights(layer, painted);
    if (next.fit)
        contents.unfit = unfitOf(*next.fit, document, layer);
    if (isAtRest) {
        contents.moved = mesh.vn;
        forVertices(mesh, [&](std::size_t i) {
            mesh.vert[i].P() = shown.position[i];
            mesh.vert[i].N() = shown.normal[i];
        });
        computeFaceNormals(mesh, {});
        vcg::tri::UpdateBounding<CMeshO>::Box(mesh);
    }
    if (next.rest)
        forVertices(mesh, [&](std::size_t i) {
            if (isAtHome[i])
                next.rest->vertex[i] = posedAt(mesh.vert[i].cP());
        });
    if (scan && scan->color) {
        const bool hasColor = layer.hasDataMask(MeshModel::MM_VERTCOLOR); // many formats have none
        layer.updateDataMask(MeshModel::MM_VERTCOLOR);
        live.read(shownColor, 4, [&](std::size_t i, const std::uint8_t *c) {
            const vcg::Color4b &now = mesh.vert[i].cC();
            if (!hasColor || isRounded(now, &scan->colors[scan->number[i] - 1][0]) || isRounded(now, c))
                mesh.vert[i].C() = vcg::Color4b(c[0], c[1], c[2], c[3]);
        });
    }
    if (scan && scan->quality) {
        const bool hadNone = !hasQuality(layer);
        layer.updateDataMask(MeshModel::MM_VERTQUALITY);
        live.read(shownQuality, 1, [&](std::size_t i, const double *q) {
            if (hadNone || mesh.vert[i].cQ() == scan->qualities[scan->number[i] - 1])
                mesh.vert[i].Q() = CVertexO::QualityType(*q);
        });
    }
    const bool isFitted = fit && fit->shown != FitShape::Rest;
    if (tool || isFitted) {
        const Matrix44m matrix = tool ? tool->matrix : fit->matrix;
        contents.hasMatrix = !(matrix == mesh.Tr);
        mesh.Tr = matrix;
        if (tool)
            tool->shape = shapeOf(mesh);
        if (isFitted)
            fit->shape = shapeOf(mesh);
        if (next.scan)
            next.scan->matrix = mesh.Tr;
    }
    if (next.rest)
        next.rest->normalsNow = next.rest->normalsBefore = next.rest->ownNormals ? normalsOf(mesh) : 0;
    state.marks = std::move(next.marks);
    state.scan = std::move(next.scan);
    state.rest = std::move(next.rest);
    state.poses = std::move(next.poses);
    state.tool = std::move(next.tool);
    state.fit = std::move(next.fit);
    return contents;
}

std::string describe(const SessionContents &contents) {
    std::string has;
    const auto add = [&has](const std::string &what) { has += (has.empty() ? "" : ", ") + what; };
    if (contents.marks)
        add("marks");
    if (contents.colors)
        add("what tags stand in the place of");
    if (contents.rest)
        add(contents.earlier == 0   ? std::string("the rest shape")
            : contents.earlier == 1 ? std::string("the rest shape and the one before it")
                                    : "the rest shape and the " + std::to_string(contents.earlier) + " before it");
    if (contents.poses > 0)
        add(contents.poses == 1 ? std::string("a pose") : std::to_string(contents.poses) + " poses");
    if (contents.tool)
        add("handles and motions of 'FCD: Bend'");
    if (contents.pairs > 0)
        add("pairs of 'FCD: Fit': " + std::to_string(contents.pairs));
    if (contents.fitOptions)
        add("options of 'FCD: Fit'");
    if (contents.fitted)
        add("the fit that the layer shows");
    std::string line = has + ".";
    if (contents.moved > 0)
        line += " The layer was at rest; it has the saved pose now.";
    if (contents.hasMatrix)
        line += " It has the saved matrix now.";
    if (!contents.unfit.empty())
        line += " Of 'FCD: Fit': " + contents.unfit + ".";
    return line;
}
