// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_SESSION_H
#define FCD_BEND_SESSION_H

#include "edit_fcd/bend/model/reach.h" // these before Qt
#include "edit_fcd/shape/rest_guard.h"
#include "edit_fcd/shape/pose_solver.h"
#include "edit_fcd/bend/model/state.h"
#include "edit_fcd/view/stretch_colors.h"

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

/// How a filter is told of the motions.
struct BendCall {
    std::string transforms; ///< as "Motions as text" takes them
    double pose;            ///< percent
    bool isExact;           ///< it makes what is shown to the bit
};

/// A layer while it is bent: its rest shape, what is marked on it, how its handles move, and the deformer that is
/// prepared for that. Knows nothing of mouse and screen.
///
/// The layer has the pose; its colours, quality and textures are as they were, and its tags are marks. leave() makes
/// the pose what a filter would have made of it; the session goes on when the tool comes back. Motions and places are
/// in the world, that is after the layer's matrix, but for slots.
class BendSession {
  public:
    /// The present shape of \p layer becomes the rest shape, its tags the marks.
    /// \throw vcg::fcd::Error no vertices, or a matrix without an inverse
    BendSession(MeshDocument &document, MeshModel &layer);

    /// Whether the layer has as many vertices and faces as it had.
    bool fits() const { return rest.fits(); }
    /// A number for the shape that the layer has here. \pre nothing is being dragged
    std::uint64_t shape() const { return rest.known(); }
    /// Whether the layer has the shape, and the marks, that it was given here; if not, something else changed it.
    bool isUpToDate() const;
    /// The same, of all that a filter may have changed while the tool was elsewhere.
    bool isAsLeft() const;

    // --- what is held ---

    const BendState &state() const { return now; }
    /// The tags that all this amounts to.
    const BendTags &tags() const { return *effective; }
    bool isMarked() const { return now.marks != nullptr; }
    /// Whether handles bend what is around them only, since nothing is marked as fixed.
    bool isLocal() const { return local; }
    /// Whether a vertex is not marked as anything else.
    bool isFree(std::size_t slot) const { return !now.marks || (*now.marks)[slot] == 1; }
    std::vector<int> handleTags() const; ///< ascending
    bool isHandle(int tag) const { return center.count(tag) > 0; }
    /// That make its motion; none: it is at rest.
    const std::vector<vcg::fcd::MotionStep> &motionOf(int tag) const;
    int unusedTag() const;
    const BendHandle &handle(int tag) const;
    std::string nameOf(int tag) const;       ///< of a handle, as a person reads it
    std::string motionTextOf(int tag) const; ///< its steps as "Motions as text" takes them; empty: it is at rest
    Eigen::Vector3d centerOf(int tag) const; ///< where the middle of a handle is in the pose
    Eigen::Vector3d dotOf(int tag) const;    ///< where a handle is pointed at, in the pose: its vertex, or its middle
    Eigen::Vector3d pivotOf(int tag) const;  ///< where a handle is turned and scaled, in the pose
    Eigen::Matrix3d axesOf(int tag) const;   ///< by options.axes, as columns; those of the view are not known here
    /// The handle on the other side of the mirror, 0 where there is none or no mirror.
    int mirrored(int tag) const;
    /// The handles that go along when one is moved: those beyond it, but for locked ones.
    std::vector<int> carriedBy(int tag) const;
    /// Whether a vertex is held by a point only because it lies beyond that: a new handle frees it.
    bool isAlong(std::size_t slot) const;

    /// The free or held vertex nearest to \p place in the pose, and how far it is. \return none in an empty layer
    std::optional<std::size_t> nearest(const Eigen::Vector3d &place, double &distance) const;
    Eigen::Affine3d mirror() const;                                  ///< of the world; the identity where there is none
    std::optional<std::size_t> mirroredSlot(std::size_t slot) const; ///< at rest
    Eigen::Vector3d positionOf(std::size_t slot) const;              ///< in the pose
    bool isDeleted(std::size_t slot) const { return layer.cm.vert[slot].IsD(); }
    /// The vertices within \p radius of some, given by their slots, along the surface, in the rest shape.
    const std::vector<std::size_t> &reach(const std::vector<std::size_t> &vertices, double radius);
    /// Begins to read the surface, beside what is done next, that reach() needs.
    void readAhead() { expectReach(); }
    /// From now to endBeside(), addPoint(), makeGrip(), prepare() and beginAnimation() neither read nor change anything
    /// of the layer and its document: they may run beside the window, in which the layer can be seen, saved, and go.
    void beginBeside();
    /// What was done meanwhile counts for the layer, too. \pre the layer is there
    void endBeside();
    double diagonal() const { return rest.diagonal(); } ///< of the bounding box

