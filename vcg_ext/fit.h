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
/// Lays one surface onto another: deforms it as rigidly as possible until it lies on triangles or points, with pairs of
/// landmarks or without. What has no counterpart is carried along.

namespace vcg::fcd {

class FitMatches;
class FitTarget;
struct Contradiction;
struct FitPlacement;

/// A pair of landmarks.
struct Landmark {
    std::size_t vertex;     ///< slot of a vertex of the source
    Eigen::Vector3d target; ///< where it belongs, in the world
};

/// What a surface is fitted to.
struct FitGoal {
    SurfaceView surface;                                 ///< triangles; or points, where it has none
    NormalOf normal;                                     ///< of points; may be empty
    Eigen::Affine3d world = Eigen::Affine3d::Identity(); ///< the matrix of its layer
    std::function<void()> isRead; ///< called when no array of it is needed any more; may be empty
    WeightOf weight;              ///< of each vertex: 0 does not count, 1 counts fully; may be empty: 1 everywhere
    std::vector<Curve> curves;    ///< that vertices of the source slide along, in the world; may be empty
    const char *name = "target";  ///< what messages call it
};

/// What of a surface lies along a polyline.
struct AlongLine {
    std::vector<std::size_t> vertex;     ///< slots of free vertices, each once, ascending
    std::vector<Eigen::Vector3d> offset; ///< from each to the place that it is nearest to, world units
    double farthest = 0;                 ///< largest distance of a place along it from its nearest vertex, world units
    std::size_t corner = 0;              ///< at the farthest place, or the last one before it
    bool isElsewhere = false;            ///< farthest exceeds a tenth of the diagonal and the longest edge
};

/// Curves of a file, and what of a surface lies along them.
struct CurveLead {
    std::vector<Curve> curve; ///< in the world, as FitGoal has them
    std::size_t vertices = 0; ///< how many lie along them
    double farthest = 0;      ///< largest distance of a given curve from its vertices, world units
};

/// From where a fit begins.
enum class FitStart {
    AsItLies,  ///< where the layers lie
    Rigid,     ///< by the rigid motion that takes landmarks nearest to where they belong
    Similar,   ///< the same with one scale
    TriedAxes, ///< by the rigid motion onto the target's middle and principal axes, of 24 the one that fits best
};

/// How a surface is fitted.
struct FitParam : DeformationParam {
    FitParam();

    double stiffness = 1; ///< > 0: in the end, against following the data; 1 is the default, 10 is stiff
    /// [0, 1]: how much of the stiffness is against stretching. At 1, the surface goes as rigidly as possible. At 0,
    /// each node's map is affine, and only its change between neighbours costs: what is stretched, sheared or scaled
    /// all over is as free as in a thin-plate spline.
    double fitRigidity = 1;
    double largestDistance = std::numeric_limits<double>::infinity(); ///< of matches, world units, > 0
    double largestAngle = 70;            ///< of matches, degrees between the normals, (0, 180]
    int fitSteps = 50;                   ///< from stiff to soft at most, >= 2
    FitStart start = FitStart::AsItLies; ///< another one only where nothing is fixed and there is no handle
    int samples = 6000;                  ///< places of the source that are matched, 100 to a million
    /// Places of the target with none of the source near draw the nearest one. false: that is only tried if too many
    /// are left, and taken if it fits better.
    bool bothWays = false;
    double landmarkTolerance = 0; ///< world units, >= 0: how far off a landmark may stay; 0 = rounding
    bool judgesLandmarks = true;  ///< looks for landmarks that the others contradict; false is faster

    /// For a Fitter that shall follow landmarks alone: nothing is near enough to be matched. Without matching, the
    /// surface comes to rest in far fewer steps.
    FitParam LandmarksAlone() const;
    /// \throw BadInput naming the value that is out of range
    void ValidateFit() const;
};

/// How well a surface fits, over its samples.
struct FitReport {
    /// Whether a place at this distance from the target, world units, lies on it. Nineteen in twenty matched places are
    /// as near as \p nearest. What is farther is past the border, beside an open one. Elsewhere, the target's noise
    /// reaches three times as far.
    bool LiesOn(double distance, bool onBorder) const { return distance <= (onBorder ? nearest : 3 * nearest); }

