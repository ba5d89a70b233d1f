// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_ARRAYS_H
#define PYMESHLAB_FCD_ARRAYS_H

#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>
#include <vcg_ext/map/normals.h>

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

/// \file
/// Arrays of numpy, as the extension takes and returns them: C-contiguous, never copied.

namespace nb = nanobind;

template <class T, class... Shape>
using Given = nb::ndarray<const T, Shape..., nb::c_contig, nb::device::cpu>;

using Rows = Given<double, nb::shape<-1, 3>>;
using Corners = Given<std::uint32_t, nb::shape<-1, 3>>;
using Written = nb::ndarray<double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

/// A new array of numpy that owns its memory, without values. \param data out: its memory
template <class T>
nb::object newArray(std::initializer_list<std::size_t> shape, T *&data) {
    std::size_t n = 1;
    for (std::size_t each : shape)
        n *= each;
    std::unique_ptr<T[]> memory = vcg::fcd::LargeArray<T>(n);
    data = memory.get();
    nb::capsule owner(memory.release(), [](void *array) noexcept { delete[] static_cast<T *>(array); });
    return nb::cast(nb::ndarray<nb::numpy, T>(data, shape.size(), shape.begin(), owner));
}

/// A new array of T with these values.
template <class T, class Value>
nb::object arrayOf(const std::vector<Value> &values) {
    T *data;
    nb::object made = newArray({values.size()}, data);
    std::copy(values.begin(), values.end(), data);
    return made;
}

/// \throw value_error an array has not as many rows as its surface has vertices
template <class Array>
void expectRows(const Array &rows, std::size_t count) {
    if (rows.shape(0) != count)
        throw nb::value_error("an array has another number of rows than the surface has vertices");
}

inline Eigen::Map<const Eigen::Vector3d> rowOf(const double *rows, std::size_t i) {
    return Eigen::Map<const Eigen::Vector3d>(rows + 3 * i);
}
inline Eigen::Map<Eigen::Vector3d> rowOf(double *rows, std::size_t i) {
    return Eigen::Map<Eigen::Vector3d>(rows + 3 * i);
}

/// A normal turned by a map of points, in double, with its length kept. It keeps its bits if the map is the identity.
inline Eigen::Vector3d turnedNormal(const Eigen::Matrix3f &map, const Eigen::Vector3d &before) {
    if (map == Eigen::Matrix3f::Identity())
        return before;
    const Eigen::Vector3d after = vcg::fcd::Cofactors(Eigen::Matrix3d(map.cast<double>())) * before;
    return after.stableNormalized() * before.stableNorm();
}

#endif
