// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMER_H
#define VCG_FCD_DEFORMER_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/graph/held_nodes.h>
#include <vcg_ext/handles/handles.h>
#include <vcg_ext/map/carrier.h>
#include <vcg_ext/map/deformation_check.h>
#include <vcg_ext/map/moving_surface.h>
#include <vcg_ext/patches/surface_patches.h>
#include <vcg_ext/shape_constants.h>
#include <vcg_ext/solve/graph_parts.h>
#include <vcg_ext/solve/solver_param.h>
#include <vcg_ext/surface/surface_arrays.h>
#include <vcg_ext/surface/surface_graph.h>

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

/// \file
/// A surface as plain arrays: prepared once, and posed as often as wanted; or deformed in one call.

namespace vcg {
namespace fcd {

/// Which motion the components of the mesh without a handle or fixed vertex make.
enum class LooseParts {
    Follow, ///< that of the nearest part of the surface that is held
    Stay    ///< none
};

/// A DiscretisationError that is seen: above it, more patches are made, or asked for.
constexpr double coarseError = 0.01;

/// How a mesh is prepared to be deformed.
struct DeformerParam {
    GraphParam graph;
    Eigen::Matrix3Xd nodes; ///< 3 x k, mesh units: centres of patches to use instead of sampling; empty = sample
    GraphWeights graphWeights = GraphWeights::Border;
    MappingWeights weights = MappingWeights::Surface;
    double influence = 4; ///< node radius over patch radius, > 1
    LooseParts looseParts = LooseParts::Follow;
    bool bendsUnheld = false; ///< components as large as a patch bend though nothing holds them, as data may move them
    double weldDistance = defaultWeldDistance; ///< of vertices on open borders, as BuildSurfaceGraph takes it
    ShapeConstants shape;
};

/// How a mesh is deformed.
struct DeformationParam : DeformerParam, SolverParam {
    double pose = 100;    ///< percent of the handles' motion
    int steps = 1;        ///< >= 1; the pose is reached over at least so many, each from the one before (StepsTo)
    bool measure = false; ///< also measure stretch and rotation of the surface
    bool linear = false;  ///< also give the linear map of the surface around each vertex

    /// \throw BadInput naming the value that is out of range
    void Validate() const;
};

/// A surface that is prepared to be deformed: built once from the surface and its regions (tags, places of point
/// handles, parameters), it owns patches, graph, factorisation and mapping. Then each pose is solved from the motions
/// alone, and carried to the vertices.
///
/// Where neither the number of patches nor their radius is given, there are GraphParam::Patches, or sixteen times
/// as many where those make a shape that is off by more than coarseError when what moves turns by 60 degrees
/// (TurnError). That is decided once for all poses, so that each is part of the way to the others.
class Deformer : public MovingSurface {
  public:
    using Pose = SurfacePose;

    /// \param surface the free surface without its loose parts, and what holds it
    /// \param slotTag one per vertex slot, noVertex where it is deleted \param point slots of the point handles
    /// \param rest 3 x vertex slots, mesh units
    /// \throw BadInput nodes that belong elsewhere \throw Cancelled
    Deformer(SurfaceGraph surface, HeldNodes heldNodes, LooseSurface looseSurface, std::vector<int> slotTag,
             const std::vector<std::size_t> &point, const PositionsRef &rest, const DeformerParam &param,
             const Progress &progress = {});

    /// The motions of \p handles at \p percent of their way; its tags are not read, nor which vertices its points are.
    /// \throw BadInput a motion by more than 1e30 times the mesh, or a target that is not finite
    HeldMotions MotionsOf(const Handles &handles, double percent) const;

    /// Any number of threads may solve at a time. \param last the pose to go on from, null to begin at rest
    /// \throw Unsolvable a graph that cannot be factorised \throw Cancelled
    Pose Solve(HeldMotions motions, const SolverParam &solver, const Pose *last = nullptr,
               const Progress &progress = {}) const;

    /// How far \p pose is from that of more and more nodes, about: root mean square over the free surface, as a
    /// fraction of the diagonal of the box of the nodes; NaN where it cannot be told. \param solver as the pose was
    /// solved with
    double DiscretisationError(const Pose &pose, const SolverParam &solver, const Progress &progress = {}) const;

    /// In how many steps \p motions are followed from \p begin, or from rest, so that in each of them nothing that
    /// holds the free surface turns by more than 60 degrees against another.
    int StepsTo(const HeldMotions &motions, const HeldMotions *begin = nullptr) const;

