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
/// Deforms a surface of plain arrays: prepared once and posed many times, or in one call.

namespace vcg::fcd {

/// A surface that is prepared to be deformed (PrepareDeformer): a list of regions, which are connected parts of the
/// free surface with the vertices that hold them. Each region is prepared, solved and mapped to its vertices by itself,
/// so a result is the union of the results of the regions, to the bit. Loose parts follow the nearest surface. All
/// const functions are safe for any number of threads.
class Deformer : public MovingSurface {
  public:
    using Pose = SurfacePose;

    /// The motions of \p handles at \p percent of their paths. Tags and vertices of point handles are not read.
    /// \throw BadInput a motion by more than 1e30 times the mesh, or a target that is not finite
    HeldMotions MotionsOf(const Handles &handles, double percent) const;

    /// The pose for \p motions, in one step. A region keeps its pose if its motions are those of \p last, or, without
    /// \p last, those of the last SolveAlong from rest.
    /// \param last the pose to go on from; null: from rest
    /// \throw Unsolvable the graph cannot be factorised \throw Cancelled
    Pose Solve(HeldMotions motions, const SolverParam &solver, const Pose *last = nullptr,
               const Progress &progress = {}) const;

    /// Estimates how far \p pose is from the pose with a node at every vertex: root mean square over the free surface,
    /// as a fraction of the diagonal of the nodes' box; NaN if unknown. \param solver as the pose was solved with
    /// \throw Cancelled
    double DiscretisationError(const Pose &pose, const SolverParam &solver, const Progress &progress = {}) const;

    /// The number of steps to \p motions from \p begin, or from rest (null). In each step, handles and fixed parts of a
    /// region turn by at most 60 degrees against each other.
    int StepsTo(const HeldMotions &motions, const HeldMotions *begin = nullptr) const;

    /// The pose at param.pose percent of the motions of \p handles, reached from rest in param.steps steps, or more for
    /// regions that need more. It follows the shape, stable or not (SolverParam::follow).
    /// \throw as MotionsOf and Solve of motions
    Pose Solve(const Handles &handles, const DeformationParam &param, const Progress &progress = {}) const;

    /// A path of motions: those at a step of 1 to \p steps. Called from several threads, but one at a time.
    using Path = std::function<HeldMotions(int step, int steps)>;

    /// The pose at the end of a path. \param begin the pose that the path begins at; null: at rest \param param its
    /// pose is not read \throw as Solve of motions
    Pose SolveAlong(const Path &path, const DeformationParam &param, const Pose *begin = nullptr,
                    const Progress &progress = {}) const;

    const RegionDeformer &Region(std::size_t i) const { return static_cast<const RegionDeformer &>(*regions[i]); }
    /// The only region, if prepared as one region (DeformerParam::IsOneRegion).
    const RegionDeformer &Whole() const { return Region(0); }

    std::map<Index, Eigen::Vector3d> center;         ///< of each handle tag: the mean of its vertices, mesh units
    std::vector<std::size_t> point;                  ///< slots of the point handles
    std::vector<Eigen::Vector3d> pointRest;          ///< their positions at rest, mesh units
    Index placedNodes = 0;                           ///< number of given nodes (DeformerParam) on the surface
    SurfaceReport report;                            ///< of all regions
    std::vector<std::array<std::uint32_t, 2>> apart; ///< as in SurfaceGraph

