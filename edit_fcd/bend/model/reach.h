// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_REACH_H
#define FCD_BEND_REACH_H

#include <vcg_ext/surface/surface_arrays.h>
#include <vcg_ext/surface/surface_graph.h>

#include <cstdint>
#include <functional>
#include <future>
#include <list>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

/// A ball in which a surface keeps its nodes, frame units.
struct KeptNear {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    float radius = -1; ///< negative: none
    bool holds(const Eigen::Vector3f &p) const { return (p - middle).norm() <= radius; }
};

/// A coarser surface: nodes that are connected within a cell of a grid become one, at their middle. Close parts that
/// are not connected stay apart. Only members that BendReach reads are set.
/// \param most about so many nodes, beside those of \p near
/// \return null if it would not be smaller
std::unique_ptr<vcg::fcd::SurfaceGraph> coarseOf(const vcg::fcd::SurfaceGraph &fine, vcg::fcd::Index most,
                                                 const KeptNear &near = {});

/// The faces of each vertex of a surface.
class VertexFaces {
  public:
    explicit VertexFaces(std::shared_ptr<const vcg::fcd::SurfaceArrays> arrays)
        : arrays(std::move(arrays)), surface(this->arrays->View()), begin(surface.vertexSlots + 1, 0) {
        forCorners([&](std::uint32_t slot, std::size_t) { ++begin[slot]; });
        std::uint32_t sum = 0;
        for (std::uint32_t &each : begin)
            each = sum += each; // the end; becomes the begin below
        faceOf.resize(sum);
        forCorners([&](std::uint32_t slot, std::size_t f) { faceOf[--begin[slot]] = std::uint32_t(f); });
    }

    std::size_t vertexSlots() const { return surface.vertexSlots; }
    /// Calls \p body with the corners of each face of a vertex: three slots.
    template <class Body>
    void forEach(std::size_t slot, const Body &body) const {
        for (std::uint32_t k = begin[slot]; k < begin[slot + 1]; ++k)
            body(surface.corner + 3 * std::size_t(faceOf[k]));
    }

  private:
    template <class Body>
    void forCorners(const Body &body) const {
        for (std::size_t f = 0; f < surface.faces; ++f)
            for (std::size_t k = 0; k < 3 && surface.IsFace(f); ++k)
                body(surface.corner[3 * f + k], f);
    }

    std::shared_ptr<const vcg::fcd::SurfaceArrays> arrays;
    vcg::fcd::SurfaceView surface;
    std::vector<std::uint32_t> begin, faceOf;
};

/// The extent of a handle along the rest shape. All lists are of vertex slots, ascending. Lengths in world units.
struct BendExtent {
    std::vector<std::size_t> vertices; ///< of the handle
    double radius = 0;
    std::vector<std::size_t> around;      ///< within the radius
    std::vector<float> share;             ///< how much each of these moves along: 0 beside what stays, 1 at the core
    std::vector<std::size_t> tips;        ///< tips of the handle's limb, which the ball of the radius cuts off
    std::vector<std::size_t> aside;       ///< other tips that it cuts off: for a shoulder, the head
    bool isOneLimb = true;                ///< the tips are of one limb, and not of two, like an arm and the head
    bool isWhole = false;                 ///< the members below are set
    std::vector<std::size_t> core;        ///< within half the radius, on a limb a quarter
    std::vector<std::size_t> beyond;      ///< tips, and what the core cuts off, with loose parts among these
    std::optional<Eigen::Vector3d> bends; ///< the middle of the outer half of the radius, layer units
    Eigen::Vector3d axis = Eigen::Vector3d::Zero(); ///< across that half, towards the core, frame units; 0: not known
    std::optional<Eigen::Vector3d> joint;           ///< as bends, only on a limb

    float shareOf(std::size_t slot) const; ///< how much any vertex moves with the handle, [0, 1]
    float shareAtJoint() const;            ///< how much what lies at the joint moves
    /// Whether three quarters of the radius bend, and not half: on a limb that goes on beyond.
    bool bendsFar() const { return joint && !beyond.empty(); }
};

/// Distances, extents and limbs along the surface of the rest shape. Lengths in world units.
class BendReach {
  public:
    /// Gives the surface at rest, and the linear part of the layer's matrix.
    using Source = std::function<std::pair<std::shared_ptr<const vcg::fcd::SurfaceArrays>, Eigen::Matrix3d>()>;
    /// \param source called when the surface is first needed
    explicit BendReach(Source source) : source(std::move(source)) {}

