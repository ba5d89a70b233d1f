// SPDX-License-Identifier: GPL-3.0-or-later
#include "kept_aside.h"
#include "layer_contents.h"
#include "layer_labels.h"
#include "layer_sequence.h"

#include <algorithm>

#include <QBuffer>
#include <QFile>
#include <QFileInfo>
#include <QImage>

using vcg::fcd::ElementColors;
using vcg::fcd::SurfaceLook;
using vcg::fcd::TextureImage;

namespace {

std::array<std::uint8_t, 4> toArray(const vcg::Color4b &color) { return {color[0], color[1], color[2], color[3]}; }

/// Whether the elements have colours: hosts make elements white if there are none.
template <class Elements>
bool areColors(const Elements &elements, const ElementColors &colors) {
    for (std::size_t i = 0; i < colors.size(); ++i)
        if (!elements[i].IsD() && colors[i] != std::array<std::uint8_t, 4>{255, 255, 255, 255})
            return true;
    return false;
}

/// The file of a texture: beside the layer's file, or in the current directory. Empty: none.
QString fileOf(const MeshModel &layer, const QString &name) {
    const QString beside = QFileInfo(layer.fullName()).absoluteDir().filePath(name); // name, if it is absolute
    for (const QString &path : {beside, name})
        if (QFileInfo(path).isFile())
            return path;
    return {};
}

QByteArray contentOf(const QString &path) {
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

bool isSame(const QImage &a, const QImage &b) {
    return a.convertToFormat(QImage::Format_ARGB32) == b.convertToFormat(QImage::Format_ARGB32);
}

TextureImage textureOf(const MeshModel &layer, const std::string &name) {
    const QString path = fileOf(layer, QString::fromStdString(name));
    const QByteArray bytes = path.isEmpty() ? QByteArray() : contentOf(path);
    TextureImage texture{QFileInfo(QString::fromStdString(name)).fileName().toStdString(), bytes.toStdString()};
    // The image that the layer holds goes first: a filter may have painted it since the file was read.
    QImage held = host::textureImage(layer, name, !path.isEmpty());
    if (texture.Kind() && (held.isNull() || isSame(held, QImage::fromData(bytes))))
        return texture;
    if (held.isNull())
        held = QImage::fromData(bytes);
    QByteArray png;
    QBuffer buffer(&png);
    buffer.open(QIODevice::WriteOnly);
    texture.content = !held.isNull() && held.save(&buffer, "PNG") ? png.toStdString() : std::string();
    return texture;
}

void readPlaces(const CMeshO &mesh, SurfaceLook &look) {
    const bool isWedge = vcg::tri::HasPerWedgeTexCoord(mesh);
    if (!isWedge && !vcg::tri::HasPerVertexTexCoord(mesh))
        return;
    look.place.assign(6 * mesh.face.size(), 0);
    look.texture.assign(mesh.face.size(), SurfaceLook::plain);
    for (std::size_t f = 0; f < mesh.face.size(); ++f) {
        const CFaceO &face = mesh.face[f];
        for (int k = 0; !face.IsD() && k < 3; ++k) {
            float *place = &look.place[6 * f + 2 * std::size_t(k)];
            place[0] = float(isWedge ? face.cWT(k).U() : face.cV(k)->cT().U());
            place[1] = float(isWedge ? face.cWT(k).V() : face.cV(k)->cT().V());
        }
        if (!face.IsD())
            look.texture[f] = isWedge ? face.cWT(0).N() : face.cV(0)->cT().N();
    }
}

} // namespace

SurfaceLook lookOf(const MeshDocument &document, const MeshModel &layer, const Remark &remark) {
    SurfaceLook look;
    const CMeshO &mesh = layer.cm;
    const std::vector<vcg::Color4b> own = ownColors(document, layer);
    look.color.resize(own.size());
    std::transform(own.begin(), own.end(), look.color.begin(), toArray);
    if (!areColors(mesh.vert, look.color))
        look.color.clear();
    if (look.color.empty() && vcg::tri::HasPerFaceColor(mesh)) {
        look.faceColor.resize(mesh.face.size());
        std::transform(mesh.face.begin(), mesh.face.end(), look.faceColor.begin(),
                       [](const CFaceO &face) { return toArray(face.cC()); });
        if (!areColors(mesh.face, look.faceColor))
            look.faceColor.clear();
    }
    readPlaces(mesh, look);
    for (std::size_t i = 0; !look.place.empty() && i < mesh.textures.size(); ++i) {
        look.image.push_back(textureOf(layer, mesh.textures[i]));
        if (look.image.back().content.empty() && remark)
            remark("A texture of " + inQuotes(layer) + " ('" + mesh.textures[i] +
                   "') cannot be read, so the .glb file is without it. Put it beside the layer's file, as PNG, and "
                   "load that again.");
    }
    return look;
}