    // --- changes; each begins with change(), which undo() takes back ---

    void change() { history.begin(now); }
    bool canUndo() const { return history.canUndo(); }
    bool canRedo() const { return history.canRedo(); }
    void undo();
    void redo();
    /// Takes back what was done since the last change(), without a redo.
    void cancel();

    /// Marks vertices; with endMarks() the layer has these marks.
    void mark(const std::vector<std::size_t> &vertices, int tag);
    /// \param rim of what was marked, world units
    void endMarks(double rim);
    void clearMarks();
    /// A new handle around a vertex, or around what carries it where that is of a small part, where that is now. \pre
    /// it isFree(), and no handle holds it, or it isAlong(); the layer has the pose at 100 % \return its tag
    int addPoint(std::size_t slot, double radius);
    /// A point is going to be turned or scaled: it holds all that shall follow, where that is now, and turns about its
    /// vertex. \pre the layer has the pose at 100 %
    void makeGrip(int tag);
    /// Whether a handle bends less than its radius, since others have bent what is beside it: until setRadius().
    bool isKeptApart(int tag) const { return apart.count(rankOf(tag)) > 0; }
    /// How far a handle bends what is around it where nothing is marked as fixed, world units; of a mark, BendRims.
    double radiusOf(int tag) const;
    void setRadius(int tag, double radius);
    double rimAt(std::size_t slot) const; ///< the same of a vertex that is marked
    /// Sets it for what hangs together with a vertex that is marked as fixed, and is so, too.
    void setRimAt(std::size_t slot, double radius);
    /// Of some handles, and of those on the other side of the mirror.
    void setMotion(const std::map<int, std::vector<vcg::fcd::MotionStep>> &steps);
    void setHandle(int tag, BendHandle handle);
    void removeHandle(int tag); ///< its vertices are free
    /// \param place in the pose, none: the handle's middle
    void setPivot(int tag, const std::optional<Eigen::Vector3d> &place);
    void setPose(double percent);
    /// \throw vcg::fcd::Error when it is not the text of a motion
    void setMotionText(int tag, const std::string &text);
    /// \throw vcg::fcd::Error when it is not a text of motions, or not of the handles here
    void setMotions(const std::string &text);
    /// All motions; and no handle keeps what others had bent, unless there are poses with names, which may rely on
    /// that.
    void reset();

    /// The motions as "Motions as text" takes them.
    std::string motionText() const { return vcg::fcd::WriteMotionText(now.motion); }

    // --- poses that have names, which the layer keeps as FCD: Pose Sequence knows them (bend_poses.cpp) ---

    std::vector<vcg::fcd::NamedPose> namedPoses() const;
    /// Percent of each pose, where the motions are a blend of them, else 0.
    std::vector<double> weightsOfPoses() const;
    /// Takes the poses that the layer has been given elsewhere. \return whether they are of this surface
    bool takePoses();
    /// The motions become a pose, shown alone. \return the filter call that makes it
    /// \throw vcg::fcd::Error there are no motions
    std::string keepPose();
    /// The pose of a name, other than \p number, none where there is none.
    std::optional<std::size_t> poseOfName(const std::string &name, std::size_t number) const;
    /// \throw vcg::fcd::Error no name, or that of another pose
    void renamePose(std::size_t number, const std::string &name);
    /// A pose takes the place of another one, whose name it gets, and which is gone.
    void replacePose(std::size_t other, std::size_t number);
    void removePose(std::size_t number);
    /// The motions become the blend of the poses. \throw vcg::fcd::Error a pose moves what is no handle here
    void blend(const std::vector<double> &weights);
    /// Poses of a file take the place of those that there are. \throw vcg::fcd::Error as readPoses
    void loadPoses(const QString &file);
    /// The key frames of the animation, ascending in time.
    std::vector<vcg::fcd::KeyFrame> keyFrames() const;
    /// What is shown of the poses becomes a key frame, a second after the others. \throw vcg::fcd::Error no pose is
    /// shown
    void addKeyFrame();
    /// \throw vcg::fcd::Error a time below 0, or of another key frame
    void setKeyFrame(std::size_t number, vcg::fcd::KeyFrame frame);
    void removeKeyFrame(std::size_t number);
    /// Begins to show the animation, which is no change, as long as nothing else is posed. \return seconds that it
    /// takes \throw vcg::fcd::Error there is none, as blend(), or as prepare()
    double beginAnimation(const vcg::fcd::Progress &progress);
    /// \param time seconds since it began
    void showAnimation(double time);
    void endAnimation() { solver.endBlends(); }
    /// \throw vcg::fcd::Error there are none
    void expectPoses() const;
    /// \pre there are some \throw vcg::fcd::Error the file cannot be written
    void savePoses(const QString &file) const;

