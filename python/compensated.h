// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef PYMESHLAB_FCD_COMPENSATED_H
#define PYMESHLAB_FCD_COMPENSATED_H

#include "arrays.h"

#include <vcg_ext/compensate.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

/// A compensation: from a nominal part to the part to make.
class Compensating {
  public:
    /// \param param by name, as in compensate in Python
    Compensating(const Rows &vertices, const std::optional<Corners> &faces, const Rows &scan,
                 const std::optional<Corners> &scanFaces, const std::optional<Rows> &scanNormals, const nb::dict &param,
                 unsigned threads, const nb::object &report);

    /// From state().
    explicit Compensating(const nb::bytes &state);

    nb::bytes state() const; ///< for pickles, without made()
    nb::dict told() const;
    std::vector<std::string> warnings() const { return compensation->report.Warnings(); }
    nb::object made() const; ///< the part to make, n x 3
    /// Points of the part to make, for nominal \p points; or, if \p predicted, of the part that would come out.
    nb::object apply(const Rows &points, bool predicted, const nb::object &report) const;

  private:
    unsigned threads = 0;
    std::unique_ptr<const vcg::fcd::Compensation> compensation;
};

#endif
