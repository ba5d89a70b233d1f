// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIT_H
#define VCG_FCD_FIT_H

#include <vcg_ext/deformer.h>
#include <vcg_ext/fit/curve_file.h>
#include <vcg_ext/fit/fit_curves.h>
#include <vcg_ext/fit/fit_samples.h>

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

/// \file
/// Fits one surface onto another: deforms it as rigidly as possible until it lies on the target's triangles or points,
/// with or without landmarks. Parts without a counterpart are carried along.

namespace vcg::fcd {

class FitMatches;
class FitTarget;
struct Contradiction;
struct FitPlacement;

/// A pair of landmarks.
struct Landmark {
    std::size_t vertex;     ///< slot of a vertex of the source
    Eigen::Vector3d target; ///< the landmark's counterpart, world units
    /// From the vertex to the landmark at rest, world units; turns and stretches with the surface at the vertex.
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

/// The target of a fit.
struct FitGoal {
    SurfaceView surface;                                 ///< triangles; points if it has none
    NormalOf normal;                                     ///< of points; may be empty
    Eigen::Affine3d world = Eigen::Affine3d::Identity(); ///< the matrix of its layer
    std::function<void()> isRead; ///< called as soon as its arrays are no longer needed; may be empty
    WeightOf weight;              ///< of each vertex: 0 does not count, 1 counts fully; empty: 1 everywhere
    std::vector<Curve> curves;    ///< curves that vertices of the source slide along, world units; may be empty
    const char *name = "target";  ///< its name in messages
    /// What the surface does not reach, it lacks: it is not drawn there, and a cloud ends where no more points are. So
    /// in its own mirror image: one side may have what the other lacks.
    bool reachesFarther = false;
};

/// The vertices of a surface that lie along a polyline.
struct AlongLine {
    std::vector<std::size_t> vertex;     ///< slots of free vertices, each once, ascending
    std::vector<Eigen::Vector3d> offset; ///< from each to the point of the line nearest to it, world units
    double farthest = 0;                 ///< largest distance of a point of the line from its vertex, world units
    std::size_t corner = 0;              ///< the corner at the farthest point, or the last one before it
    bool isElsewhere = false;            ///< farthest exceeds a tenth of the diagonal and the longest edge
};

/// The curves of a file, with the vertices along them.
struct CurveLead {
    std::vector<Curve> curve; ///< for FitGoal, world units
    std::size_t vertices = 0; ///< number of vertices along them
    double farthest = 0;      ///< largest distance of a curve from its vertices, world units
};

/// How the source is placed before a fit.
enum class FitStart {
    AsItLies,  ///< as the layers lie
    Rigid,     ///< by the rigid motion that takes landmarks nearest to their targets
    Similar,   ///< the same with one scale
    TriedAxes, ///< by the rigid motion onto the target's middle and principal axes: of 24, the one that fits best
};

/// How a surface is fitted.
struct FitParam : DeformationParam {
    FitParam();

    double stiffness = 1; ///< 1e-6 to 1e6: at the end, against following the data; 1 is the default, 10 is stiff
    /// [0, 1]: the share of the stiffness against stretching. At 1, the surface deforms as rigidly as possible. At 0,
    /// each node's map is affine, and only differences between neighbours' maps cost, as with a thin-plate spline: one
    /// stretch, shear or scale of all is free.
    double fitRigidity = 1;
    double largestDistance = std::numeric_limits<double>::infinity(); ///< of matches, world units, > 0
    double largestAngle = 70;            ///< of matches, degrees between the normals, (0, 180]
    int fitSteps = 50;                   ///< the most steps from stiff to soft, >= 2
    FitStart start = FitStart::AsItLies; ///< others only if nothing is fixed and there is no handle
    int samples = 6000;                  ///< points of the source that are matched, 100 to a million
    /// Matches target to source, too: points of the target without a sample nearby draw the nearest sample. false:
    /// tried only if too much of the target is not reached, and kept if it fits better.
    bool bothWays = false;
    double landmarkTolerance = 0; ///< how far off a landmark may stay, world units, >= 0; 0 = rounding
    bool judgesLandmarks = true;  ///< looks for landmarks that the others contradict; false is faster

    /// These parameters for a Fitter that follows landmarks only: nothing is matched, and few steps are enough.
    FitParam LandmarksAlone() const;
    /// \throw BadInput naming the value that is out of range
    void ValidateFit() const;
};

/// How well a surface fits, by its samples.
struct FitReport {
    /// Whether a point at this distance (world units) from the target lies on it: within \p nearest at an open border
    /// of the target, and within three times that elsewhere, where the target's noise reaches farther.
    bool LiesOn(double distance, bool onBorder) const { return distance <= (onBorder ? nearest : 3 * nearest); }

