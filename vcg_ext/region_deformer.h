// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_REGION_DEFORMER_H
#define VCG_FCD_REGION_DEFORMER_H

#include <vcg_ext/graph/falloff.h>
#include <vcg_ext/graph/held_nodes.h>
#include <vcg_ext/map/kept_volume.h>
#include <vcg_ext/map/moving_region.h>
#include <vcg_ext/patches/surface_patches.h>
#include <vcg_ext/shape_constants.h>
#include <vcg_ext/solve/graph_parts.h>
#include <vcg_ext/solve/patch_number.h>
#include <vcg_ext/solve/solver_param.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <tuple>
#include <vector>

namespace vcg::fcd {

/// How loose parts move.
enum class LooseParts {
    Follow, ///< as the nearest surface
    Stay    ///< not at all
};

/// A DiscretisationError above this is reported, with the advice to take more patches.
constexpr double coarseError = 0.01;

/// How a mesh is prepared to be deformed.
struct DeformerParam {
    GraphParam graph;
    Eigen::Matrix3Xd nodes; ///< 3 x k, mesh units: centres of patches to use instead of sampling; empty = sample
    GraphWeights graphWeights = GraphWeights::Border;
    Falloff falloff = Falloff::Smooth; ///< of the motions of all handles
    bool elastic = false;              ///< each region that encloses a volume keeps it (KeptVolume)
    MappingWeights weights = MappingWeights::Surface;
    double influence = 4; ///< node radius over patch radius, > 1
    LooseParts looseParts = LooseParts::Follow;
    bool bendsUnheld = false; ///< loose parts as large as a patch bend, for fits and lines, which move them
    double weldDistance = defaultWeldDistance; ///< frame units, [0, 1e-3], as in BuildSurfaceGraph
    ShapeConstants shape;

    /// All parameters except nodes and shape, to compare two of these.
    auto Numbers() const {
        return std::make_tuple(graph.targetRadius, graph.initialPatches, graph.maxIterations, graph.tolerance,
                               graph.randomSeed, graph.measure, graphWeights, falloff, elastic, weights, influence,
                               looseParts, bendsUnheld, weldDistance);
    }

    /// Whether all free surface is one region, connected or not: data and lines move all of it, and with straight
    /// distances nodes influence vertices across gaps.
    bool IsOneRegion() const {
        return bendsUnheld || weights == MappingWeights::Euclidean || !BeyondPaper(graphWeights).surfaceBalls;
    }
};

/// How a mesh is deformed.
struct DeformationParam : DeformerParam, SolverParam {
    double pose = 100;    ///< percent of the handles' motions
    int steps = 1;        ///< 1 to 1000: the pose is reached in at least so many steps (Deformer::StepsTo)
    bool contact = false; ///< also look for contact if there are more faces than contactUnasked
    bool measure = false; ///< also measure stretch and rotation (SurfaceMeasure)
    bool linear = false;  ///< also give the linear map of the surface at each vertex

    /// \throw BadInput naming the value that is out of range
    void Validate() const;
};

/// A region that was read, and that RegionDeformer prepares.
struct ReadRegion {
    SurfaceGraph surface;
    std::vector<std::uint32_t> slotOf; ///< of each slot of \p surface: its slot in the whole mesh; empty: the same
    std::vector<std::size_t> point;    ///< slots of the point handles in it, in the whole mesh
    HeldNodes held;
    std::vector<std::array<Index, 3>> faces; ///< with DeformerParam::elastic: faces with a free node, as nodes
    std::vector<Index> center;               ///< given nodes (DeformerParam::nodes), as nodes of the surface
    bool hasGivenNodes = false;
    std::uint32_t first = 0; ///< as in MovingRegion
    int most = mostPatches;  ///< largest automatic number of patches
};

/// A region that is prepared to be deformed: it owns patches, graph, factorisation and mapping. A pose depends on the
/// motions alone.
///
/// If neither number nor radius of patches is given, the number is automatic (PatchesFor): a rough graph of few patches
/// is posed with turns of 60 degrees, and its error (TurnError) decides. All poses have one graph.
class RegionDeformer : public MovingRegion {
  public:
    using Pose = RegionPose;

    /// \param nodeOf out: the node of each slot of \p read, as in SurfaceGraph
    /// \throw BadInput too many nodes \throw Cancelled
    RegionDeformer(ReadRegion read, const DeformerParam &param, std::vector<Index> &nodeOf, const Progress &progress);

    /// The motions of what holds this region.
    HeldMotions OwnOf(const HeldMotions &all) const;