    /// The pose at param.pose percent of the motions of \p handles, reached from rest in param.steps, or in as many as
    /// they need. It is what grows out of the surface as it is, be it stable or not
    /// (SolverParam::follow).
    Pose Solve(const Handles &handles, const DeformationParam &param, const Progress &progress = {}) const;

    /// The motions at one of so many steps of a way, from 1.
    using Way = std::function<HeldMotions(int step, int steps)>;

    /// The same for the end of any way. \param begin the pose that it begins at, null for rest; param.pose is not read
    Pose SolveAlong(const Way &way, const DeformationParam &param, const Pose *begin = nullptr,
                    const Progress &progress = {}) const;

    std::map<Index, Eigen::Vector3d> center; ///< of each handle tag: the mean of its vertices, mesh units
    Index placedNodes = 0;                   ///< how many of the given nodes lie on the surface, and are used
    double secondsGraph = 0;                 ///< that preparing patches and graph took ...
    double secondsMap = 0;                   ///< ... and the mapping

  private:
    /// What is factorised, for nodes of which some turn with what they hold.
    struct System {
        std::vector<bool> compliant;
        PartsDeformer parts;
        System(const Deformer &deformer, const NodeConstraints &given, const Progress &progress);
    };

    void BuildGraph(const PositionsRef &rest, const Progress &progress);
    void MakeGraph(const PositionsRef &rest, const Progress &progress);
    /// Gives a point handle its motion, mesh units. \param i which one
    void MovePoint(HeldMotions &m, std::size_t i, const Eigen::Matrix4d &motion) const;
    /// Gives nodes that are held alone the motion of what they belong to.
    void HoldOriginals(HeldMotions &m) const;
    /// All that moves turned by 60 degrees about an axis of the frame, each about its own middle, and moved by a tenth
    /// of the diagonal along it.
    HeldMotions Probe(int axis) const;
    /// DiscretisationError when what holds the surface moves so: the largest of the three axes.
    double TurnError(const Progress &progress) const;
    NodeConstraints ConstraintsOf(const Pose &pose) const;
    /// \p solver, without what goes beyond the paper where that is not asked for.
    SolverParam StepsOf(SolverParam solver) const;
    std::shared_ptr<const System> SystemOf(const NodeConstraints &given, const Progress &progress) const;

