// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_FIELD_H
#define PYMESHLAB_FCD_FIELD_H

#include "arrays.h"
#include "listener.h"
#include "space_order.h"

#include <vcg_ext/field/deformation_file.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

/// A deformation. Any number of threads may apply it at a time.
class Field {
  public:
    /// From the content of a file. \param name of the file, for messages \param threads for the preparation, 0 = one a
    /// core
    static std::unique_ptr<Field> read(const nb::bytes &content, const std::string &name, unsigned threads) {
        const std::string text(content.c_str(), content.size());
        const nb::gil_scoped_release release;
        vcg::fcd::Progress progress;
        progress.threads = threads;
        return std::make_unique<Field>(vcg::fcd::ReadDeformationText(text, name), progress);
    }
    Field(vcg::fcd::FieldSamples samples, const vcg::fcd::Progress &progress)
        : field(std::move(samples), progress),
          box(field.samples.position.rowwise().minCoeff(), field.samples.position.rowwise().maxCoeff()) {}

    nb::bytes content() const {
        const std::string text = [&] {
            const nb::gil_scoped_release release;
            return vcg::fcd::DeformationText(field.samples);
        }();
        return nb::bytes(text.data(), text.size());
    }
    std::size_t samples() const { return std::size_t(field.samples.Size()); }

    /// World units; NaN if unknown.
    double largestDifference() const { return field.samples.largestDifference; }

    /// As vcg::fcd::SpaceRemark. A part of the surface, such as a tile, is smaller; other units are mostly a thousand.
    std::string spaceRemark(const Rows &xyz) const {
        const nb::gil_scoped_release release;
        Eigen::AlignedBox3d here;
        for (std::size_t i = 0; i < xyz.shape(0); ++i)
            if (const Eigen::Vector3d p = rowOf(xyz.data(), i); p.allFinite())
                here.extend(p);
        return vcg::fcd::SpaceRemark("The points are", here, box, xyz.shape(0) < 100 ? 0 : 0.01);
    }

    nb::object positions() const {
        double *data;
        nb::object rows = newArray({samples(), 3}, data);
        Eigen::Map<Eigen::Matrix3Xd>(data, 3, Eigen::Index(samples())) = field.samples.position;
        return rows;
    }

    /// \return positions and, with \p normals, the turned ones, with their lengths kept; else None
    nb::tuple apply(const Rows &xyz, const std::optional<Rows> &normals, unsigned threads,
                    const nb::object &report) const {
        const std::size_t n = xyz.shape(0);
        double *moved, *turned = nullptr;
        const nb::object positions = newArray({n, 3}, moved);
        const nb::object others = normals ? newArray({n, 3}, turned) : nb::none();
        const double *from = xyz.data(), *direction = normals ? normals->data() : nullptr;
        Listener::Run(report, threads, [&](const vcg::fcd::Progress &progress) {
            forInSpaceOrder(from, n, box, progress, "Mapping points",
                            [&](std::size_t i, vcg::fcd::NearestPlace::Hint &hint) {
                                Eigen::Matrix3f linear;
                                const auto p = rowOf(from, i);
                                rowOf(moved, i) = p + field(p, direction ? &linear : nullptr, &hint);
                                if (direction)
                                    rowOf(turned, i) = turnedNormal(linear, rowOf(direction, i));
                            });
        });
        return nb::make_tuple(positions, others);
    }

    /// The linear maps of space at points, n x 3 x 3.
    nb::object linear(const Rows &xyz, unsigned threads, const nb::object &report) const {
        const std::size_t n = xyz.shape(0);
        double *to;
        nb::object maps = newArray({n, 3, 3}, to);
        const double *from = xyz.data();
        Listener::Run(report, threads, [&](const vcg::fcd::Progress &progress) {
            forInSpaceOrder(
                from, n, box, progress, "Mapping points", [&](std::size_t i, vcg::fcd::NearestPlace::Hint &hint) {
                    Eigen::Matrix3f map = Eigen::Matrix3f::Identity();
                    field(rowOf(from, i), &map, &hint);
                    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(to + 9 * i) = map.cast<double>();
                });
        });
        return maps;
    }

  private:
    const vcg::fcd::DeformationField field;
    const Eigen::AlignedBox3d box; ///< of its samples
};

#endif
