// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_FITTED_H
#define PYMESHLAB_FCD_FITTED_H

#include "posed.h"

#include <vcg_ext/fit.h>

#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

/// Of a curve in a file: its name, what messages call the file, the line there of each corner of the source, and the
/// corners on source and target.
using FileCurve = std::tuple<nb::bytes, std::string, std::vector<std::size_t>, Rows, Rows>;

/// What vcg::fcd::ReadCurveText reads, but without the name of the file.
nb::list readCurves(const nb::bytes &content, const std::string &name);

/// A surface that is prepared to be fitted. Its arrays are referred to.
class Fitting {
  public:
    using Numbers = Given<std::int64_t, nb::ndim<1>>;
    using Weights = Given<double, nb::ndim<1>>;

    /// \param tags one per vertex \param motions of tags, as ReadMotionText reads their steps
    /// \param normals those of the vertices; a cloud's tell its sides apart \param param by name; see Fitter in Python
    Fitting(const Rows &vertices, const std::optional<Corners> &faces, const Given<std::int32_t, nb::ndim<1>> &tags,
            const std::vector<std::pair<int, std::string>> &motions, const std::optional<Rows> &normals,
            const nb::dict &param, unsigned threads, const nb::object &report);

    /// Fits it. \param goal vertices, faces (or None), normals (or None), weights (or None), curves (pairs of vertices
    /// and corners); empty where the landmarks count alone \param points vertices of the landmarks \param places where
    /// they belong \param leaveOneOut also fits it without each of these \return the pose, and what is told of it
    nb::tuple fit(const nb::dict &goal, const Numbers &points, const Rows &places, bool leaveOneOut,
                  const nb::object &report) const;

    /// Of curves, as \ref readCurves gives them: the numbers of the vertices that go along the source's line, and from
    /// each to its place there.
    nb::list along(const std::vector<FileCurve> &curves, const nb::object &report) const;

    /// Makes it symmetric. \param goal by name: vertex and place of each landmark, of which 2 pairs, and then
    /// the midline; plane (or None) \param normals, weights as it was
    /// made with \return the pose, its vertices, those of the mirror images of counterparts, flags of vertices that
    /// have one, and what is told of it
    nb::tuple symmetrize(const nb::dict &goal, const std::optional<Rows> &normals,
                         const std::optional<Weights> &weights, const nb::object &report) const;

    /// Puts landmarks to the last bit into what a pose has written.
    void put(const Numbers &points, const Rows &places, const Written &vertices) const;

    std::shared_ptr<Prepared> prepared; ///< which the fitter belongs to

  private:
    std::shared_ptr<const vcg::fcd::Fitter> fitter;
};

/// Of an array that outlives it; empty without any.
vcg::fcd::WeightOf weightsOf(const std::optional<Fitting::Weights> &weights);

/// Of rows that outlive it; empty without any.
vcg::fcd::NormalOf normalsOf(const std::optional<Rows> &rows);

#endif