    std::vector<std::size_t> point;
    std::vector<Eigen::Vector3d> pointRest; // of each point handle, mesh units
    DeformerParam param;
    const BeyondPaper beyond;
    double D = 0; // frame units
    detail::SmallParts small;
    std::vector<double> nodeArea; // k, frame units^2
    std::vector<Index> holding;   // the tags of what holds the graph, but for point handles
    mutable std::mutex lock;      // of what follows
    mutable std::shared_ptr<const System> latest;
};

/// Counts the vertices by tag, point handles as handles.
/// \param slots vertex slots of the surface \param deleted flags of slots, null: none is deleted
/// \throw BadInput wrong number of tags, no handle, or nothing free
TagCount CountHandles(const Handles &handles, std::size_t slots, const char *deleted, unsigned threads = 0);

/// Prepares a surface to be deformed: reads the tags of \p handles and where its points are, not their motions.
/// \throw BadInput no vertices, a coordinate that is not finite, point handles that make no sense, or nodes that belong
///        elsewhere \throw Cancelled
/// \pre one tag per vertex slot, a handle and something free (CountHandles)
std::unique_ptr<Deformer> PrepareDeformer(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param,
                                          const Progress &progress = {});

/// Whether the nodes of the deformer's graph are at \p nodes (3 x k, mesh units), but for what files round.
bool HasNodes(const Deformer &deformer, const Eigen::Matrix3Xd &nodes);

/// What a layer of the deformation graph shows.
struct GraphGeometry {
    Eigen::Matrix3Xd position;              ///< 3 x k, mesh units
    Eigen::Matrix3Xd normal;                ///< 3 x k, that of a vertex there; 0 where the mesh has no normals
    Eigen::VectorXd radius;                 ///< k, mesh units
    std::vector<std::array<Index, 2>> edge; ///< pairs of nodes, the smaller first
    Eigen::VectorXd energy;                 ///< k, each node's share of Eq. 2, mesh units^2; empty: not deformed
};

/// A deformation graph over a mesh.
struct CentroidalGraph {
    GraphGeometry geometry;
    std::vector<Index> patchOf; ///< patch of each vertex slot, -1 for a deleted vertex
    int iterations = 0;
    bool converged = false;
    double cost = 0;         ///< Eq. 1, mesh units^2
    double targetRadius = 0; ///< D that was used, mesh units
    double averageEdge = 0;  ///< mesh units
    double seconds = 0;
    SurfaceReport surface;
};

/// A deformed mesh.
struct DeformationResult {
    Eigen::Matrix3Xd position; ///< 3 x vertex slots, mesh units; that of a deleted vertex stays where it is
    /// Per vertex slot, if wanted: how the surface around it turns and stretches, mesh units. Directions follow it,
    /// normals its Cofactors.
    std::vector<Eigen::Matrix3f> linear;
    GraphGeometry rest, deformed;         ///< the deformation graph before and after
    std::vector<float> stretch, rotation; ///< if measured: as in SurfaceMeasure
    TagCount tags;
    int iterations = 0; ///< of the solver
    bool converged = false;
    double energy = 0;              ///< Eq. 2, mesh units^2
    double discretisationError = 0; ///< as Deformer::DiscretisationError gives it
    double secondsGraph = 0, secondsSolve = 0, secondsMap = 0;
    SurfaceReport surface;
    Index looseParts = 0;  ///< connected components without a fixed or handle vertex
    Index placedNodes = 0; ///< how many of the given nodes lie on the surface, and are used
    DeformationCheck check;
    Deformer::Pose pose;
};

/// The normal of a vertex slot, any length; empty where there are none.
using NormalOf = std::function<Eigen::Vector3d(std::size_t slot)>;

/// Builds the centroidal deformation graph of a surface (paper, sec. 2.1).
/// \param metric the linear part of the layer's matrix: lengths and areas are measured after it
/// \throw BadInput no vertices, a coordinate that is not finite, or a parameter out of range
/// \throw Cancelled
CentroidalGraph BuildCentroidalGraph(const SurfaceView &mesh, const NormalOf &normal, const GraphParam &param,
                                     const Progress &progress = {},
                                     const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity());

/// What in a pose of a surface is probably not meant.
/// \param mesh the surface at rest that \p deformer was prepared from, with \p handles
/// \param position 3 x vertex slots, mesh units: that of the pose \throw Cancelled
DeformationCheck CheckPose(const SurfaceView &mesh, const Handles &handles, const Deformer &deformer,
                           const Deformer::Pose &pose, const PositionsRef &position, const Progress &progress = {});

/// How a pose stretches and turns the surface around each vertex, one per vertex slot.
struct SurfaceMeasure {
    std::vector<float> stretch;  ///< root mean square length of the edges there over that at rest; 1 = not stretched
    std::vector<float> rotation; ///< degrees the surface turned there, [0, 180]
};

/// Measures a pose. \param carrier of the pose \param position 3 x vertex slots, mesh units: that of the pose
/// \throw Cancelled
SurfaceMeasure MeasurePose(const Deformer &deformer, const Deformer::Pose &pose, const Carrier &carrier,
                           const PositionsRef &position, const Progress &progress = {});

/// What solves a pose of a prepared surface, on its own way or another one.
using PoseSolver = std::function<Deformer::Pose(const Progress &)>;

/// Poses a prepared surface.
/// \param mesh the surface at rest that \p deformer, with \p handles, was prepared from
/// \param solve of a pose of \p deformer with \p param
/// \param result in: its position is that at rest, 3 x slots; out: all but the counts of tags
/// \throw Cancelled, and what \p solve throws
void PoseSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles, const Deformer &deformer,
                 const PoseSolver &solve, const DeformationParam &param, const Progress &progress,
                 DeformationResult &result);

/// Carries result.pose, of \p deformer, to the surface: positions and, as \p param wants them, maps and measures, what
/// is probably not meant, and the graph before and after. \param result as that of PoseSurface \throw Cancelled
void CarryPose(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles, const Deformer &deformer,
               const DeformationParam &param, const Progress &progress, DeformationResult &result);

/// Deforms a surface: fixed vertices and vertices outside the region of influence keep their position to the bit,
/// handle vertices are their motion of their rest position, the free ones follow as rigidly as possible. \throw
/// BadInput no vertices, a coordinate that is not finite, wrong number of tags, no handle, nothing free, a
///        motion by more than 1e30 times the mesh, or a parameter out of range
/// \throw Unsolvable a graph that cannot be factorised \throw Cancelled
DeformationResult DeformSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles,
                                const DeformationParam &param, const Progress &progress = {});

} // namespace fcd
} // namespace vcg

#endif