    // --- the line that the layer is straightened along (bend_lines.cpp) ---

    /// The line's points where they are in the pose, 3 x n, in the world, as a layer would have them.
    Eigen::Matrix3Xd line() const;
    void setLine(std::vector<BendLinePoint> line) { now.line = std::move(line); }
    /// \throw vcg::fcd::Error as readLine
    void loadLine(const QString &file);
    void expectLine() const; ///< \throw vcg::fcd::Error there are not two points
    /// \throw vcg::fcd::Error the file cannot be written
    void saveLine(const QString &file) const;
    /// The filter call that straightens the layer like that. \param line of these points, or null
    static std::string straightenCall(const StraightenMeshParam &param, const MeshModel *line);

    // --- the pose ---

    /// Milliseconds.
    struct Times {
        double prepare = 0, solve = 0, write = 0;
    };

    /// Solves and writes the pose into the layer's positions and normals. \param full from rest to the end, as the
    /// filters do, with normals of faces and the bounding box; otherwise some steps from the last pose
    /// \param faces normals of faces in any case \throw vcg::fcd::Error
    Times pose(bool full, bool faces = false);
    /// Prepares the deformer if it is not; the layer keeps the shape that it has. \throw vcg::fcd::Error
    /// \throw vcg::fcd::Cancelled \return milliseconds
    double prepare(const vcg::fcd::Progress &progress = {});
    bool moves() const; ///< whether anything leads away from rest
    int nodes() const { return solver.prepared() ? int(solver.prepared()->deformer->Nodes()) : 0; }

    /// The rest shape again, to the bit.
    void restore();

    /// Colours to be drawn over the layer, one per vertex slot: of its stretch where the options say so, and nothing is
    /// being marked, else of its marks. Empty where there is nothing to be shown.
    std::vector<vcg::Color4b> overlay();
    bool isStretchShown() const;

    /// The layer gets the present pose as FCD: Pose in Place gives it. It stays a pose of the rest shape, and the
    /// session goes on if the layer isAsLeft(). \return the filter calls, empty where the layer has it already, or is
    /// at rest
    std::string leave(const Remark &remark);
    /// The same, and that becomes the rest shape.
    std::string applyInPlace(const Remark &remark);
    /// The layer is at rest, and new layers hold the pose as FCD: Deform Mesh gives it; one of them is the current
    /// layer. \return the filter call
    std::string applyToNewLayer(bool graphLayers, const Remark &remark);

    BendOptions options;

