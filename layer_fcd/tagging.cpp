// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/handles/handle_file.h> // before Qt

#include "kept_aside.h"
#include "layer_contents.h"
#include "layer_matrix.h"
#include "kept_tool.h"
#include "handle_sources.h"
#include "save_files.h"
#include "tagging.h"

#include <vcg/complex/allocate.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

using vcg::fcd::Error;
using vcg::fcd::TagCount;

namespace {

/// The attribute \p name; null: none. \throw Error it is no scalar
const vcg::PointerToAttribute *scalarAttribute(const CMeshO &mesh, const QString &name) {
    for (const vcg::PointerToAttribute &attribute : mesh.vert_attr) {
        if (attribute._name != name.toStdString())
            continue;
        if (!host::isOfType<float>(attribute) && !host::isOfType<double>(attribute))
            throw Error("This layer has a vertex attribute '" + name.toStdString() +
                        "' already, and it is no scalar (float or double), so it cannot hold tags. Give another name "
                        "as 'tag_attribute', or leave it empty to use the vertex quality.");
        return &attribute;
    }
    return nullptr;
}

/// \return the attribute of \p target, if it exists \throw Error the target cannot hold the tags
const vcg::PointerToAttribute *expectFit(const CMeshO &mesh, const std::vector<int> &tag, const TagTarget &target) {
    const vcg::PointerToAttribute *attribute = nullptr;
    bool single = std::is_same<CVertexO::QualityType, float>::value;
    if (!target.attribute.isEmpty()) {
        attribute = scalarAttribute(mesh, target.attribute);
        single = attribute ? host::isOfType<float>(*attribute) : std::is_same<Scalarm, float>::value;
    }
    for (std::size_t i = 0; i < tag.size() && single; ++i)
        if (!mesh.vert[i].IsD() && double(float(tag[i])) != double(tag[i]))
            throw Error("The tag " + std::to_string(tag[i]) + " of vertex " + std::to_string(i) +
                        " is too large to be kept in single precision. Use smaller numbers.");
    return attribute;
}

/// How to tag a layer whose quality is no tags.
const char *const freshQuality = "set its quality to 0 everywhere, or give the name of a new attribute as "
                                 "'tag_attribute' to leave the quality as it is";

/// The tags of \p layer, one per vertex slot; all free if it has none yet. \throw Error it has numbers that are no tags
std::vector<int> presentTags(const MeshModel &layer, const TagTarget &target) {
    const CMeshO &mesh = layer.cm;
    HandleParam source;
    bool tagged;
    if (target.attribute.isEmpty()) {
        tagged = hasMarks(layer) || hasQuality(layer);
    } else {
        source.source = HandleParam::Attribute;
        source.tagAttribute = target.attribute;
        tagged = scalarAttribute(mesh, target.attribute);
    }
    if (!tagged)
        return std::vector<int>(mesh.vert.size(), 1);
    try {
        return readTags(layer, source);
    } catch (const Error &e) {
        throw Error(std::string(e.what()) +
                    (target.attribute.isEmpty()
                         ? std::string(" To tag this layer from the beginning, ") + freshQuality + "."
                         : " To tag this layer from the beginning, give the name of a new attribute as "
                           "'tag_attribute'."));
    }
}

} // namespace

vcg::Color4b colorOfTag(int tag) {
    const auto color = [](double r, double g, double b) {
        const auto byte = [](double x) { return (unsigned char)std::lround(x); };
        return vcg::Color4b(byte(r), byte(g), byte(b), 255);
    };
    if (tag < 0)
        return color(154, 154, 154);
    if (tag == 0)
        return color(59, 111, 201);
    if (tag == 1)
        return color(240, 197, 60);
    // Two sequences that spread evenly for any number of handles: one darkens the red, the other lightens it.
    const auto fraction = [&](double step) { return std::fmod((tag - 2) * step, 1); };
    const double dark = 1 - 0.5 * fraction(0.6180339887), light = 0.45 * fraction(0.7548776662);
    const auto shade = [&](double x) { return dark * x + light * (255 - dark * x); };
    return color(shade(210), shade(60), shade(50));
}

TagCount writeTags(const MeshDocument &document, MeshModel &layer, const std::vector<int> &tag,
                   const TagTarget &target) {
    CMeshO &mesh = layer.cm;
    const vcg::PointerToAttribute *attribute = expectFit(mesh, tag, target);
    const TagCount count = vcg::tri::CountTags(mesh, tag);
    if (target.colorize || target.attribute.isEmpty())
        keepAside(document, layer, target.colorize, target.attribute.isEmpty());

    const auto write = [&](const auto &number) {
        forVertices(mesh, [&](std::size_t i) { number(i) = std::decay_t<decltype(number(i))>(tag[i]); });
    };
    if (target.attribute.isEmpty()) {
        layer.updateDataMask(MeshModel::MM_VERTQUALITY);
        write([&](std::size_t i) -> auto & { return mesh.vert[i].Q(); });
        dropMarks(layer); // these tags replace them
    } else {
        if (!attribute) {
            vcg::tri::Allocator<CMeshO>::AddPerVertexAttribute<Scalarm>(mesh, target.attribute.toStdString());
            attribute = scalarAttribute(mesh, target.attribute);
        }
        vcg::SimpleTempDataBase *data = attribute->_handle;
        if (host::isOfType<float>(*attribute))
            write([&](std::size_t i) -> float & { return *static_cast<float *>(data->At(i)); });
        else
            write([&](std::size_t i) -> double & { return *static_cast<double *>(data->At(i)); });
    }
    if (target.colorize) {
        layer.updateDataMask(MeshModel::MM_VERTCOLOR);
        forVertices(mesh, [&](std::size_t i) { mesh.vert[i].C() = colorOfTag(tag[i]); });
    }
    if (target.colorize || target.attribute.isEmpty())
        takeTags(layer, tag, target.colorize, target.attribute.isEmpty());
    return count;
}

