// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_REACH_H
#define FCD_BEND_REACH_H

#include "edit_fcd/bend/model/coarse_surface.h"
#include "edit_fcd/bend/model/vertex_faces.h"

#include <vcg_ext/surface/surface_graph.h>

#include <cstdint>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <optional>
#include <vector>

/// What belongs to a handle along the surface of the rest shape: vertices, given by their slots, ascending.
struct BendExtent {
    std::vector<std::size_t> vertices; ///< that it was made of
    double radius = 0;
    double cut = 0;                  ///< radius of the smallest ball that cuts off a tip of that limb; 0: there is none
    std::vector<std::size_t> around; ///< within the radius
    std::vector<float> share;        ///< of each of these: how much it moves with the handle, from 0 beside what stays
                                     ///< to 1 at the core
    std::vector<std::size_t> tips;   ///< of what that cuts off, the tips of the limb that the handle is on
    std::vector<std::size_t> aside;  ///< the other tips: the head, seen from a shoulder
    bool isWhole = false;            ///< the next ones are known, too
    std::vector<std::size_t> core;   ///< within half the radius
    std::vector<std::size_t> beyond; ///< those tips, and what the core cuts off, with the loose parts that lie on them
    std::optional<Eigen::Vector3d> bends; ///< the middle of what bends between the core and what stays, layer units
    std::optional<Eigen::Vector3d> joint; ///< the same of a limb

    float shareOf(std::size_t slot) const; ///< how much any vertex moves with the handle, from 0 to 1
};

/// What lies within some distance of vertices, along the surface of the rest shape.
class BendReach {
  public:
    /// The surface at rest, and what lengths are measured by, that of the layer's matrix.
    using Source = std::function<std::pair<std::shared_ptr<const vcg::fcd::SurfaceArrays>, Eigen::Matrix3d>()>;
    /// \param source asked when something of the surface is, first
    explicit BendReach(Source source) : source(std::move(source)) {}

    /// Begins to read the surface at rest in the background, if it is not read; questions about it wait until it is.
    void begin();
    void clear();
    bool isRead() const; ///< then no question waits
    /// Makes glance() see what is near a vertex as it is: a finger, where else the arm is seen. Some milliseconds.
    void lookAt(std::size_t slot);
    /// The same for a surface that is coarser away from there, a few milliseconds' work for what is shown while the
    /// mouse moves.
    BendReach &glance();

    /// The faces of each vertex, null while the surface is being read.
    const VertexFaces *faces();

    /// The vertices within \p radius of some, given by their slots.
    const std::vector<std::size_t> &of(const std::vector<std::size_t> &vertices, double radius);

    /// What belongs to a handle of some vertices; whole() finds the rest of it.
    std::shared_ptr<const BendExtent> extent(const std::vector<std::size_t> &vertices, double radius);
    /// \param hair as looseAmong() has it
    std::shared_ptr<const BendExtent> whole(const std::vector<std::size_t> &vertices, double radius, double hair);

    /// How far a handle of a vertex bends what is around it, until a person says otherwise: twice the thickness of the
    /// limb that it is on, where a ball of the radius \p usual cuts off a tip of one; else \p usual. World units.
    double radiusAt(std::size_t slot, double usual);

    /// The vertex whose handle turns all of the limb that another one is on: near the place from where on it is clearly
    /// thicker than there; that one where this is near. None where it is on no limb. \param usual as radiusAt() has it
    /// \param hair as looseAmong() has it
    std::optional<std::size_t> rootOfLimb(std::size_t slot, double usual, double hair);

    /// What belongs to the handle of what lies beyond a vertex, on the way to another one: it bends at the first one,
    /// as wide as the limb is thick there. On no limb it is around the other one, and the first one in the middle of
    /// what bends. Null where what lies beyond is the larger part, or no surface leads there. \param usual, hair as
    /// rootOfLimb() has them \return and whether that is of a limb
    std::pair<std::shared_ptr<const BendExtent>, bool> beyond(std::size_t from, std::size_t to, double usual,
                                                              double hair);

