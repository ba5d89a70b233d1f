// SPDX-License-Identifier: GPL-3.0-or-later
#include "layer_labels.h"

#include <QFile>
#include <QRegularExpression>

QString nameOf(const MeshModel &layer) {
    QString name = layer.label().trimmed();
    name.remove(QRegularExpression("\\.[A-Za-z][A-Za-z0-9]{0,4}$"));
    return name.isEmpty() ? QString("mesh") : name;
}

std::string inQuotes(const QString &name) { return "'" + name.toStdString() + "'"; }

std::string pathOf(const QString &file) { return QFile::encodeName(file).toStdString(); }

std::string inQuotes(const MeshModel &layer) { return inQuotes(layer.label()); }

const MeshModel &checkedTarget(const MeshModel &layer, const MeshModel *target, const std::string &parameter) {
    if (!target)
        throw vcg::fcd::Error("'" + parameter + "' names no layer of this document. Choose another one than " +
                              inQuotes(layer) + ".");
    if (target == &layer)
        throw vcg::fcd::Error("'" + parameter + "' is " + inQuotes(layer) +
                              " itself, the current layer. Choose another one.");
    if (target->cm.vn == 0)
        throw vcg::fcd::Error("Layer " + inQuotes(*target) +
                              " has no vertices. Choose a layer with a surface, or with points, as '" + parameter +
                              "'.");
    return *target;
}

const MeshModel *layerNamed(const std::string &label, const MeshDocument &document, const MeshModel &layer) {
    for (const MeshModel *each : host::layers(document))
        if (each != &layer && each->cm.vn > 0 && each->label().toStdString() == label)
            return each;
    return nullptr;
}

std::string counted(std::size_t count, const std::string &one, const std::string &many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string trianglesFlipped(std::size_t count) {
    return counted(count, "triangle is flipped", "triangles are flipped");
}

QString labelOf(const MeshModel &base, const QString &what) {
    const QString name = nameOf(base);
    const QRegularExpressionMatch result =
        QRegularExpression("^(.+) deformed(?: (\\d{1,6}))?(?:\\(\\d+\\))?$").match(name);
    if (!result.hasMatch())
        return name + " " + what;
    const int times = result.captured(2).isEmpty() ? 1 : result.captured(2).toInt();
    return QString("%1 %2 %3").arg(result.captured(1), what).arg(times + 1);
}
