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

/// How components without a handle or fixed vertex move.
enum class LooseParts {
    Follow, ///< that of the nearest part of the surface that is held
    Stay    ///< none
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
    bool bendsUnheld = false; ///< components as large as a patch bend though nothing holds them, as data may move them
    double weldDistance = defaultWeldDistance; ///< of vertices on open borders, as BuildSurfaceGraph takes it
    ShapeConstants shape;

    /// All numbers by which the same surface, nodes and constants are prepared alike, or not.
    auto Numbers() const {
        return std::make_tuple(graph.targetRadius, graph.initialPatches, graph.maxIterations, graph.tolerance,
                               graph.randomSeed, graph.measure, graphWeights, falloff, elastic, weights, influence,
                               looseParts, bendsUnheld, weldDistance);
    }

    /// Whether the free surface is one region, connected or not. Data and lines move all of it; and in the paper's
    /// method, nodes influence vertices across gaps.
    bool IsOneRegion() const {
        return bendsUnheld || weights == MappingWeights::Euclidean || !BeyondPaper(graphWeights).surfaceBalls;
    }
};

/// How a mesh is deformed.
struct DeformationParam : DeformerParam, SolverParam {
    double pose = 100;    ///< percent of the handles' motion
    int steps = 1;        ///< >= 1; the pose is reached over at least so many, each from the one before (StepsTo)
    bool contact = false; ///< also look for contact in a surface of more faces than contactUnasked
    bool measure = false; ///< also measure stretch and rotation of the surface
    bool linear = false;  ///< also give the linear map of the surface around each vertex

    /// \throw BadInput naming the value that is out of range
    void Validate() const;
};

/// A region as it is read, and how it is to be prepared.
struct ReadRegion {
    SurfaceGraph surface;
    std::vector<std::uint32_t> slotOf; ///< of each slot that \p surface has, that of the whole mesh; empty: the same
    std::vector<std::size_t> point;    ///< point handles in it, by their slots in the whole mesh
    HeldNodes held;                    ///< of these points
    std::vector<std::array<Index, 3>> faces; ///< where its volume is to be kept: those with a free node, as nodes
    std::vector<Index> center;               ///< if not empty: given nodes, as nodes of the surface
    bool hasGivenNodes = false;
    std::uint32_t first = 0; ///< as of MovingRegion
    int most = mostPatches;  ///< patches, where their number is not given
};

/// A region that is prepared to be deformed: it owns patches, graph, factorisation and mapping. Then each pose is
/// solved from the motions alone.
///
/// If neither the number of patches nor their radius is given, there are as many as the region needs (PatchesFor). A
/// rough graph of few patches tells that, by its error when what moves turns by 60 degrees (TurnError). It is decided
/// once for all poses: each is part of the way to the others.
class RegionDeformer : public MovingRegion {
  public:
    using Pose = RegionPose;

    /// \param nodeOf out: the node of each slot that it was read with, as of SurfaceGraph
    /// \throw BadInput too many nodes \throw Cancelled
    RegionDeformer(ReadRegion read, const DeformerParam &param, std::vector<Index> &nodeOf, const Progress &progress);

    /// Of the motions of all that is held, those of what holds the region.
    HeldMotions OwnOf(const HeldMotions &all) const;

    /// Any number of threads may solve at a time. \param motions as OwnOf gives them \param last the pose to go on
    /// from, null to begin at rest \throw Unsolvable a graph that cannot be factorised \throw Cancelled
    Pose Solve(HeldMotions motions, const SolverParam &solver, const Pose *last = nullptr,
               const Progress &progress = {}) const;

    /// As Deformer::StepsTo, for this region.
    int StepsTo(const HeldMotions &motions, const HeldMotions *begin = nullptr) const;

    /// The motions, as OwnOf gives them, at one of so many steps of a way, from 1.
    using Way = std::function<HeldMotions(int step, int steps)>;

