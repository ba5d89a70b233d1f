// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_MESH_COPY_H
#define FCD_MESH_COPY_H

#include "meshlab_host.h"

#include <vcg_ext/base/parallel.h>

#include <Eigen/Core>

#include <cstdint>
#include <vector>

/// The places of live elements when deleted ones are left out.
class Packing {
  public:
    /// \param live number of live elements
    template <class Elements>
    Packing(const Elements &elements, int live) : n(elements.size()) {
        if (std::size_t(live) == n)
            return;
        place.resize(n);
        std::uint32_t next = 0;
        for (std::size_t i = 0; i < n; ++i)
            place[i] = elements[i].IsD() ? gone : next++;
    }

    std::size_t operator()(std::size_t i) const { return place.empty() ? i : place[i]; }

    /// Calls body(i, j) for each live element i, whose place is j; from several threads.
    template <class Body>
    void forEach(const Body &body) const {
        vcg::fcd::ParallelForEach(0, n, 1 << 14, [&](std::size_t i) {
            if (place.empty() || place[i] != gone)
                body(i, (*this)(i));
        });
    }

  private:
    static constexpr std::uint32_t gone = std::uint32_t(-1);
    std::size_t n;
    std::vector<std::uint32_t> place; // empty: all are live
};

/// Copies all live elements of \p from to the empty mesh \p to, in order, with the components and attributes that both
/// have, and the names of textures: as vcg::tri::Append, but in one pass. Of adjacencies, only those to vertices.
/// \param position of the copies, 3 x slots of \p from; then \p to also gets its box; nullptr: those of \p from
void copyElements(CMeshO &to, const CMeshO &from, const Eigen::Matrix3Xd *position = nullptr);

#endif
