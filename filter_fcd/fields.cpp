// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields.h"

#include <cmath>

#include <QSet>

static Scalarm diagonal(const MeshDocument &document) {
    const MeshModel *layer = document.mm();
    const Scalarm length = layer && !layer->cm.bbox.IsNull() ? layer->cm.bbox.Diag() : 0;
    return length > 0 && std::isfinite(length) ? length : 1;
}

QString Fields::shared(const QString &text) {
    static QSet<QString> all;
    return *all.insert(text);
}

void Fields::field(const QString &name, bool &value, Shown shown, const QString &label, const QString &help) {
    visit<RichBool>(
        name, shown, [&] { value = given->getBool(name); }, value, label, help);
}

void Fields::field(const QString &name, int &value, Shown shown, const QString &label, const QString &help) {
    visit<RichInt>(
        name, shown, [&] { value = given->getInt(name); }, value, label, help);
}

void Fields::field(const QString &name, QString &value, Shown shown, const QString &label, const QString &help) {
    visit<RichString>(
        name, shown, [&] { value = given->getString(name); }, value, label, help);
}

void Fields::field(const QString &name, double &value, Shown shown, const QString &label, const QString &help,
                   int exponent) {
    visit<RichFloat>(
        name, shown, [&] { value = asTyped(given->getFloat(name), exponent); },
        Scalarm(value * std::pow(10, -exponent)), label, help);
}

void Fields::length(const QString &name, double &value, Shown shown, const QString &label, const QString &help) {
    visit<host::RichPercentageParam>(
        name, shown, [&] { value = asTyped(given->getAbsPerc(name)); }, Scalarm(value), Scalarm(0), diagonal(document),
        label, help);
}

void Fields::position(const QString &name, Eigen::Vector3d &value, Shown shown, const QString &label,
                      const QString &help) {
    visit<host::RichPositionParam>(
        name, shown, [&] { value = toVector(given->getPoint3m(name)); }, toPoint(value), label, help);
}

void Fields::direction(const QString &name, Eigen::Vector3d &value, Shown shown, const QString &label,
                       const QString &help) {
    visit<host::RichDirectionParam>(
        name, shown, [&] { value = toVector(given->getPoint3m(name)); }, toPoint(value), label, help);
}

void Fields::matrix(const QString &name, Eigen::Matrix4d &value, Shown shown, const QString &label,
                    const QString &help) {
    Matrix44m matrix;
    matrix.FromEigenMatrix(value);
    visit<host::RichMatrixParam>(
        name, shown, [&] { host::matrixParameter(*given, name).ToEigenMatrix(value); }, matrix, label, help);
}

void Fields::openFile(const QString &name, QString &value, Shown shown, const QStringList &endings,
                      const QString &label, const QString &help) {
    visit<host::RichFileParam>(
        name, shown, [&] { value = given->getOpenFileName(name); }, value, endings, label, help);
}

void Fields::saveFile(const QString &name, QString &value, Shown shown, const QString &ending, const QString &label,
                      const QString &help) {
    visit<host::RichSaveFileParam>(
        name, shown, [&] { value = given->getSaveFileName(name); }, value, ending, label, help);
}

void Fields::choice(const QString &name, int &value, Shown shown, const QStringList &values, const QString &label,
                    const QString &help) {
    const auto read = [&] {
        value = given->getEnum(name);
        if (value < 0 || value >= values.size())
            throw vcg::fcd::Error(name.toStdString() + " is " + std::to_string(value) + "; it must be from 0 to " +
                                  std::to_string(values.size() - 1) + ".");
    };
    visit<RichEnum>(name, shown, read, value, values, label, help);
}

void Fields::order(QStringList first, bool others) {
    if (given)
        return;
    if (host::firstMayBeLacking())
        first.prepend(handleLayer);
    first.removeDuplicates();
    RichParameterList ordered;
    for (const QString &name : first)
        ordered.addParam(list.getParameterByName(name));
    for (const RichParameter &parameter : list)
        if (others && !ordered.hasParameter(parameter.name()))
            ordered.addParam(parameter);
    list = ordered;
}
