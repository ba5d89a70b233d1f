// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_aside.h"
#include "kept_graph.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_normals.h"
#include "layer_state.h"
#include "measured_quality.h"
#include "mesh_copy.h"
#include "new_layers.h"
#include "rest_shape.h"

#include <vcg/complex/allocate.h>

#include <algorithm>

using vcg::fcd::Index;

namespace {

/// Adds an attribute like \p attribute to \p to, without values, if its values are of type T. \return whether they are
template <class T>
bool addIfOf(CMeshO &to, const vcg::PointerToAttribute &attribute, bool isOfVertices) {
    if (!host::isCalled<T>(attribute))
        return false;
    if (isOfVertices)
        vcg::tri::Allocator<CMeshO>::template AddPerVertexAttribute<T>(to, attribute._name);
    else
        vcg::tri::Allocator<CMeshO>::template AddPerFaceAttribute<T>(to, attribute._name);
    return true;
}

template <class... Types>
bool addIfOfOne(CMeshO &to, const vcg::PointerToAttribute &attribute, bool isOfVertices) {
    return (addIfOf<Types>(to, attribute, isOfVertices) || ...);
}

/// Adds the attributes of \p from to the empty mesh \p to, without values. \param remark is told unknown types
void addAttributes(CMeshO &to, const MeshModel &from, const Remark &remark) {
    const auto add = [&](const auto &attributes, bool isOfVertices) {
        for (const vcg::PointerToAttribute &attribute : attributes) {
            if (attribute._name.empty() || LayerState::known(from).appliedName == attribute._name)
                continue; // scratch data, or attributes that are not copied
            if (!addIfOfOne<bool, char, signed char, unsigned char, short, unsigned short, int, unsigned, long,
                            unsigned long, long long, unsigned long long, float, double, vcg::Point2f, vcg::Point2d,
                            vcg::Point2i, vcg::Point3f, vcg::Point3d, vcg::Point3i, vcg::Point4f, vcg::Point4d,
                            vcg::Color4b, vcg::Color4f, vcg::Matrix33f, vcg::Matrix33d, vcg::Matrix44f, vcg::Matrix44d,
                            std::string>(to, attribute, isOfVertices))
                remark(std::string("The ") + (isOfVertices ? "vertex" : "face") + " attribute '" + attribute._name +
                       "' has values of an unknown type; the new layer does not have it.");
        }
    };
    add(from.cm.vert_attr, true);
    add(from.cm.face_attr, false);
}

/// \p label, or "LABEL(n)" if a layer not among \p but has it. (MeshLab's own function takes a dot for an extension.)
QString unusedLabel(const MeshDocument &document, const QString &label, const std::vector<MeshModel *> &but) {
    const std::vector<const MeshModel *> layers = host::layers(document);
    for (int n = 0;; ++n) {
        const QString tried = n ? QString("%1(%2)").arg(label).arg(n) : label;
        bool taken = false;
        for (const MeshModel *layer : layers)
            taken = taken || (layer->label() == tried && std::find(but.begin(), but.end(), layer) == but.end());
        if (!taken)
            return tried;
    }
}

bool isAsMade(const MeshModel &layer, const ResultState &result) {
    return contentsOf(layer) == result.contents && (result.ownNormals || !hasOwnNormals(layer));
}

} // namespace

NewLayers::NewLayers(MeshDocument &document, const MeshModel &base, const Remark &remark,
                     std::vector<MeshModel *> replaced)
    : document(document), base(base), remark(remark), replaced(std::move(replaced)) {}

NewLayers::~NewLayers() {
    if (kept)
        return;
    for (auto layer = added.rbegin(); layer != added.rend(); ++layer)
        host::removeLayer(document, *layer);
    if (!added.empty() && document.mm() != &base)
        document.setCurrentMesh(base.id());
}

void NewLayers::keep(const MeshModel &current, const vcg::fcd::Progress &progress,
                     const std::function<void()> &before) {
    progress(1, "Done");
    if (before)
        before();
    keepNow(current);
}