namespace {

/// The tags of \p layer, changed for selected vertices and the vertices of selected faces.
std::vector<int> withSelection(const MeshModel &layer, const TagParam &param, const Remark &remark) {
    const CMeshO &mesh = layer.cm;
    std::vector<char> selected = onSelectedFaces(layer);
    for (std::size_t i = 0; i < selected.size(); ++i)
        if (!mesh.vert[i].IsD() && mesh.vert[i].IsS())
            selected[i] = 1;
    if (std::find(selected.begin(), selected.end(), 1) == selected.end())
        throw Error("Nothing is selected. Select the vertices or faces to tag first.");
    const int wanted = param.role == TagParam::Fixed     ? 0
                       : param.role == TagParam::Free    ? 1
                       : param.role == TagParam::Outside ? -1
                                                         : param.handleNumber;
    std::vector<int> tag = presentTags(layer, param.target);
    if (param.target.attribute.isEmpty())
        tellTakenForTags(layer, tag, std::string("run 'FCD: Clear Tags', then ") + freshQuality, remark);
    for (std::size_t i = 0; i < tag.size(); ++i)
        if (selected[i])
            tag[i] = wanted;
    return tag;
}

std::vector<int> tagsFor(const MeshModel &layer, const TagParam &param, const Remark &remark) {
    HandleParam source;
    if (param.role == TagParam::FromFile) {
        source.source = HandleParam::Files;
        source.tagFile = param.tagFile;
    } else if (param.role != TagParam::AsTheyAre) {
        return withSelection(layer, param, remark);
    } else if (!param.target.attribute.isEmpty()) {
        source.source = HandleParam::Attribute;
        source.tagAttribute = param.target.attribute;
    }
    return readTags(layer, source); // throws if there are no tags
}

/// The matrices of handles 2, 3, ..., for a file.
std::vector<Eigen::Matrix4d> matricesFor(const MeshDocument &document, const MeshModel &layer,
                                         const std::vector<int> &tag, const HandleParam &motions,
                                         const Remark &remark) {
    vcg::fcd::Handles handles;
    handles.tag = tag;
    handles.world = invertibleMatrixOf(layer);
    const auto centers =
        vcg::fcd::HandleCenters(tag, [&](std::size_t i) { return vcg::tri::PositionOf(layer.cm.vert[i]); });
    if (centers.empty())
        throw Error("No vertex belongs to a handle, so there are no motions to save. Tag a handle (2, 3, ...), or "
                    "give no file for motions.");
    readMotions(document, layer, nullptr, motions, centers, remark, handles);
    const int last = handles.motion.rbegin()->first, most = 100000;
    if (last > most)
        throw Error("The largest handle number is " + std::to_string(last) +
                    ", and the file would need a matrix for each number up to it. Number the handles 2, 3, ...");
    std::vector<Eigen::Matrix4d> matrix(std::size_t(last) - 1, Eigen::Matrix4d::Identity());
    for (const auto &[number, motion] : handles.motion)
        matrix[std::size_t(number) - 2] = motion.matrix;
    return matrix;
}

/// Writes the files that \p param names.
void writeFiles(const MeshDocument &document, const MeshModel &layer, const std::vector<int> &tag,
                const SaveTagsParam &param, const Remark &remark) {
    std::vector<FileContent> files;
    if (!param.tagFile.isEmpty()) {
        std::vector<int> live;
        live.reserve(std::size_t(layer.cm.vn));
        for (std::size_t i = 0; i < tag.size(); ++i)
            if (!layer.cm.vert[i].IsD())
                live.push_back(tag[i]);
        files.push_back({param.tagFile, vcg::fcd::TagText(live)});
    }
    if (!param.transformFile.isEmpty())
        files.push_back(
            {param.transformFile, vcg::fcd::TransformText(matricesFor(document, layer, tag, param.handles, remark))});
    saveFiles(files);
}

} // namespace

TagCount tagLayer(const MeshDocument &document, MeshModel &layer, const TagParam &param, const Remark &remark) {
    const std::vector<int> tag = tagsFor(layer, param, remark);
    if (param.role != TagParam::AsTheyAre)
        expectFit(layer.cm, tag, param.target);
    writeFiles(document, layer, tag, param.save, remark); // before the layer is changed
    return param.role == TagParam::AsTheyAre ? vcg::tri::CountTags(layer.cm, tag)
                                             : writeTags(document, layer, tag, param.target);
}

TagCount saveTags(const MeshDocument &document, const MeshModel &layer, const SaveTagsParam &param,
                  const Remark &remark) {
    const std::vector<int> tag = readTags(layer, param.handles);
    writeFiles(document, layer, tag, param, remark);
    return vcg::tri::CountTags(layer.cm, tag);
}