    /// Begins to read the surface at rest in the background. All questions below wait for it.
    /// \return whether it is read
    bool begin();
    void clear() { *this = BendReach(std::move(source)); }
    bool isRead() const;
    /// Gives glance() all detail near a vertex, where it would miss a finger. Takes some milliseconds.
    void lookAt(std::size_t slot);
    /// The same on a surface that is coarser away from there, in a few milliseconds: to show while the mouse moves.
    BendReach &glance();

    /// The faces of each vertex, null while the surface is being read.
    const VertexFaces *faces();

    /// The vertices within \p radius of some vertices, slots.
    const std::vector<std::size_t> &of(const std::vector<std::size_t> &vertices, double radius);

    /// The extent of a handle of some vertices, without the members that whole() sets.
    std::shared_ptr<const BendExtent> extent(const std::vector<std::size_t> &vertices, double radius);
    /// \param hair as in looseAmong()
    std::shared_ptr<const BendExtent> whole(const std::vector<std::size_t> &vertices, double radius, double hair);

    /// The default radius of a handle at a vertex: twice the thickness of its limb, if a ball of the radius \p usual
    /// cuts off a tip, or reaches around the end of a limb; else \p usual.
    double radiusAt(std::size_t slot, double usual);

    static constexpr int wholeLimb = -1;
    /// The vertex whose handle turns the limb of another vertex: near the next joint towards the body. A limb has a
    /// joint where it is bent, one where an elbow would be, if it is straight and has a hand or a foot, and one at its
    /// root, where it becomes clearly thicker. Where a vertex would hardly turn with it, it is the vertex itself; none
    /// on no limb. \param usual as in radiusAt() \param hair as in looseAmong() \param nearer how many thicknesses of
    /// the limb nearer to its end, at most to the vertex; wholeLimb: at the root
    std::optional<std::size_t> rootOfLimb(std::size_t slot, double usual, double hair, int nearer = 0);

    /// The extent of a handle that turns the limb beyond the vertex \p from, towards \p to: it bends at \p from, in a
    /// strip 1.5 times as wide as the limb is thick there. On no limb, it is an extent around \p to, and the middle of
    /// its strip is at \p from. Null if the larger part lies beyond, or no surface leads to \p to. \param usual, hair
    /// as of rootOfLimb() \return also whether it is on a limb
    std::pair<std::shared_ptr<const BendExtent>, bool> beyond(std::size_t from, std::size_t to, double usual,
                                                              double hair);

    /// The vertices connected with a vertex in a set. \param isIn flags of vertex slots, true for the vertex
    std::vector<std::size_t> piece(std::size_t slot, const std::vector<char> &isIn);

    /// The tips that a set of vertices cuts off: pieces of the rest that have less than half the area of the largest.
    /// \param isIn flags of vertex slots: the set
    std::vector<std::size_t> tips(const std::vector<char> &isIn);

    /// The loose parts among a set of vertices: not connected with it, close to it, of less than half its area, like
    /// nails. \param isIn flags of vertex slots: the set \param hair how far parts may lie beyond its box, world units
    std::vector<std::size_t> looseAmong(const std::vector<char> &isIn, double hair);

    /// The vertex to pull for a vertex of a tiny part: the nearest one of a part with more than twice the area, within
    /// \p hair (world units), if the tiny part reaches at most two \p hair; else the vertex itself.
    std::size_t carrierOf(std::size_t slot, double hair);

