// SPDX-License-Identifier: GPL-3.0-or-later
// The extension of pymeshlab_fcd: saved deformations, applied to arrays.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <vcg_ext/base/progress.h>
#include <vcg_ext/field/deformation_file.h>
#include <vcg_ext/map/normals.h>

#include <optional>

namespace nb = nanobind;
using vcg::fcd::DeformationField;

namespace {

using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using NewRows = nb::ndarray<nb::numpy, double, nb::shape<-1, 3>>;

NewRows newRows(std::size_t n, double *&data) {
    data = new double[3 * n];
    nb::capsule owner(data, [](void *memory) noexcept { delete[] static_cast<double *>(memory); });
    return NewRows(data, {n, 3}, owner);
}

/// A deformation that any number of threads may apply at a time.
class Field {
  public:
    Field(const nb::bytes &content, const std::string &name)
        : field(vcg::fcd::ReadDeformationText(std::string(content.c_str(), content.size()), name)) {}

    nb::bytes content() const {
        const std::string text = vcg::fcd::DeformationText(field.samples);
        return nb::bytes(text.data(), text.size());
    }
    std::size_t samples() const { return std::size_t(field.samples.Size()); }

    /// NaN where it is not known.
    double largestDifference() const { return field.samples.largestDifference; }

    NewRows positions() const {
        double *data;
        NewRows rows = newRows(samples(), data);
        Eigen::Map<Eigen::Matrix3Xd>(data, 3, Eigen::Index(samples())) = field.samples.position;
        return rows;
    }

    /// \return positions and, if there are \p normals, what these turn to, as long as they were
    nb::tuple apply(const Rows &xyz, const std::optional<Rows> &normals, unsigned threads) const {
        const std::size_t n = xyz.shape(0);
        if (normals && normals->shape(0) != n)
            throw nb::value_error("normals must have as many rows as xyz");
        double *moved, *turned = nullptr;
        const NewRows positions = newRows(n, moved);
        nb::object second = nb::none();
        if (normals)
            second = nb::cast(newRows(n, turned));
        const double *from = xyz.data(), *direction = normals ? normals->data() : nullptr;
        {
            nb::gil_scoped_release release;
            vcg::fcd::ParallelFor(threads, n, 1 << 12, [&](std::size_t first, std::size_t last) {
                Eigen::Matrix3f linear;
                for (std::size_t i = first; i < last; ++i) {
                    const Eigen::Map<const Eigen::Vector3d> p(from + 3 * i);
                    Eigen::Map<Eigen::Vector3d>(moved + 3 * i) = p + field(p, &linear);
                    if (!direction)
                        continue;
                    const Eigen::Map<const Eigen::Vector3d> before(direction + 3 * i);
                    const Eigen::Vector3d after = vcg::fcd::Cofactors(Eigen::Matrix3d(linear.cast<double>())) * before;
                    Eigen::Map<Eigen::Vector3d>(turned + 3 * i) =
                        linear == Eigen::Matrix3f::Identity()
                            ? Eigen::Vector3d(before)
                            : Eigen::Vector3d(after.stableNormalized() * before.norm());
                }
            });
        }
        return nb::make_tuple(positions, second);
    }

  private:
    const DeformationField field;
};

} // namespace

NB_MODULE(_field, module) {
    nb::register_exception_translator([](const std::exception_ptr &thrown, void *) {
        try {
            std::rethrow_exception(thrown);
        } catch (const vcg::fcd::Error &error) {
            PyErr_SetString(PyExc_ValueError, error.what());
        }
    });
    nb::class_<Field>(module, "Field")
        .def(nb::init<const nb::bytes &, const std::string &>(), nb::arg("content"), nb::arg("name"))
        .def("content", &Field::content)
        .def_prop_ro("samples", &Field::samples)
        .def_prop_ro("largest_difference", &Field::largestDifference)
        .def("positions", &Field::positions)
        .def("apply", &Field::apply, nb::arg("xyz"), nb::arg("normals").none(), nb::arg("threads"));
}
