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

/// A curve of a file: its name, the file's name for messages, the line of each corner of the source, and the corners on
/// source and target.
using FileCurve = std::tuple<nb::bytes, std::string, std::vector<std::size_t>, Rows, Rows>;

/// The curves of vcg::fcd::ReadCurveText, as FileCurve without the file's name.
nb::list readCurves(const nb::bytes &content, const std::string &name);

/// A surface that is prepared to be fitted. It refers to its arrays.
class Fitting {
  public:
    using Numbers = Given<std::int64_t, nb::ndim<1>>;
    using Weights = Given<double, nb::ndim<1>>;
    /// Landmarks: numbers of vertices, targets, and the vectors from the vertices to the landmarks at rest.
    using Pairs = std::tuple<Numbers, Rows, Rows>;

    /// \param tags one per vertex
    /// \param motions of tags, as steps for ReadMotionText \param normals of vertices; those of a cloud tell its sides
    /// apart \param param by name, as in Fitter in Python
    Fitting(const Rows &vertices, const std::optional<Corners> &faces, const Given<std::int32_t, nb::ndim<1>> &tags,
            const std::vector<std::pair<int, std::string>> &motions, const std::optional<Rows> &normals,
            const nb::dict &param, unsigned threads, const nb::object &report);

    /// Fits the surface. \param goal by name: vertices, faces (or None), normals (or None), weights (or None), curves
    /// (vertices and corners of each); empty for landmarks only \param leaveOneOut also fits without each
    /// landmark \return the pose, and the report
    nb::tuple fit(const nb::dict &goal, const Pairs &landmarks, bool leaveOneOut, const nb::object &report) const;

    /// For each curve of \ref readCurves: the numbers of the vertices along the source's line, and the vector from each
    /// to its place there.
    nb::list along(const std::vector<FileCurve> &curves, const nb::object &report) const;

    /// Makes the surface symmetric. \param goal by name: vertex and place of each landmark, the ends of the pairs
    /// first, then the midline; pairs, their number; plane (or None) \param normals, weights as for the constructor
    /// \return the pose, its vertices, the mirror images of their counterparts, flags of vertices with a counterpart,
    /// and the report
    nb::tuple symmetrize(const nb::dict &goal, const std::optional<Rows> &normals,
                         const std::optional<Weights> &weights, const nb::object &report) const;

    /// Puts landmarks exactly into the vertices of a pose.
    void put(const Pairs &landmarks, const Written &vertices) const;

    /// As vcg::fcd::Fitter::Residuals. \param vertices of the pose
    std::vector<double> residuals(const Posed &posed, const Pairs &checks, const Rows &vertices) const;

    std::shared_ptr<Prepared> prepared; ///< of the fitter

  private:
    std::shared_ptr<const vcg::fcd::Fitter> fitter;
};

/// Weights of an array that must outlive the result; empty without one.
vcg::fcd::WeightOf weightsOf(const std::optional<Fitting::Weights> &weights);

/// Normals of rows that must outlive the result; empty without any.
vcg::fcd::NormalOf normalsOf(const std::optional<Rows> &rows);

#endif