  private:
    void wait();
    /// Radius of the smallest ball around a vertex that closes around its limb, world units; 0: the vertex is on no
    /// limb, or near its end. \param usual the largest radius
    double closingRadius(std::size_t slot, double usual);
    double findClosingRadius(std::size_t slot, double usual);
    /// The radius of a handle on a limb, over the closing radius. That ball reaches half around the limb, pi / 2 times
    /// the thickness. A radius of twice the thickness leaves a strip of 1.5 times the thickness to bend, and a core.
    static constexpr double radiusOfClosing = 4 / EIGEN_PI;
    /// The largest radius for one limb, over that elsewhere on it: a hand is hardly twice as wide as its wrist.
    static constexpr double widest = 2;
    struct Pointed {
        std::size_t slot;
        double usual, hair; ///< as in rootOfLimb(), as is nearer
        int nearer;
    };
    bool turnsOneLimb(std::size_t root, const Pointed &at);
    double radiusAtEnd(std::size_t slot, double usual);
    bool isRoundEnd(std::size_t slot, const Pointed &at);
    std::optional<std::size_t> endOfShortLimb(const Pointed &at);
    std::optional<std::size_t> rootBefore(std::size_t slot, double radius, const Pointed &pointed);
    struct Sections;
    std::vector<vcg::fcd::Index> upToTip(vcg::fcd::Index from, const BendExtent &grip) const;
    Sections sectionsFrom(vcg::fcd::Index tip, vcg::fcd::Index upTo, double length, float most) const;
    void take(std::unique_ptr<vcg::fcd::SurfaceGraph> read);
    struct Pieces {
        std::vector<int> of;     ///< of each node: number of its piece, < 0: none
        std::vector<float> area; ///< frame units^2
        std::size_t largest = 0;
        bool isTip(std::size_t piece) const;
    };
    Pieces piecesBeside(const std::vector<char> &isIn) const;
    std::pair<std::vector<char>, bool> tipsOfLimb(const Pieces &pieces, const std::vector<vcg::fcd::Index> &ball,
                                                  const std::vector<double> &distances) const;
    void findShares(BendExtent &made) const;
    const vcg::fcd::Graph &graph() const { return surface->graph; }
    std::size_t slotOf(vcg::fcd::Index node) const;
    std::vector<vcg::fcd::Index> walk(vcg::fcd::Index from,
                                      const std::function<bool(vcg::fcd::Index, double)> &goesOn) const;
    /// The area of nodes, frame units^2.
    template <class Sum>
    Sum areaOf(const std::vector<vcg::fcd::Index> &nodes) const {
        return std::accumulate(nodes.begin(), nodes.end(), Sum(0), [&](Sum sum, vcg::fcd::Index u) {
            return sum + Sum(surface->nodeArea[std::size_t(u)]);
        });
    }
    vcg::fcd::Index along(vcg::fcd::Index from, double ahead, const std::vector<double> &left) const;
    std::shared_ptr<BendExtent> kept(const std::vector<std::size_t> &vertices, double radius);
    std::vector<char> nodesOf(const std::vector<char> &isIn) const;
    std::vector<char> isAmong(const std::vector<vcg::fcd::Index> &nodes) const;
    std::vector<char> tipNodes(std::vector<char> isNodeIn) const;
    std::vector<char> looseNodes(const std::vector<char> &isNodeIn, double hair) const;
    std::vector<vcg::fcd::Index> nodesWithin(const std::vector<std::size_t> &vertices, double radius,
                                             std::vector<double> *distances = nullptr);
    std::vector<std::size_t> slotsOf(const std::vector<char> &isNodeIn) const;

    Source source;
    std::unique_ptr<vcg::fcd::SurfaceGraph> surface;
    std::unique_ptr<VertexFaces> facesOfVertices;   ///< of the fine surface
    std::unique_ptr<vcg::fcd::SurfaceGraph> middle; ///< the coarse one is made of it; null: of the surface
    std::unique_ptr<BendReach> coarse;              ///< null: the surface has few nodes, or lookAt() was not called
    KeptNear detail;                                ///< of the coarse one
    struct Surfaces {
        std::unique_ptr<vcg::fcd::SurfaceGraph> fine, middle;
        std::unique_ptr<VertexFaces> faces;
    };
    std::future<Surfaces> pending;              ///< valid while the surface is being read
    std::vector<std::uint32_t> beginOf, slotBy; ///< the slots of node u: slotBy from beginOf[u] on, ascending
    std::vector<int> partOf;                    ///< of each node: its connected part
    std::vector<float> partArea;                ///< of each part, frame units^2
    Eigen::Vector3f middleOfAll = Eigen::Vector3f::Zero(); ///< of all nodes, weighted by area, frame units
    float areaOfAll = 0;                                   ///< frame units^2
    std::vector<std::size_t> reached, from;                ///< result and argument of the last call of of()
    double within = 0;
    struct Ball {
        std::vector<vcg::fcd::Index> middle;
        double radius; ///< frame units, as are distances
        std::vector<vcg::fcd::Index> nodes;
        std::vector<double> distances;
    };
    static constexpr std::size_t mostBalls = 4;
    std::list<Ball> balls;                                     ///< results of nodesWithin(), the last used one first
    std::map<std::pair<std::size_t, double>, double> closings; ///< results of closingRadius()
    std::size_t mostExtents = 24; ///< as many as a user has handles; each is some megabytes for a large layer
    std::list<std::shared_ptr<BendExtent>> extents; ///< a cache, the last used one first
};

#endif
