// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_SURFACE_ARRAYS_H
#define VCG_FCD_SURFACE_ARRAYS_H

#include <vcg_ext/base/memory.h>
#include <vcg_ext/base/progress.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

namespace vcg::fcd {

/// Positions in any memory, 3 x n.
using PositionsRef = Eigen::Ref<const Eigen::Matrix3Xd>;

/// All that the method reads of a mesh or a cloud, as plain arrays that others own: SurfaceArrays, filled from a VCG
/// mesh (read_surface.h), or the caller. A vertex is known by its slot, its index in the arrays. Deleted elements keep
/// their slots.
struct SurfaceView {
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    const double *position = nullptr;      ///< 3 numbers a vertex slot, mesh units
    std::size_t vertexSlots = 0;           ///< below 2^31
    const char *deleted = nullptr;         ///< a flag a vertex slot; null: none is deleted
    const std::uint32_t *corner = nullptr; ///< 3 vertex slots a face; the first one is `none` if the face is deleted
    std::size_t faces = 0;
    const std::uint32_t *end = nullptr; ///< 2 vertex slots an edge element; `none` as in corner
    std::size_t edges = 0;
    bool isCloud = false; ///< all faces and edge elements are deleted, or there are none

    Eigen::Map<const Eigen::Vector3d> At(std::size_t slot) const {
        return Eigen::Map<const Eigen::Vector3d>(position + 3 * slot);
    }
    bool IsDeleted(std::size_t slot) const { return deleted && deleted[slot]; }
    bool IsFace(std::size_t f) const { return corner[3 * f] != none; }
    bool IsEdge(std::size_t e) const { return end[2 * e] != none; }

    /// All positions, 3 x slots, mesh units.
    Eigen::Map<const Eigen::Matrix3Xd> Positions() const {
        return Eigen::Map<const Eigen::Matrix3Xd>(position, 3, Eigen::Index(vertexSlots));
    }

    /// A copy of them.
    Eigen::Matrix3Xd Copy(unsigned threads = 0) const;

    /// The same surface with other positions. \param other 3 x slots, mesh units; must outlive the result
    SurfaceView With(const Eigen::Matrix3Xd &other) const {
        SurfaceView view = *this;
        view.position = other.data();
        return view;
    }

    /// \throw BadInput more vertices or edges than indices can name, or a corner that is no vertex
    void Validate(const Progress &progress = {}) const;
};

/// A surface that owns its arrays; they are not initialised.
class SurfaceArrays {
  public:
    SurfaceArrays() = default;
    /// \throw BadInput more elements than indices can name \throw std::bad_alloc
    SurfaceArrays(std::size_t slots, std::size_t faces, std::size_t edges, bool withDeleted);

    /// Refers to this object.
    SurfaceView View() const;

    double *Position(std::size_t slot) { return position.get() + 3 * slot; }
    char *Deleted() { return deleted.get(); } ///< null without \p withDeleted
    std::uint32_t *Corner(std::size_t face) { return corner.get() + 3 * face; }
    std::uint32_t *End(std::size_t edge) { return end.get() + 2 * edge; }
    std::size_t Slots() const { return slots; }
    bool isCloud = false;

  private:
    std::size_t slots = 0, faces = 0, edges = 0;
    std::unique_ptr<double[]> position;
    std::unique_ptr<char[]> deleted;
    std::unique_ptr<std::uint32_t[]> corner, end;
};

} // namespace vcg::fcd

#endif