void NewLayers::keepResults(MeshModel &source, const std::vector<MeshModel *> &results,
                            const vcg::fcd::Progress &progress) {
    keep(*results.back(), progress);
    showLast(document, source, results);
}

void NewLayers::keep(const std::vector<std::unique_ptr<NewLayers>> &several, const MeshModel &current,
                     const vcg::fcd::Progress &progress) {
    progress(1, "Done");
    for (const auto &layers : several)
        layers->keepNow(current);
}

void NewLayers::keepNow(const MeshModel &current) {
    kept = true;
    for (MeshModel *layer : replaced)
        host::removeLayer(document, layer);
    document.setCurrentMesh(current.id());         // last: removing a layer may make another one the current
    for (std::size_t i = 0; i < added.size(); ++i) // the host has changed labels that were taken
        added[i]->setLabel(labels[i]);
}

MeshModel &NewLayers::add(const QString &what) {
    const QString label = unusedLabel(document, labelOf(base, what), replaced);
    labels.push_back(label);
    added.reserve(added.size() + 1); // nothing can fail between adding and remembering
    MeshModel *layer = document.addNewMesh("", label, false);
    added.push_back(layer);
    layer->cm.Tr = base.cm.Tr;
    return *layer;
}

MeshModel &NewLayers::addCopy(const QString &what, int withoutElements, const Eigen::Matrix3Xd *position) {
    // Adjacencies are not copied; whoever needs them computes them.
    const int elements = base.dataMask() & ~(MeshModel::MM_FACEFACETOPO | MeshModel::MM_VERTFACETOPO | withoutElements);
    MeshModel &layer = add(what);
    CMeshO &to = layer.cm;
    const CMeshO &from = base.cm;
    layer.updateDataMask(elements);
    addAttributes(to, base, remark);
    copyElements(to, from, position);
    to.sfn = from.sfn;
    to.svn = from.svn;
    to.pvn = from.pvn;
    to.pfn = from.pfn;
    to.shot = from.shot;
    to.imark = from.imark;
    if (!position)
        to.bbox = from.bbox;
    bringBackTo(document, layer, base);
    if (withoutElements & MeshModel::MM_WEDGTEXCOORD) {
        to.textures.clear();
    } else {
        to.normalmaps = from.normalmaps;
        host::copyTextures(layer, base);
    }
    return layer;
}

MeshModel &NewLayers::addDeformed(const QString &what, const Eigen::Matrix3Xd &position,
                                  const std::vector<Eigen::Matrix3f> &linear, const std::vector<float> &quality) {
    MeshModel &layer = addCopy(what, MeshModel::MM_NONE, &position);
    const Packing packing(base.cm.vert, base.cm.vn);
    if (!quality.empty()) {
        layer.updateDataMask(MeshModel::MM_VERTQUALITY);
        packing.forEach(
            [&](std::size_t i, std::size_t j) { layer.cm.vert[j].Q() = CVertexO::QualityType(quality[i]); });
    }
    const LayerState &state = LayerState::known(base);
    const bool areTags = quality.empty() && ((state.scan && state.scan->quality && !state.scan->hadQuality) ||
                                             (state.measured && state.measured->areTags));
    if (!quality.empty() || areTags || isMeasured(base))
        keepMeasured(document, layer, areTags);
    computeNormals(layer.cm);
    if (linear.empty())
        return layer;
    const bool ownNormals = hasOwnNormals(base), directions = base.hasDataMask(MeshModel::MM_VERTCURVDIR);
    const auto turn = [](const Eigen::Matrix3d &map, auto &v) {
        const Eigen::Vector3d turned = (map * Eigen::Vector3d(v[0], v[1], v[2])).stableNormalized();
        for (int d = 0; d < 3; ++d)
            v[d] = turned[d];
    };
    packing.forEach([&](std::size_t i, std::size_t j) {
        CVertexO &vertex = layer.cm.vert[j];
        const Eigen::Matrix3d map = linear[i].cast<double>();
        if (ownNormals) {
            vertex.N() = base.cm.vert[i].cN();
            turn(vcg::fcd::Cofactors(map), vertex.N());
        }
        if (directions) {
            turn(map, vertex.PD1());
            turn(map, vertex.PD2());
        }
    });
    return layer;
}