  private:
    static std::shared_ptr<const BendTags> marksNow(const MeshModel &layer);
    void keepRest();
    Eigen::Affine3d motionAt(int tag) const;
    Eigen::Vector3d normalOf(int tag) const;
    Eigen::Vector3d placeOf(int tag) const;
    void updateTags();
    void changeTags();
    void changeTagsOf(int tag);
    void findExtents(const BendTags &made);
    bool canBecomePoint(std::size_t slot) const;
    void bendAround(BendTags &made);
    struct Around {
        std::vector<std::size_t> vertices; ///< of a handle
        double radius;                     ///< of what it bends around them
    };
    bool bendAround(const std::vector<Around> &handles, int rank, std::vector<char> &isNear);
    std::vector<int> nextFirst() const;
    void holdBeyond(BendTags &made);
    void hold(BendTags &made);
    void holdGrip(BendTags &made, int tag, double radius);
    double usualGap() const { return gapOfRadius * usualRadius * rest.diagonal(); }
    int rankOf(int tag) const;
    int rankOfNew() const;
    void keepPlace(int tag);
    std::vector<vcg::fcd::MotionStep> stepsSeen(int tag) const;
    void keepPlaceInPoses(int tag, std::shared_ptr<const BendTags> tagsBefore,
                          const std::map<vcg::fcd::Index, Eigen::Vector3d> &centerBefore);
    void setRims(const std::vector<std::size_t> &vertices, double radius);
    void freeGaps(BendTags &made);
    void readSurface();
    void expectReach();
    void writeMarks();
    void takeState();
    void crossApplies();
    void forgetWhatIsGone();
    BendSolver::Motions motionsNow() const;
    HandleParam handleParam() const;
    void handOver();
    std::string poseByFilter(const Remark &remark);
    void beginAnew();
    std::string filterCall(const std::string &script, const BendCall &call, const std::string &more) const;
    std::string shapeCall() const;
    std::optional<std::size_t> poseOfFilter() const;
    BendCall callOfPose() const;
    std::string callInPlace() const;
    std::string callToNewLayer(bool graphLayers) const;
    std::string inNumbers(const std::string &motions) const;
    vcg::fcd::PoseSequence posesInNumbers() const;
    std::vector<Point3m> positionsIn(const vcg::fcd::Deformer::Pose &pose) const;
    void setPoses(vcg::fcd::PoseSequence poses);
    void writePoses();
    void setKeyFrames(std::vector<vcg::fcd::KeyFrame> frames);
    LayerDeformer applying(const Remark &remark);
    std::string blendCall() const;
    void writePose(const vcg::fcd::Deformer::Pose &pose);
    void writeAppliedTags();
    std::vector<std::map<int, vcg::fcd::Motion>> motionsOfPoses() const;
    /// The motions, which are about to be given otherwise than by poses.
    std::map<int, std::vector<vcg::fcd::MotionStep>> &motionByHand();

    MeshDocument &document;
    MeshModel &layer;
    BendRest rest;
    BendReach reachOfRest;

    /// What was applied.
    struct Applied {
        BendState state;
        BendOptions options;
        std::uint64_t rest; ///< shape, as shapeOf tells it
    };

    BendState now;
    BendHistory history;
    std::vector<Applied> applied;                             ///< also what has been undone
    std::size_t applies = 0;                                  ///< that led to the present rest shape
    bool isMarkedHere = false;                                ///< the layer has marks, not other tags
    bool isLeft = false;                                      ///< the layer has what leave() gave it
    bool local = false;                                       ///< isLocal()
    std::set<int> apart;                                      ///< ranks that isKeptApart()
    std::map<int, std::shared_ptr<const BendExtent>> extents; ///< by tag, of handles that others may lie beyond
    std::map<int, std::vector<int>> beyond;                   ///< by tag, the handles that do
    std::map<vcg::fcd::Index, Eigen::Vector3d> center;        ///< of the handles at rest, layer units
    std::shared_ptr<const BendTags> effective;
    std::shared_ptr<BendTags> marking; ///< the marks, while they change
    std::vector<std::size_t> marked;   ///< where, then

    std::shared_ptr<const vcg::fcd::SurfaceArrays> surface; ///< at rest, once it has been read
    std::uint64_t facesOfSurface = 0;                       ///< facesOf the mesh then

    /// What is done beside the window has in the place of the layer, and of the document.
    struct Beside {
        std::vector<Point3m> position;            ///< as the layer shows them; empty: it is at rest
        std::map<std::string, std::string> poses; ///< motions of the named poses: the same without names of layers
        bool arePosesNew = false;                 ///< the layer has not got them yet
    };
    std::unique_ptr<Beside> besides; ///< between beginBeside() and endBeside()

    BendSolver solver;
    bool isFresh = false; ///< prepared since a pose was written: what others have moved, this one may not move
    std::unique_ptr<StretchColors> stretch; ///< once it has been shown
};

#endif
