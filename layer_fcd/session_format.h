// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_SESSION_FORMAT_H
#define FCD_SESSION_FORMAT_H

#include "layer_labels.h"
#include "layer_state.h"
#include "mesh_copy.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <vector>

#include <xxhash.h>

#include <QCborArray>
#include <QCborMap>
#include <QCborValue>
#include <QtEndian>

/// \file
/// Reads and writes the elements of a session (session_file.h): values, and arrays with a value for each live vertex.

/// The tag of a typed array, RFC 8746.
template <class T>
constexpr QCborTag tagOf() {
    return QCborTag(std::is_same<T, double>::value          ? 86
                    : std::is_same<T, std::uint32_t>::value ? 70
                    : std::is_same<T, std::int32_t>::value  ? 78
                                                            : 64);
}

template <class T>
QCborValue arrayOf(std::vector<T> values) {
    if (sizeof(T) > 1)
        qToLittleEndian<T>(values.data(), qsizetype(values.size()), values.data());
    return QCborValue(tagOf<T>(),
                      QByteArray(reinterpret_cast<const char *>(values.data()), int(values.size() * sizeof(T))));
}

/// The live vertices of a layer, in their order.
class LiveVertices {
  public:
    explicit LiveVertices(const CMeshO &mesh) : mesh(mesh), packing(mesh.vert, mesh.vn) {}

    /// An array with \p count values for each vertex. \param take take(slot, values): sets them
    template <class T, class Take>
    QCborValue array(int count, const Take &take) const {
        std::vector<T> values(std::size_t(mesh.vn) * std::size_t(count));
        packing.forEach([&](std::size_t i, std::size_t j) { take(i, &values[j * std::size_t(count)]); });
        return arrayOf(std::move(values));
    }

    /// A normal that is not finite is saved as 0.
    template <class Points>
    QCborValue points(const Points &pointOf) const {
        return array<double>(3, [&](std::size_t i, double *values) {
            const Point3m &p = pointOf(i);
            for (int k = 0; k < 3; ++k)
                values[k] = std::isfinite(double(p[k])) ? double(p[k]) : 0;
        });
    }

    QCborMap shape(const Shape &shape) const {
        return {{QString("position"), points([&](std::size_t i) -> auto & { return shape.position[i]; })},
                {QString("normal"), points([&](std::size_t i) -> auto & { return shape.normal[i]; })}};
    }

    /// The number of a live vertex among these. \param slot of the vertex
    std::size_t numberOf(std::size_t slot) const { return packing(slot); }

    /// A number for the live faces, in hexadecimal digits.
    QByteArray corners() const {
        std::vector<std::uint32_t> corner;
        corner.reserve(3 * std::size_t(mesh.fn));
        for (const CFaceO &face : mesh.face)
            for (int k = 0; !face.IsD() && k < 3; ++k)
                corner.push_back(std::uint32_t(packing(vcg::tri::Index(mesh, face.cV(k)))));
        return QByteArray::number(qulonglong(XXH3_64bits(corner.data(), corner.size() * sizeof(std::uint32_t))), 16);
    }

    /// Calls give(slot, values) for each vertex of an array with \p count values each.
    template <class T, class Give>
    void read(const std::vector<T> &values, int count, const Give &give) const {
        packing.forEach([&](std::size_t i, std::size_t j) { give(i, &values[j * std::size_t(count)]); });
    }

    const CMeshO &mesh;

  private:
    Packing packing;
};

/// Reads a file, and checks each value.
class Reader {
  public:
    Reader(const QCborMap &map, const QString &file, int vertices) : map(map), file(file), vertices(vertices) {}

    [[noreturn]] void fail(const std::string &what) const {
        throw vcg::fcd::Error(inQuotes(file) + " is no session that can be read: " + what +
                              ". Save the session again.");
    }

    bool has(const char *key) const { return map.contains(QString(key)); }

    Reader in(const char *key) const { return Reader(mapOf(map.value(QString(key)), key), file, vertices); }
    Reader in(const QCborValue &value, const char *key) const { return Reader(mapOf(value, key), file, vertices); }