    /// What hangs together with a vertex along the surface, of some. \param isIn one per vertex slot, these, the
    /// vertex among them
    std::vector<std::size_t> piece(std::size_t slot, const std::vector<char> &isIn);

    /// The vertices of the tips that others cut off from the rest of the surface: of the pieces that are left beside
    /// them, those that are clearly smaller than the largest one. \param isIn one per vertex slot, the others
    std::vector<std::size_t> tips(const std::vector<char> &isIn);

    /// The vertices of parts that are not connected with others, but lie among them, and are clearly smaller: nails of
    /// a hand. \param isIn one per vertex slot, the others \param hair beyond the box of these, world units
    std::vector<std::size_t> looseAmong(const std::vector<char> &isIn, double hair);

    /// The vertex that is pulled where someone points at another one, of a part that is no larger than some hairs: the
    /// nearest one of a part that is clearly larger, if there is one within \param hair, world units; else that one.
    std::size_t carrierOf(std::size_t slot, double hair);

  private:
    void wait();
    double cutAt(std::size_t slot, double usual);
    std::optional<std::size_t> rootBefore(std::size_t slot, double usual, double hair);
    void take(std::unique_ptr<vcg::fcd::SurfaceGraph> read);
    struct Pieces {
        std::vector<int> of;     ///< each node: a number from 0; negative: it is of none
        std::vector<float> area; ///< frame units^2
        std::size_t largest = 0;
        bool isTip(std::size_t piece) const;
    };
    Pieces piecesBeside(const std::vector<char> &isIn) const;
    std::vector<char> tipsOfLimb(const Pieces &pieces, const std::vector<vcg::fcd::Index> &ball,
                                 const std::vector<double> &distances, double &cut) const;
    void findShares(BendExtent &made) const;
    std::size_t slotOf(vcg::fcd::Index node) const;
    vcg::fcd::Index along(vcg::fcd::Index from, double ahead, const std::vector<double> &left) const;
    std::shared_ptr<BendExtent> kept(const std::vector<std::size_t> &vertices, double radius);
    std::vector<char> nodesOf(const std::vector<char> &isIn) const;
    std::vector<char> isAmong(const std::vector<vcg::fcd::Index> &nodes) const;
    std::vector<char> tipNodes(std::vector<char> isNodeIn) const;
    std::vector<char> looseNodes(const std::vector<char> &isNodeIn, double hair) const;
    std::vector<vcg::fcd::Index> nodesWithin(const std::vector<std::size_t> &vertices, double radius,
                                             std::vector<double> *distances = nullptr) const;
    std::vector<std::size_t> slotsOf(const std::vector<char> &isNodeIn) const;

    Source source;
    std::unique_ptr<vcg::fcd::SurfaceGraph> surface;
    std::unique_ptr<VertexFaces> facesOfVertices;   ///< of the surface that is not coarse
    std::unique_ptr<vcg::fcd::SurfaceGraph> middle; ///< what a coarse one is made of; null: the surface itself
    std::unique_ptr<BendReach> coarse;              ///< null: none was asked for
    KeptNear near;                                  ///< of the coarse one
    struct Surfaces {
        std::unique_ptr<vcg::fcd::SurfaceGraph> fine, middle;
        std::unique_ptr<VertexFaces> faces;
    };
    std::future<Surfaces> pending;              ///< valid while they are being read
    std::vector<std::uint32_t> beginOf, slotBy; ///< where the slots of each node begin, and these, ascending
    std::vector<int> partOf;                    ///< of each node of the surface, the connected part
    std::vector<float> partArea;                ///< frame units^2
    std::vector<std::size_t> reached, from;     ///< those of the last
    double within = 0;
    std::size_t mostExtents = 24; ///< as many handles as a person has; of a large layer each is some megabytes
    std::list<std::shared_ptr<BendExtent>> extents; ///< the last ones, the last first
};

#endif