    /// The pose at the end of a way, in \p steps, or in more if it needs more. The last one from rest is kept, and
    /// given when asked for again. \param begin the pose that it begins at, null for rest
    Pose SolveAlong(const Way &way, const SolverParam &solver, int steps, const Pose *begin = nullptr,
                    const Progress &progress = {}) const;

    /// The last pose that SolveAlong has found from rest, if its motions are these; else null.
    std::shared_ptr<const Pose> Kept(const HeldMotions &motions) const;

    /// Estimates how far \p pose is from the limit of more and more nodes: root mean square over the free surface,
    /// frame units; NaN where it cannot be told. \param solver as the pose was solved with
    double DiscretisationError(const Pose &pose, const SolverParam &solver, const Progress &progress = {}) const;

    const int askedPatches;                      ///< GraphParam::initialPatches that it was prepared with
    const int most;                              ///< as of ReadRegion
    bool IsLimited() const { return isLimited; } ///< whether it would have more patches than that
    double Reach() const { return reach; }       ///< about D, frame units; the same for all seeds
    /// The slots of its point handles; held.pointTag has their tags.
    const std::vector<std::size_t> &Points() const { return point; }

  private:
    /// The factorised systems, for one set of compliant nodes, and for what else they depend on.
    struct System {
        std::vector<bool> compliant;
        std::array<double, 2> numbers; // of NumbersOf
        PartsDeformer parts;
        System(const RegionDeformer &deformer, const NodeConstraints &given, const SolverParam &solver,
               const Progress &progress);
        static std::array<double, 2> NumbersOf(const SolverParam &solver);
    };

    /// A pose from rest, and all that it depends on.
    struct KeptPose {
        SolverParam solver;
        std::vector<HeldMotions> way;
        Pose pose;
        double error = -1; // DiscretisationError, once it is known; of keptLock
    };

    void FindHolding();
    void BuildGraph(const ReadRegion &read, const Progress &progress);
    /// \param count of patches to begin with \param rough as in PatchParam \param clusters from one to the next
    void MakeGraph(const ReadRegion &read, int count, bool rough, KeptClusters &clusters, const Progress &progress);
    /// What holds each node: its tag, or 1 for none. Nodes that are held alone have that of what they belong to.
    std::vector<Index> PartOfNodes() const;
    /// Gives nodes that are held alone the motion of what they belong to.
    void HoldOriginals(HeldMotions &m) const;
    /// All that moves turned by 60 degrees about an axis of the frame, each about the middle of its nodes here, except
    /// single ones, and moved by a tenth of the diagonal along it.
    HeldMotions Probe(int axis) const;
    /// DiscretisationError in these poses, as a fraction of the diagonal: the geometric mean over the three axes, since
    /// one of them may be far off where the surface buckles. NaN if no axis has one.
    double TurnError(const Progress &progress) const;
    NodeConstraints ConstraintsOf(const Pose &pose) const;
    /// \p solver, without what goes beyond the paper where that is not asked for.
    SolverParam StepsOf(SolverParam solver) const;
    std::shared_ptr<const System> SystemOf(const NodeConstraints &given, const SolverParam &solver,
                                           const Progress &progress) const;

    std::vector<std::size_t> point; // as of ReadRegion
    DeformerParam param;
    const BeyondPaper beyond;
    bool isLimited = false;
    double D = 0, reach = 0; // frame units
    detail::SmallParts small;
    std::unique_ptr<const KeptVolume> volume; // where it is to be kept
    struct Holding {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero(); // of its nodes, frame units
        int count = 0;                                    // of these
    };
    std::map<Index, Holding> holding; // the tags that hold it, except points
    mutable std::mutex lock;          // of the next one, for as long as it takes to make it
    mutable std::shared_ptr<const System> latest;
    mutable std::mutex keptLock; // of the next one
    mutable std::shared_ptr<KeptPose> kept;
};

} // namespace vcg::fcd

#endif
