// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend_text.h"
#include "session_parts.h" // which includes others before Qt

#include "kept_tool.h"
#include "layer_contents.h"
#include "layer_matrix.h"
#include "session_file.h"
#include "weight_sources.h"

#include <QFile>

using vcg::fcd::Error;

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
        if (pair.place)
            map.insert(QString("place"),
                       arrayOf(std::vector<double>(pair.place->data(), pair.place->data() + pair.place->size())));
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
    }
    return pairs;
}

std::shared_ptr<FitToolState> fitOf(const Reader &from, const LiveVertices &live, const MeshModel &layer,
                                    const QString &file) {
    FitToolState fit;
    if (from.has("pairs"))
        fit.pairs = pairsOf(from, "pairs", live);
    if (from.has("fit")) {
        const Reader its = from.in("fit");
        FitOptions &options = fit.options;
        options.stiffness = its.number("stiffness", FitOptions::leastStiffness, FitOptions::mostStiffness);
        options.start = vcg::fcd::FitStart(its.whole("start", int(vcg::fcd::FitStart::TriedAxes)));
        options.largestDistance = its.number("largest_distance", 0, FitOptions::mostDistance);
        options.weights = FitMeshParam::Weights(its.whole("weights", FitMeshParam::WeightsAttribute));
        options.targetWeights = FitMeshParam::Weights(its.whole("target_weights", FitMeshParam::WeightsAttribute));
        fit.target = its.text("target");
        fit.curves = its.text("curves");
        if (its.has("shown")) {
            fit.shown = FitShape(its.whole("shown", int(FitShape::Pulled)));
            fit.matrix = matrixThen(its, layer, file);
            if (!from.has("rest"))
                its.fail("rest is missing");
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
