// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_REACH_H
#define FCD_BEND_REACH_H

#include <layer_fcd/parameters.h> // before Qt

#include <future>
#include <memory>
#include <vector>

/// What lies within some way of vertices, along the surface of the rest shape.
class BendReach {
  public:
    bool isReady() const { return surface || pending.valid(); }
    /// Reads the surface, beside what is done next; whoever asks for it waits. \pre the layer is at rest \param metric
    /// lengths are measured by, that of the layer's matrix
    void read(const MeshModel &layer, const Eigen::Matrix3d &metric);
    void clear();

    bool knows(const std::vector<std::size_t> &vertices, double radius) const {
        return from == vertices && within == radius;
    }
    /// The vertices within \p radius of some, given by their slots. \pre isReady(), or knows() it
    const std::vector<std::size_t> &of(const std::vector<std::size_t> &vertices, double radius);

    /// What hangs together with a vertex along the surface, of some. \param isIn one per vertex slot, these, the
    /// vertex among them \pre isReady()
    std::vector<std::size_t> piece(std::size_t slot, const std::vector<char> &isIn);

    /// The vertices of the tips that others cut off from the rest of the surface: of the pieces that are left beside
    /// them, those that are clearly smaller than the largest one. \param isIn one per vertex slot, the others \pre
    /// isReady()
    std::vector<std::size_t> tips(const std::vector<char> &isIn);

    /// The vertices of parts that are not connected with others, but lie among them, and are clearly smaller: nails of
    /// a hand. \param isIn one per vertex slot, the others \param hair beyond the box of these, world units \pre
    /// isReady()
    std::vector<std::size_t> looseAmong(const std::vector<char> &isIn, double hair);

    /// The vertex that is pulled where someone points at another one, of a part that is no larger than some hairs: the
    /// nearest one of a part that is clearly larger, if there is one within \param hair, world units; else that one.
    /// \pre isReady()
    std::size_t carrierOf(std::size_t slot, double hair);

  private:
    void wait();

    std::unique_ptr<vcg::fcd::SurfaceGraph> surface;
    std::future<std::unique_ptr<vcg::fcd::SurfaceGraph>> pending; ///< valid while it is being read
    std::vector<int> partOf;                                      ///< of each node of the surface, the connected part
    std::vector<float> partArea;                                  ///< frame units^2
    std::vector<std::size_t> reached, from;                       ///< those of the last
    double within = 0;
};

#endif
