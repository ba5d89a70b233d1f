// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_DEFORMER_H
#define VCG_FCD_DEFORMER_H

#include <vcg_ext/contact/surface_contact.h>
#include <vcg_ext/handles/handles.h>
#include <vcg_ext/map/carrier.h>
#include <vcg_ext/map/deformation_check.h>
#include <vcg_ext/map/moving_surface.h>
#include <vcg_ext/region_deformer.h>
#include <vcg_ext/surface/surface_arrays.h>

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <vector>

/// \file
/// A surface as plain arrays: prepared once, and posed as often as wanted; or deformed in one call.

namespace vcg::fcd {

/// A surface that is prepared to be deformed. It is built once from the surface, its tags, the places of point handles,
/// and parameters. It is a list of regions: connected parts of the free surface with the vertices that hold them. Each
/// region is prepared, solved and mapped to its vertices by itself, so a result is the union of the results of the
/// regions, to the bit. Loose parts follow the nearest surface.
class Deformer : public MovingSurface {
  public:
    using Pose = SurfacePose;

    /// The motions of \p handles at \p percent of their way. Neither their tags nor the vertices of points are read.
    /// \throw BadInput a motion by more than 1e30 times the mesh, or a target that is not finite
    HeldMotions MotionsOf(const Handles &handles, double percent) const;

    /// Any number of threads may solve at a time. \param last the pose to go on from, null to begin at rest. A region
    /// whose motions have not changed since keeps its pose; without \p last, since the last pose that SolveAlong found
    /// from rest.
    /// \throw Unsolvable a graph that cannot be factorised \throw Cancelled
    Pose Solve(HeldMotions motions, const SolverParam &solver, const Pose *last = nullptr,
               const Progress &progress = {}) const;

    /// Estimates how far \p pose is from the limit of more and more nodes: root mean square over the free surface, as
    /// a fraction of the diagonal of the nodes' box; NaN if unknown. \param solver as the pose was solved with
    double DiscretisationError(const Pose &pose, const SolverParam &solver, const Progress &progress = {}) const;

    /// The number of steps from \p begin, or from rest, to \p motions. In each step, what holds a region turns by at
    /// most 60 degrees against what else holds it.
    int StepsTo(const HeldMotions &motions, const HeldMotions *begin = nullptr) const;

    /// The pose at param.pose percent of the motions of \p handles, reached from rest in param.steps steps, or in more
    /// if a region needs more. It follows the shape on the way, stable or not (SolverParam::follow).
    Pose Solve(const Handles &handles, const DeformationParam &param, const Progress &progress = {}) const;

    /// The motions at a step of a way, 1 to steps. Called from several threads, one at a time.
    using Way = std::function<HeldMotions(int step, int steps)>;

    /// The pose at the end of any way. \param begin the pose that it begins at, null for rest; param.pose is not read
    Pose SolveAlong(const Way &way, const DeformationParam &param, const Pose *begin = nullptr,
                    const Progress &progress = {}) const;

    const RegionDeformer &Region(std::size_t i) const { return static_cast<const RegionDeformer &>(*regions[i]); }
    /// All that is free, of one that was prepared as one region (DeformerParam::IsOneRegion).
    const RegionDeformer &Whole() const { return Region(0); }

    std::map<Index, Eigen::Vector3d> center;         ///< of each handle tag: the mean of its vertices, mesh units
    std::vector<std::size_t> point;                  ///< slots of the point handles
    std::vector<Eigen::Vector3d> pointRest;          ///< where they are at rest, mesh units
    Index placedNodes = 0;                           ///< how many of the given nodes lie on the surface, and are used
    SurfaceReport report;                            ///< of all regions
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as of SurfaceGraph

  private:
    friend class DeformerMaker;
    Deformer() = default;
    using RegionSolver =
        std::function<RegionPose(const RegionDeformer &, HeldMotions own, const RegionPose *last, const Progress &)>;
    /// The poses of all regions; one whose motions are those of \p last, where it is at rest, is as it is there.
    Pose SolveRegions(HeldMotions motions, const Pose *last, const RegionSolver &solve, const Progress &progress) const;
    Pose SumOf(HeldMotions given, std::vector<RegionPose> regions) const;
    /// body(i, progress) for each region, side by side.
    void ForRegions(const Progress &progress, const char *stage,
                    const std::function<void(std::size_t, const Progress &)> &body) const;
};

/// Counts the vertices by tag, point handles as handles.
/// \param slots vertex slots of the surface \param deleted flags of slots, null: none is deleted
/// \throw BadInput wrong number of tags, no handle, or nothing free
TagCount CountHandles(const Handles &handles, std::size_t slots, const char *deleted, unsigned threads = 0);

/// Prepares a surface to be deformed: reads the tags of \p handles and where its points are, not their motions.
/// \throw BadInput no vertices, a coordinate that is not finite, point handles that make no sense, or nodes that belong
///        elsewhere \throw Cancelled
/// \pre one tag per vertex slot, a handle and something free (CountHandles)
/// \param kept if given: one of the same mesh, prepared with the same parameters and \p handles.world; its regions that
///        have the same tags and points here are taken over
std::unique_ptr<Deformer> PrepareDeformer(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param,
                                          const Progress &progress = {}, const Deformer *kept = nullptr);

/// Whether the nodes of the deformer's graph are at \p nodes (3 x k, mesh units), up to the rounding of files.
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
    /// Per vertex slot, if param.linear: the linear map of the surface around it, mesh units. It maps directions;
    /// its Cofactors map normals.
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
    SurfaceContact contact; ///< where it was looked for (DeformationParam::contact)
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

/// Finds what is probably not meant in a pose.
/// \param mesh the surface at rest that \p deformer was prepared from, with \p handles
/// \param position 3 x vertex slots, mesh units: that of the pose \throw Cancelled
DeformationCheck CheckPose(const SurfaceView &mesh, const Handles &handles, const Deformer &deformer,
                           const Deformer::Pose &pose, const PositionsRef &position, const Progress &progress = {});

/// Where the surface passes through itself in a pose and did not at rest (FindContact). \throw Cancelled
/// \param mesh the surface at rest that \p deformer was prepared from \param position as of CheckPose
/// \param param that \p deformer was prepared with
SurfaceContact ContactOf(const SurfaceView &mesh, const Deformer &deformer, const PositionsRef &position,
                         const DeformerParam &param, const Progress &progress = {});

/// How much of a motion is free of contact: percent, from 0 (rest) to \p param.pose, to a hundredth of that. Found by
/// bisection: if contact begins and ends several times on the way, it is the end of one of the free parts.
/// \param solve gives the pose at some percent of the motion \param param that \p deformer was prepared with
/// \throw Cancelled, and what \p solve throws
double PercentToContact(const SurfaceView &mesh, const Deformer &deformer,
                        const std::function<Deformer::Pose(double percent, const Progress &)> &solve,
                        const DeformationParam &param, const Progress &progress = {});

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
/// handle vertices go where their motion takes them, and free ones follow as rigidly as possible.
/// \throw BadInput no vertices, a coordinate that is not finite, wrong number of tags, no handle, nothing free, a
///        motion by more than 1e30 times the mesh, or a parameter out of range
/// \throw Unsolvable a graph that cannot be factorised \throw Cancelled
DeformationResult DeformSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles,
                                const DeformationParam &param, const Progress &progress = {});

} // namespace vcg::fcd

#endif