    bool flag(const char *key) const { return checked(key, &QCborValue::isBool, "is neither true nor false").toBool(); }
    double number(const char *key) const {
        const QCborValue value = map.value(QString(key));
        if (!value.isDouble() && !value.isInteger())
            fail(std::string(key) + " is no number");
        return value.toDouble();
    }
    double number(const char *key, double least, double most) const {
        const double value = number(key);
        if (!(value >= least && value <= most))
            fail(std::string(key) + " is out of range");
        return value;
    }
    int whole(const char *key, int most) const { ///< from 0
        const double value = number(key, 0, most);
        if (value != std::floor(value))
            fail(std::string(key) + " is no whole number");
        return int(value);
    }
    std::string text(const char *key) const {
        return checked(key, &QCborValue::isString, "is no text").toString().toStdString();
    }
    QByteArray bytes(const char *key) const {
        return checked(key, &QCborValue::isByteArray, "is missing").toByteArray();
    }
    QCborArray list(const char *key) const { return checked(key, &QCborValue::isArray, "is no list").toArray(); }

    /// \p count values for each vertex, all finite.
    template <class T>
    std::vector<T> array(const char *key, int count, int elements = -1) const {
        const QCborValue value = map.value(QString(key));
        const QByteArray stored =
            value.isTag() && value.tag() == tagOf<T>() ? value.taggedValue().toByteArray() : QByteArray();
        std::vector<T> values(std::size_t(elements < 0 ? vertices : elements) * std::size_t(count));
        if (std::size_t(stored.size()) != values.size() * sizeof(T))
            fail(std::string(key) + " has not the values that it should have");
        std::copy(stored.begin(), stored.end(), reinterpret_cast<char *>(values.data()));
        if (sizeof(T) > 1)
            qFromLittleEndian<T>(values.data(), qsizetype(values.size()), values.data());
        if (!std::all_of(values.begin(), values.end(), [](T each) { return std::isfinite(double(each)); }))
            fail(std::string(key) + " has a number that is not finite");
        return values;
    }

  private:
    QCborValue checked(const char *key, bool (QCborValue::*isSuch)() const, const char *otherwise) const {
        const QCborValue value = map.value(QString(key));
        if (!(value.*isSuch)())
            fail(std::string(key) + " " + otherwise);
        return value;
    }
    QCborMap mapOf(const QCborValue &value, const char *key) const {
        if (!value.isMap())
            fail(std::string(key) + " is missing");
        return value.toMap();
    }

    QCborMap map;
    QString file;
    int vertices;
};

/// \file
/// The parts of a session (session_file.h): shapes, what tags replaced, and the settings of the tools.

Shape shapeOf(const Reader &from, const LiveVertices &live);

QCborMap mapOf(const RestState &state, const LiveVertices &live);
/// Reads it, for the vertices of a layer. \param isAtHome out: flag of each slot: the last pose put the vertex where
/// the layer has it; the caller still has to set RestState::vertex there
RestState restOf(const Reader &from, const LiveVertices &live, std::vector<char> &isAtHome);
/// A vertex that a pose has put at \p p.
PosedVertex posedAt(const Point3m &p);

QCborMap mapOf(const KeptScan &scan, const LiveVertices &live);
/// Reads it, for the vertices of a layer. \param shown the layer's shape when it was saved
KeptScan scanOf(const Reader &from, const LiveVertices &live, const Shape &shown);

QCborMap mapOf(const ToolState &tool);
/// Reads the settings of FCD: Bend, without the shape; null if the session has none.
/// \throw vcg::fcd::Error what is wrong with the file, or with a line of the tool's text; or the layer's matrix differs
std::shared_ptr<ToolState> toolOf(const Reader &from, const MeshModel &layer, const QString &file);

/// The pairs of FCD: Fit; an end at a deleted vertex is left out.
QCborArray arrayOf(const std::vector<FitPair> &pairs, const LiveVertices &live);
/// The options of FCD: Fit, and the weights that are painted on the layer.
QCborMap mapOf(const FitToolState &fit, const MeshModel &layer, const LiveVertices &live);
/// Reads the pairs and options of FCD: Fit, without the shape; null if the session has neither.
/// \throw vcg::fcd::Error what is wrong with the file; or the layer is fitted, and has another matrix
std::shared_ptr<FitToolState> fitOf(const Reader &from, const LiveVertices &live, const MeshModel &layer,
                                    const QString &file);
/// The painted weights, one per vertex slot; empty: none. \throw vcg::fcd::Error what is wrong with the file
std::vector<float> paintedOf(const Reader &from, const LiveVertices &live);

/// A list, in words, of the settings of FCD: Fit that do not suit the layers of the document; or empty.
std::string unfitOf(const FitToolState &fit, const MeshDocument &document, const MeshModel &layer);

#endif