    double nearest = 0;                           ///< 95 % of the matches are within it, world units
    double rms = 0, median = 0, percentile95 = 0; ///< distance of matched samples from the target, world units
    double matched = 0;                           ///< share of the samples that lie on the target, [0, 1]
    double counted = 1;                           ///< share of the free surface with a weight above 0
    double moved = 0, movedMost = 0;              ///< how far matched samples moved: median and largest, world units
    double guessed = 0;                    ///< share of the free surface without a counterpart, which was carried along
    double guessError = 0;                 ///< estimated error of that share, rms, world units; NaN if unknown
    std::size_t carried = 0;               ///< separate parts without a counterpart, carried by the parts around
    double landmarks = 0;                  ///< largest distance of a landmark from its target, world units
    double beyond = 0;                     ///< largest distance of a landmark beyond its tolerance, world units
    double curves = 0;                     ///< largest distance of a vertex from its curve, world units
    double pull = 0;                       ///< largest move of a node to meet all landmarks at the end, world units
    std::vector<std::size_t> contradicted; ///< numbers of landmarks, from 0, that the others contradict
    bool leftOut = false;                  ///< these were not followed, since there is a tolerance
    bool bothWays = false;                 ///< target was matched to source, too: as asked for, or since it fits better
    bool insideOut = false;                ///< the target's normals were flipped: they pointed to the other side
    bool fromAfar = false;      ///< the layers lay far apart, and the surface was first moved onto the target
    bool isSureFromAfar = true; ///< false: another rotation fits nearly as well
    std::size_t endsLed = 0;    ///< ends of limbs that led the fit at first, since it then fits better; 0: none
    double turnedBy = 0;        ///< radians by which the surface was first turned, by its axes, for far less strain
    double scaledBy = 1;        ///< the factor by which it was scaled then, and by the fit
    double strained = 0;        ///< rms change of edge lengths, a fraction, if it is so large that the layers may lie
                                ///< turned, and no better start was found; else 0
    bool otherSize = false;     ///< the target is so much larger or smaller that the fit cannot be trusted
    bool mirrored = false;      ///< the target is the surface's mirror image, or its faces point inwards as that's do
    bool flat = false;          ///< the target is a plane, and the surface is not
    std::size_t unmet = 0;      ///< landmarks beyond their tolerance, since the graph is too coarse for them
    std::size_t notFinite = 0;  ///< vertices of the target that were left out: a coordinate is not finite
    double apart = 0;           ///< distance between the boxes of surface and target, world units
    double larger = 1;          ///< the target's size over that of the surface
    /// Warnings about landmarks and target, with what to do; a sentence or two each.
    std::vector<std::string> Remarks() const;
    std::vector<std::string> LandmarkRemarks() const; ///< those about landmarks
    std::vector<std::string> TargetRemarks() const;   ///< those about the target and its position
    /// Whether one of these tells why the fit did not converge.
    bool IsMisplaced() const { return otherSize || mirrored || flat || isApart; }
    std::vector<char> carriedNode; ///< flags of the graph's nodes: of carried parts; empty: none
    bool isApart = false;          ///< the layers lie far apart, and the surface could not be moved first
    int patchesForAll = 0;         ///< number of patches that is enough for all landmarks
    int steps = 0;
    bool converged = false; ///< the last step moved the nodes by at most 1e-4 of the diagonal, rms, or all further ones
                            ///< together would, by estimate
};

/// A surface that is prepared to be fitted. Fixed vertices stay, and handles move as given.
class Fitter {
  public:
    /// \param source must outlive this \param normal of a source that is a cloud; may be empty
    /// \param handles at least one free vertex; may have no handle
    /// \param weight of each vertex: 0 is carried and not matched, 1 counts fully; empty: 1 everywhere. Not read with
    /// FitParam::LandmarksAlone
    /// \throw BadInput as PrepareDeformer; a parameter or a weight out of range, nothing free that counts, or single
    /// vertices alone
    /// \throw Cancelled
    Fitter(const SurfaceView &source, const NormalOf &normal, const Handles &handles, const FitParam &param,
           const Progress &progress = {}, const WeightOf &weight = {});

    /// Prepares the target, for Solve and Compare. Vertices that are not finite are left out.
    /// \param goal is not needed afterwards \throw BadInput it has no vertices, is a point or a line, or 1e15 times
    /// larger or 1e8 times smaller than the surface; a curve lies elsewhere \throw Cancelled
    std::shared_ptr<const FitTarget> Prepare(const FitGoal &goal, const Progress &progress = {}) const;

    /// A target for poses that follow landmarks only, as rigidly as possible: the landmarks' targets.
    /// \pre made with FitParam::LandmarksAlone
    std::shared_ptr<const FitTarget> TargetOf(const std::vector<Landmark> &landmark) const;

    /// Finds the vertices along polylines: those nearest to the corners and to points between them, at most a mean edge
    /// length apart. If a vertex is nearest to several points, the nearest point counts. Only free vertices are listed.
    /// \param line one or more corners each, world units \return for each line, up to the first one that lies elsewhere
    /// \throw Cancelled
    std::vector<AlongLine> Along(const std::vector<std::vector<Eigen::Vector3d>> &line,
                                 const Progress &progress = {}) const;