    double nearest = 0;                           ///< world units
    double rms = 0, median = 0, percentile95 = 0; ///< distance from the target where it is matched, world units
    double matched = 0;                    ///< share of the samples that have a counterpart, of what counts, [0, 1]
    double counted = 1;                    ///< share of the free surface that counts: its weight is above 0
    double moved = 0, movedMost = 0;       ///< how far what is matched moved: median and most, world units
    double guessed = 0;                    ///< share of the free surface that has no counterpart, and was carried along
    double guessError = 0;                 ///< how far that may be off, root mean square, world units; NaN if unknown
    std::size_t carried = 0;               ///< separate parts without a counterpart, which the parts around carried
    double landmarks = 0;                  ///< largest distance of a landmark from where it belongs, world units
    double beyond = 0;                     ///< how far the landmarks are beyond their tolerance, at most, world units
    double curves = 0;                     ///< largest distance of what lies on a curve from that, world units
    double pull = 0;                       ///< how far nodes moved at most so that all landmarks are met, world units
    std::vector<std::size_t> contradicted; ///< numbers of landmarks, from 0, that the others contradict
    bool leftOut = false;                  ///< these were not followed, as there is a tolerance
    bool bothWays = false;      ///< places of the target drew what is nearest, too: as asked, or as it fits better
    bool insideOut = false;     ///< the target's normals point to the other side than the source's; they were flipped
    bool fromAfar = false;      ///< the layers lay far apart, and the surface was moved onto the target first
    bool isSureFromAfar = true; ///< false: another rotation fits nearly as well
    std::size_t endsLed = 0;    ///< ends of limbs that led the fit at first, as it fits better so; 0: none did
    double turnedBy = 0; ///< radians by which the surface was turned by its axes first, as it is far less strained so
    double scaledBy = 1; ///< the factor by which it was scaled then
    double strained = 0; ///< rms change of edge lengths, a fraction; 0 unless it is so large that the layers may
                         ///< lie turned, and no better start was found
    bool otherSize = false;    ///< the target is so much larger, or smaller, that the fit is not to be trusted
    bool mirrored = false;     ///< the target is the surface's mirror image, or its faces look inwards as of one
    bool flat = false;         ///< the target is a plane, and the surface is none
    std::size_t unmet = 0;     ///< landmarks farther than their tolerance, as the graph is too coarse for them
    std::size_t notFinite = 0; ///< vertices of the target that were left out: a coordinate is not a finite number
    double apart = 0;          ///< between the boxes of surface and target, world units; 0 where they overlap
    double larger = 1;         ///< the target's size over that of the surface
    /// What is wrong with the target or the landmarks and what to do, a sentence or two each; for log and warnings.
    std::vector<std::string> Remarks() const;
    std::vector<std::string> LandmarkRemarks() const; ///< of these, what is about landmarks
    std::vector<std::string> TargetRemarks() const;   ///< and what is about the target, or where it is
    /// Whether one of these tells why a fit does not come to rest.
    bool IsMisplaced() const { return otherSize || mirrored || flat || isApart; }
    std::vector<char> carriedNode; ///< flags of the graph's nodes: of parts that others carried
    bool isApart = false;          ///< nothing of the layers overlaps, and the surface could not be moved first
    int patchesForAll = 0;         ///< so many patches are enough for all landmarks
    int steps = 0;
    bool converged = false; ///< the last step moved the nodes by at most 1e-4 of the diagonal, root mean square, or all
                            ///< further ones together would, by estimate
};

/// A surface that is prepared to be fitted, with its regions: fixed vertices stay, handles move as they are told.
class Fitter {
  public:
    /// \param source must outlive this \param normal of a source that is a cloud; may be empty
    /// \param handles at least one free vertex; may have no handle
    /// \param weight of each vertex: 0 is carried and not matched, 1 counts fully; may be empty: 1 everywhere. Where
    /// landmarks lead alone, it is not looked at
    /// \throw BadInput as PrepareDeformer; a parameter or a weight out of range, nothing free that counts
    /// \throw Cancelled
    Fitter(const SurfaceView &source, const NormalOf &normal, const Handles &handles, const FitParam &param,
           const Progress &progress = {}, const WeightOf &weight = {});

    /// Prepares what it is fitted to, for Solve and Compare. What is not finite is left out.
    /// \param goal is not needed afterwards \throw BadInput it has no vertices, or is a point or a line
    /// \throw Cancelled
    std::shared_ptr<const FitTarget> Prepare(const FitGoal &goal, const Progress &progress = {}) const;