void NewLayers::addDisplacement(MeshModel &layer, const Eigen::Matrix3Xd &position) const {
    using Allocator = vcg::tri::Allocator<CMeshO>;
    const std::string name = "fcd_displacement";
    if (vcg::tri::HasPerVertexAttribute(layer.cm, name)) // perhaps of another type
        Allocator::DeletePerVertexAttribute(layer.cm, name);
    auto vector = Allocator::AddPerVertexAttribute<Point3m>(layer.cm, name);
    Packing(base.cm.vert, base.cm.vn).forEach([&](std::size_t i, std::size_t j) {
        vector[j] = toPoint(position.col(Eigen::Index(i)) - toVector(base.cm.vert[i].cP()));
    });
}

std::vector<MeshModel *> NewLayers::addResult(const QString &what, const vcg::fcd::DeformationResult &result,
                                              const std::vector<float> &quality,
                                              const std::shared_ptr<const Prepared> &graphOf) {
    std::vector<MeshModel *> layers;
    if (graphOf) {
        layers.push_back(&addGraph("graph", result.rest, false));
        layers.push_back(&addGraph("deformed graph", result.deformed, true));
        keepDeformation(document, *layers.back(), *layers.front(), base, graphOf, result.pose);
    }
    layers.push_back(&addDeformed(what, result.position, result.linear, quality));
    return layers;
}

MeshModel &NewLayers::addPatches(const QString &what, const std::vector<Index> &patchOf,
                                 const std::vector<vcg::Color4b> &color) {
    MeshModel &layer = addCopy(what, MeshModel::MM_WEDGTEXCOORD | MeshModel::MM_VERTTEXCOORD | MeshModel::MM_FACECOLOR);
    layer.updateDataMask(MeshModel::MM_VERTCOLOR | MeshModel::MM_VERTQUALITY |
                         (base.cm.fn > 0 ? MeshModel::MM_FACECOLOR : MeshModel::MM_NONE));
    Packing(base.cm.vert, base.cm.vn).forEach([&](std::size_t i, std::size_t j) {
        CVertexO &vertex = layer.cm.vert[j];
        const Index patch = patchOf[i];
        vertex.Q() = CVertexO::QualityType(patch);
        vertex.C() = patch >= 0 ? color[std::size_t(patch)] : vcg::Color4b(vcg::Color4b::Gray);
    });
    keepMeasured(document, layer);
    // Faces have one colour each, so that borders are sharp: that of two of the vertices, if two are in one patch.
    for (CFaceO &face : layer.cm.face)
        face.C() = face.cV(1)->cQ() == face.cV(2)->cQ() ? face.cV(1)->cC() : face.cV(0)->cC();
    return layer;
}

void showLast(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results) {
    if (!host::inWindow() || results.empty())
        return;
    for (MeshModel *result : results)
        host::setVisible(*result, result == results.back());
    host::setVisible(source, false);
    host::showChanges(document);
}

void showResult(MeshDocument &document, MeshModel &source, const std::vector<MeshModel *> &results) {
    for (MeshModel *result : results)
        LayerState::made(document, *result).result = {source.id(), contentsOf(*result), hasOwnNormals(*result),
                                                      result->label()};
    showLast(document, source, results);
}

MeshModel &sourceOf(MeshDocument &document, MeshModel &layer) {
    const std::optional<ResultState> &result = LayerState::known(layer).result;
    MeshModel *source = result && isAsMade(layer, *result) ? document.getMesh(result->source) : nullptr;
    if (source && source->cm.vn > 0)
        return *source;
    return layer;
}

std::vector<MeshModel *> earlierResults(MeshDocument &document, const MeshModel &source) {
    std::vector<MeshModel *> results;
    for (const MeshModel *layer : host::layers(document)) {
        const std::optional<ResultState> &result = LayerState::known(*layer).result;
        if (result && result->source == source.id() && layer->label() == result->label && isAsMade(*layer, *result))
            results.push_back(const_cast<MeshModel *>(layer));
    }
    return results;
}