    /// Finds the vertices along the source's lines of curves (Along). \param surface name of the source, for messages
    /// \throw BadInput with the line in the file: a curve lies elsewhere, or where nothing is free \throw Cancelled
    CurveLead LeadAlong(const std::vector<CurvePair> &pairs, const std::string &surface,
                        const Progress &progress = {}) const;

    /// Fits the surface, from rest. \throw BadInput landmarks that are no free vertices of the surface (loose parts
    /// only go along), or two at one position; a curve with such a vertex, or with fewer than two points \throw
    /// Unsolvable the fit's system cannot be factorised \throw Cancelled
    Deformer::Pose Solve(const FitTarget &target, const std::vector<Landmark> &landmark, FitReport &report,
                         const Progress &progress = {}) const;

    /// The distance of each landmark from its target in a fit without this landmark, world units. Takes as many fits as
    /// there are landmarks. \throw as Solve
    std::vector<double> LeaveOneOut(const FitTarget &target, const std::vector<Landmark> &landmark,
                                    const Progress &progress = {}) const;

    /// Distances of landmarks from their targets in a pose, world units, for landmarks that were not given to the fit.
    /// \param position 3 x vertex slots, mesh units: of the pose \throw BadInput no vertex, or a target not finite
    std::vector<double> Residuals(const std::vector<Landmark> &pair, const Deformer::Pose &pose,
                                  const PositionsRef &position) const;

    /// The distance of each vertex slot from the target, world units, and whether it lies on it by \p report of the
    /// fit; 0 and false for deleted ones. Vertices of weight 0, and those of carried parts, never lie on it. \param
    /// position 3 x vertex slots, mesh units \throw Cancelled
    void Compare(const FitTarget &target, const FitReport &report, const PositionsRef &position,
                 std::vector<float> &distance, std::vector<char> &liesOn, const Progress &progress = {}) const;

    const Deformer &Surface() const { return *deformer; }

    /// Moves vertices with landmarks, and others at the same position, exactly onto the targets, where the pose has
    /// them in single precision. Landmarks beside their vertices, or that the pose does not meet, stay. \param position
    /// in, out: 3 x vertex slots, mesh units: of the pose
    void PutLandmarks(const std::vector<Landmark> &landmark, Eigen::Ref<Eigen::Matrix3Xd> position) const;

  private:
    class Run;
    Deformer::Pose AtRest(const Progress &progress) const;
    FitSamples Matched(const RegionPose &pose) const;
    Eigen::Affine3d ToFrame(const Eigen::Affine3d &world) const;
    Eigen::Affine3d Start(const FitTarget &target, const FitSamples &samples, std::size_t matched,
                          const std::vector<Landmark> &landmark, const std::vector<Eigen::Vector3d> &place,
                          FitReport &report, unsigned threads) const;
    Eigen::Vector3d OffsetOf(const Landmark &landmark) const;
    bool IsAllFree() const;
    bool MayBegin(const FitReport &report, bool isLed) const; // from another start
    bool FollowsAlone() const;                                // landmarks only: nothing is matched
    bool CountsAt(std::size_t slot, const FitReport &report) const;
    std::size_t CountOn(const FitMatches &matches, const FitReport &report) const;
    double CountedShare() const;
    std::vector<Eigen::Vector3d> Lead(const std::vector<Landmark> &landmark, const RegionPose &pose,
                                      FitSamples &samples) const;
    void MeasureGuess(const FitMatches &matches, const FitSamples &drawn, const std::vector<char> &isFree,
                      const std::vector<char> &leads, const GraphPose &graph, FitReport &report) const;
    bool IsOn(const FitMatches &matches, std::size_t sample, const FitReport &report) const;
    void Judge(const FitTarget &target, const FitPlacement &placement, bool isLed, FitReport &report) const;
    std::vector<Contradiction> Doubted(const FitSamples &drawn, std::size_t first,
                                       const std::vector<Eigen::Vector3d> &place, const std::vector<char> &isFree,
                                       const GraphPose &pose, const Progress &progress) const;
    void Arrive(const FitSamples &drawn, std::size_t first, const std::vector<Eigen::Vector3d> &place,
                const std::vector<char> &leads, const std::vector<char> &isFree, GraphPose &graph, FitReport &report,
                const Progress &progress) const;
    void Measure(const FitMatches &matches, FitReport &report) const;

    const SurfaceView source;
    const Handles handles;
    const FitParam param;
    std::unique_ptr<Deformer> deformer;
    std::vector<Index> sample;                 // nodes of the surface that are matched
    std::vector<Eigen::Vector3d> sampleNormal; // frame units, length 1 or 0
    std::vector<float> nodeWeight;             // of each node of the surface; empty: 1
};

} // namespace vcg::fcd

#endif