    /// What lies along polylines: the vertices nearest to their corners, and to places between these, no farther apart
    /// than the surface's mean edge length. If several places have one vertex, the nearest place counts. Vertices that
    /// are not free are left out. \param line one or more corners each, in the world \return for each line, up to the
    /// first one that lies elsewhere \throw Cancelled
    std::vector<AlongLine> Along(const std::vector<std::vector<Eigen::Vector3d>> &line,
                                 const Progress &progress = {}) const;

    /// What goes along the source's lines of curves, as Along tells. \param surface what messages call the source
    /// \throw BadInput with the line in the file: a curve lies elsewhere, or where nothing is free \throw Cancelled
    CurveLead LeadAlong(const std::vector<CurvePair> &pairs, const std::string &surface,
                        const Progress &progress = {}) const;

    /// Fits it, from its pose at rest. \throw BadInput landmarks that are no vertices, or twice at one place; a curve
    /// with a vertex that is none or not free, or with fewer than two points
    /// \throw Unsolvable \throw Cancelled
    Deformer::Pose Solve(const FitTarget &target, const std::vector<Landmark> &landmark, FitReport &report,
                         const Progress &progress = {}) const;

    /// The distance of each landmark from where it belongs in a fit without it, world units. Takes as many fits as
    /// there are landmarks. \throw as Solve
    std::vector<double> LeaveOneOut(const FitTarget &target, const std::vector<Landmark> &landmark,
                                    const Progress &progress = {}) const;

    /// The same where landmarks lead alone. \pre, \throw as Follow
    std::vector<double> LeaveOneOut(const std::vector<Landmark> &landmark, const Progress &progress = {}) const;

    /// Distances of vertices from where they belong, world units, for pairs that were kept back from the fit.
    /// \param position 3 x vertex slots, mesh units: that of the pose \throw BadInput no vertex, or a target not finite
    std::vector<double> Residuals(const std::vector<Landmark> &pair, const PositionsRef &position) const;

    /// The pose in which it follows landmarks alone, as rigidly as possible.
    /// \pre made with FitParam::LandmarksAlone \throw BadInput, Unsolvable, Cancelled as Solve
    Deformer::Pose Follow(const std::vector<Landmark> &landmark, FitReport &report,
                          const Progress &progress = {}) const;

    /// The distance of each vertex slot from the target, world units, and whether it lies on it by \p report of the
    /// fit; 0 and false for deleted ones. What does not count, or is carried by other parts, does not lie on it.
    /// \param position 3 x slots, mesh units \throw Cancelled
    void Compare(const FitTarget &target, const FitReport &report, const PositionsRef &position,
                 std::vector<float> &distance, std::vector<char> &liesOn, const Progress &progress = {}) const;

    const Deformer &Surface() const { return *deformer; }

    /// Puts vertices with landmarks, and those at the same place, exactly where they belong: the pose's positions are
    /// there in single precision. Landmarks that the graph is too coarse for stay.
    /// \param position 3 x vertex slots, mesh units: that of the pose
    void PutLandmarks(const std::vector<Landmark> &landmark, Eigen::Ref<Eigen::Matrix3Xd> position) const;

  private:
    class Run;
    Deformer::Pose AtRest(const Progress &progress) const;
    FitSamples Matched(const RegionPose &pose) const;
    Eigen::Affine3d ToFrame(const Eigen::Affine3d &world) const;
    Eigen::Affine3d Start(const FitTarget &target, const FitSamples &samples, std::size_t matched,
                          const std::vector<Eigen::Vector3d> &place, FitReport &report, unsigned threads) const;
    bool IsAllFree() const;
    bool MayBegin(const FitReport &report, bool isLed) const; // elsewhere than where it lies
    bool FollowsAlone() const;                                // its landmarks: nothing is matched
    bool CountsAt(std::size_t slot, const FitReport &report) const;
    std::size_t CountOn(const FitMatches &matches, const FitReport &report) const;
    double CountedShare() const;
    std::vector<Eigen::Vector3d> Lead(const std::vector<Landmark> &landmark, const RegionPose &pose,
                                      FitSamples &samples) const;
    void MeasureGuess(const FitMatches &matches, const FitSamples &drawn, const std::vector<char> &isFree,
                      const std::vector<char> &leads, const GraphPose &graph, FitReport &report) const;
    FitTarget NoTarget(const std::vector<Landmark> &landmark) const;
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
    std::vector<Index> sample;
    std::vector<Eigen::Vector3d> sampleNormal;
    std::vector<float> nodeWeight; // of each node of the surface; empty: 1
};

} // namespace vcg::fcd

#endif