  private:
    friend class DeformerMaker;
    Deformer() = default;
    using RegionSolver =
        std::function<RegionPose(const RegionDeformer &, HeldMotions own, const RegionPose *last, const Progress &)>;
    /// The poses of all regions. A region that is at rest in \p last, with the same motions, keeps that pose.
    Pose SolveRegions(HeldMotions motions, const Pose *last, const RegionSolver &solve, const Progress &progress) const;
    Pose SumOf(HeldMotions given, std::vector<RegionPose> regions) const;
    /// Calls body(i, progress) for each region, in parallel.
    void ForRegions(const Progress &progress, const char *stage,
                    const std::function<void(std::size_t, const Progress &)> &body) const;
};

/// Counts the vertices by tag; point handles count as handles.
/// \param slots vertex slots of the surface \param deleted flags of slots, null: none is deleted
/// \throw BadInput wrong number of tags, no handle, or nothing free
TagCount CountHandles(const Handles &handles, std::size_t slots, const char *deleted);

/// Prepares a surface to be deformed. Of \p handles, motions and targets are not read.
/// \param kept if given: a deformer of the same mesh, parameters and \p handles.world; its regions with unchanged tags
///        and point handles are reused
/// \pre one tag per vertex slot, a handle and something free (CountHandles)
/// \throw BadInput no vertices, a coordinate that is not finite, invalid point handles, given nodes that lie
/// elsewhere, or too many nodes \throw Cancelled
std::unique_ptr<Deformer> PrepareDeformer(const SurfaceView &mesh, const Handles &handles, const DeformerParam &param,
                                          const Progress &progress = {}, const Deformer *kept = nullptr);

/// Whether the nodes of the deformer's graph are at \p nodes (3 x k, mesh units), up to rounding to floats.
bool HasNodes(const Deformer &deformer, const Eigen::Matrix3Xd &nodes);

/// A deformation graph of k nodes, as a layer shows it.
struct GraphGeometry {
    Eigen::Matrix3Xd position;              ///< 3 x k, mesh units
    Eigen::Matrix3Xd normal;                ///< 3 x k, of the vertex at the node; 0 if the mesh has no normals
    Eigen::VectorXd radius;                 ///< k, mesh units
    std::vector<std::array<Index, 2>> edge; ///< pairs of nodes, the smaller first
    Eigen::VectorXd energy;                 ///< k, each node's share of Eq. 2, mesh units^2; empty: not deformed
};

/// The deformation graph over a mesh.
struct CentroidalGraph {
    GraphGeometry geometry;
    std::vector<Index> patchOf; ///< patch of each vertex slot, -1 for a deleted vertex
    int iterations = 0;
    bool converged = false;
    double cost = 0;         ///< Eq. 1, mesh units^2
    double targetRadius = 0; ///< D, mesh units
    double averageEdge = 0;  ///< of the mesh, mesh units
    double seconds = 0;
    SurfaceReport surface;
};

/// A deformed mesh.
struct DeformationResult {
    Eigen::Matrix3Xd position; ///< 3 x vertex slots, mesh units; deleted vertices are as they were
    /// Per vertex slot, if param.linear: the linear map of the surface there, mesh units. It maps directions; its
    /// Cofactors map normals.
    std::vector<Eigen::Matrix3f> linear;
    GraphGeometry rest, deformed;         ///< the deformation graph
    std::vector<float> stretch, rotation; ///< if param.measure: as in SurfaceMeasure
    TagCount tags;
    int iterations = 0; ///< of the solver
    bool converged = false;
    double energy = 0;              ///< Eq. 2, mesh units^2
    double discretisationError = 0; ///< as in Deformer::DiscretisationError
    double secondsGraph = 0, secondsSolve = 0, secondsMap = 0;
    SurfaceReport surface;
    Index looseParts = 0;  ///< as in LooseSurface
    Index placedNodes = 0; ///< as in Deformer
    DeformationCheck check;
    SurfaceContact contact; ///< if it was looked for (DeformationParam::contact)
    Deformer::Pose pose;
};

/// The normal of a vertex slot, mesh units, any length; an empty function: there are none.
using NormalOf = std::function<Eigen::Vector3d(std::size_t slot)>;

/// Builds the centroidal deformation graph of a surface (paper, sec. 2.1).
/// \param metric the linear part of the layer's matrix: lengths and areas are measured after it
/// \throw BadInput no vertices, a coordinate that is not finite, a parameter out of range, or too many nodes
/// \throw Cancelled
CentroidalGraph BuildCentroidalGraph(const SurfaceView &mesh, const NormalOf &normal, const GraphParam &param,
                                     const Progress &progress = {},
                                     const Eigen::Matrix3d &metric = Eigen::Matrix3d::Identity());

/// Finds what is probably unwanted in a pose.
/// \param mesh the surface at rest that \p deformer was prepared from, with \p handles
/// \param position 3 x vertex slots, mesh units: that of the pose \throw Cancelled
DeformationCheck CheckPose(const SurfaceView &mesh, const Handles &handles, const Deformer &deformer,
                           const Deformer::Pose &pose, const PositionsRef &position, const Progress &progress = {});

/// Finds where the surface passes through itself in a pose, but not at rest (FindContact).
/// \param mesh the surface at rest that \p deformer was prepared from \param position as in CheckPose
/// \param param that \p deformer was prepared with \throw Cancelled
SurfaceContact ContactOf(const SurfaceView &mesh, const Deformer &deformer, const PositionsRef &position,
                         const DeformerParam &param, const Progress &progress = {});

/// How much of a motion is free of contact: percent, from 0 (rest) to \p param.pose, to a hundredth of that. Found by
/// bisection: if contact begins and ends several times, this is the end of one of the free parts.
/// \param solve gives the pose at some percent of the motion \param param that \p deformer was prepared with
/// \throw Cancelled, and what \p solve throws
double PercentToContact(const SurfaceView &mesh, const Deformer &deformer,
                        const std::function<Deformer::Pose(double percent, const Progress &)> &solve,
                        const DeformationParam &param, const Progress &progress = {});

/// How much a pose stretches and turns the surface, one value per vertex slot.
struct SurfaceMeasure {
    std::vector<float> stretch;  ///< rms length of the vertex's edges over that at rest; 1 = not stretched
    std::vector<float> rotation; ///< angle of rotation there, degrees, [0, 180]
};

/// Measures a pose. \param carrier of the pose \param position 3 x vertex slots, mesh units: of the pose
/// \throw Cancelled
SurfaceMeasure MeasurePose(const Deformer &deformer, const Deformer::Pose &pose, const Carrier &carrier,
                           const PositionsRef &position, const Progress &progress = {});

/// Gives the pose of a prepared surface.
using PoseSolver = std::function<Deformer::Pose(const Progress &)>;

/// Poses a prepared surface, and carries the pose to it (CarryPose).
/// \param mesh the surface at rest that \p deformer was prepared from, with \p handles
/// \param solve gives a pose of \p deformer, with \p param
/// \param result in: position at rest, 3 x slots; out: all but the counts of tags
/// \throw Cancelled, and what \p solve throws
void PoseSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles, const Deformer &deformer,
                 const PoseSolver &solve, const DeformationParam &param, const Progress &progress,
                 DeformationResult &result);

/// Carries result.pose, of \p deformer, to the surface: sets positions, checks and graphs of \p result and, if \p param
/// asks for them, linear maps and measures. \param result as in PoseSurface \throw Cancelled
void CarryPose(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles, const Deformer &deformer,
               const DeformationParam &param, const Progress &progress, DeformationResult &result);

/// Deforms a surface in one call. Fixed vertices and vertices outside the region of influence keep their positions to
/// the bit, handles move by their motions, and free vertices follow as rigidly as possible.
/// \throw BadInput as CountHandles, PrepareDeformer and Deformer::MotionsOf, or a parameter out of range
/// \throw Unsolvable the graph cannot be factorised \throw Cancelled
DeformationResult DeformSurface(const SurfaceView &mesh, const NormalOf &normal, const Handles &handles,
                                const DeformationParam &param, const Progress &progress = {});

} // namespace vcg::fcd

#endif