    /// The pose for \p motions, in one step. Safe for any number of threads. \param motions as in OwnOf \param last the
    /// pose to go on from; null: from rest \throw Unsolvable the graph cannot be factorised \throw Cancelled
    Pose Solve(HeldMotions motions, const SolverParam &solver, const Pose *last = nullptr,
               const Progress &progress = {}) const;

    /// As Deformer::StepsTo, for this region.
    int StepsTo(const HeldMotions &motions, const HeldMotions *begin = nullptr) const;

    /// A path of motions: those at a step of 1 to \p steps, as in OwnOf.
    using Path = std::function<HeldMotions(int step, int steps)>;

    /// The pose at the end of a path, in at least \p steps steps. The last pose from rest is kept, and returned if it
    /// is asked for again. \param begin the pose that the path begins at; null: at rest \throw as Solve
    Pose SolveAlong(const Path &path, const SolverParam &solver, int steps, const Pose *begin = nullptr,
                    const Progress &progress = {}) const;

    /// The last pose from rest of SolveAlong, if its motions are these; else null.
    std::shared_ptr<const Pose> Kept(const HeldMotions &motions) const;

    /// Estimates how far \p pose is from the pose with a node at every vertex: root mean square over the free surface,
    /// frame units; NaN if unknown. \param solver as the pose was solved with \throw Cancelled
    double DiscretisationError(const Pose &pose, const SolverParam &solver, const Progress &progress = {}) const;

    const int askedPatches;                      ///< GraphParam::initialPatches that it was prepared with
    const int most;                              ///< as in ReadRegion
    bool IsLimited() const { return isLimited; } ///< the automatic number of patches would be above most
    double Reach() const { return reach; }       ///< about D, frame units; the same for all seeds
    /// The slots of its point handles; held.pointTag has their tags.
    const std::vector<std::size_t> &Points() const { return point; }

  private:
    /// The factorised systems, and what they depend on.
    struct System {
        std::vector<bool> compliant;
        SolverParam solver; // that it was made for
        PartsDeformer parts;
        System(const RegionDeformer &deformer, const NodeConstraints &given, const SolverParam &solver,
               const Progress &progress);
        bool Serves(const NodeConstraints &given, const SolverParam &wanted) const;
    };

    /// A pose from rest, and all that it depends on.
    struct KeptPose {
        SolverParam solver;
        std::vector<HeldMotions> path; // of each step
        Pose pose;
        double error = -1; // DiscretisationError; -1: not computed yet; guarded by keptLock
    };

    void FindHolding();
    void BuildGraph(const ReadRegion &read, const Progress &progress);
    /// \param count of patches to begin with \param rough as in PatchParam \param clusters kept between calls
    void MakeGraph(const ReadRegion &read, int count, bool rough, KeptClusters &clusters, const Progress &progress);
    /// The tag of each node, 1 for free ones; single nodes have their original tags.
    std::vector<Index> PartOfNodes() const;
    /// Sets the motions of single nodes to those of their original tags.
    void HoldOriginals(HeldMotions &m) const;
    /// Motions to estimate the error with: each handle turns by 60 degrees about its middle, about an axis of the
    /// frame, and moves by a tenth of the diagonal along it. Single vertices only move.
    HeldMotions Probe(int axis) const;
    /// DiscretisationError in the three poses of Probe, as a fraction of the diagonal: the geometric mean, since one of
    /// them may be far off where the surface buckles. NaN if it is unknown in all of them.
    double TurnError(const Progress &progress) const;
    NodeConstraints ConstraintsOf(const Pose &pose) const;
    /// \p solver without acceleration and following, where BeyondPaper does not allow them.
    SolverParam StepsOf(SolverParam solver) const;
    std::shared_ptr<const System> SystemOf(const NodeConstraints &given, const SolverParam &solver,
                                           const Progress &progress) const;

    std::vector<std::size_t> point; // as in ReadRegion
    DeformerParam param;
    const BeyondPaper beyond;
    bool isLimited = false;
    double D = 0, reach = 0; // frame units
    detail::SmallParts small;
    std::unique_ptr<const KeptVolume> volume; // null: not elastic
    struct Holding {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero(); // of its nodes, frame units
        int count = 0;                                    // of these
    };
    std::map<Index, Holding> holding; // by the tags that hold the region, except point handles
    mutable std::mutex lock;          // of latest, also while it is made
    mutable std::shared_ptr<const System> latest;
    mutable std::mutex keptLock; // of kept
    mutable std::shared_ptr<KeptPose> kept;
};

} // namespace vcg::fcd

#endif
