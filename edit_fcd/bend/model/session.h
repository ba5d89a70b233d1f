// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_SESSION_H
#define FCD_BEND_SESSION_H

#include "edit_fcd/bend/model/ghosts.h" // these before Qt
#include "edit_fcd/bend/model/model.h"
#include "edit_fcd/kit/history.h"
#include "edit_fcd/shape/pose_solver.h"
#include "edit_fcd/shape/rest_guard.h"

#include <vcg_ext/sequence/surface_look.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

struct AnimationExport;
struct ToolState;
class FilesToSave;
namespace vcg::fcd {
struct SequenceReport;
}

/// How the filters are asked for what the panel says.
vcg::fcd::DeformationParam deformationOf(const BendOptions &options);

/// A stroke along a limb, from its joint towards its end; slots of vertices.
struct BendStroke {
    std::size_t from, to;
    Eigen::Vector3d through; ///< the middle of what is seen at its begin, world: where it turns on no limb
};

/// A layer while it is bent: its rest shape, a BendModel, and the deformer that is prepared for that. Knows nothing of
/// mouse and screen.
///
/// The layer has the pose; its colours, quality and textures are as they were, and its tags are marks. leave() makes
/// the pose what a filter would have made of it; the session goes on when the tool comes back. Motions and places are
/// in the world, after the layer's matrix. (More than 25 functions: a layer has marks, poses with names and a shape,
/// and what changes one of these changes them all.)
class BendSession {
  public:
    /// The present shape of \p layer becomes the rest shape, its tags the marks.
    /// \throw vcg::fcd::Error no vertices, or a matrix without an inverse
    BendSession(MeshDocument &document, MeshModel &layer);

    /// Whether the layer has as many vertices and faces as it had.
    bool fits() const { return rest.fits(); }
    /// Goes on with what the layer keeps of an earlier session or a file: rest shape, handles, motions, line and
    /// options. \return whether it keeps any of these \throw vcg::fcd::Error they do not fit the layer; nothing has
    /// changed
    bool goOn();
    /// Undo leads back to what another session knew of the layer, if that began from the same shape.
    void follow(BendSession &&before);

    /// Whether the layer has the shape, and the marks, that it was given here; if not, something else changed it.
    bool isUpToDate() const;
    /// The same, of all that a filter may have changed while the tool was elsewhere.
    bool isAsLeft() const;

    const BendModel &model() const { return data; }
    /// To be changed: motions, what is said of handles, the line and options. All else changes by functions of this.
    BendModel &edit() { return data; }
    const BendState &state() const { return data.state; }
    const BendTags &tags() const { return *data.influence.tags; }
    const RestGuard &restShape() const { return rest; }
    double diagonal() const { return rest.diagonal(); }              ///< of the bounding box
    const BendTags *marksBeingMade() const { return marking.get(); } ///< null: nothing is being marked

    Eigen::Vector3d positionOf(std::size_t slot) const; ///< in the pose
    /// The free or held vertex nearest to \p place in the pose, and how far it is. \return none in an empty layer
    std::optional<std::size_t> nearest(const Eigen::Vector3d &place, double &distance) const;

    /// Begins to read the surface, beside what is done next, that handles need.
    void readAhead() { reach.begin(); }
    /// The faces of each vertex, null while the surface is being read.
    const VertexFaces *faces() { return reach.faces(); }
    /// What would go with a vertex under the mouse, or with a handle of a vertex, about as it will be: null while the
    /// surface is being read. \param usual as addPoint() has it
    std::shared_ptr<const BendExtent> glimpse(std::size_t slot, double usual);
    std::shared_ptr<const BendExtent> glimpseOf(int tag);
    /// The same of the limb that limbAt() would turn, of a vertex or a handle. \return with its handle, 0: a new one
    std::pair<int, std::shared_ptr<const BendExtent>> glimpseLimb(int tag, std::optional<std::size_t> slot,
                                                                  double usual);
    /// The same of what strokeAt() would turn, and where that turns now, world.
    struct Turned {
        int tag = 0;                              ///< 0: a new handle
        std::shared_ptr<const BendExtent> extent; ///< null: there is nothing
        Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
    };
    Turned glimpseStroke(const BendStroke &stroke, double usual);
    /// Where a place at rest is seen now, by a vertex that it goes with; world.
    Eigen::Vector3d seenAt(const Eigen::Vector3d &place, std::size_t slot) const;
    /// From now to endBeside(), addPoint(), makeGrip(), prepare() and beginAnimation() neither read nor change anything
    /// of the layer and its document: they may run beside the window, in which the layer can be seen, saved, and go.
    void beginBeside();
    /// What was done meanwhile counts for the layer, too. \pre the layer is there
    void endBeside();

    // --- changes; each begins with change(), which undo() takes back ---

    void change() {
        marking.reset(); // of a stroke that was given up
        marked.clear();
        history.begin(data.state);
    }
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
    /// canBecomePoint(); the layer has the pose at 100 % \param usual radius where the place tells none, world units
    /// \return its tag
    int addPoint(std::size_t slot, double usual);
    /// A point is going to be turned or scaled: it holds all that shall follow, where that is now, and turns about its
    /// joint, or its vertex. \pre the layer has the pose at 100 %
    void makeGrip(int tag);
    /// The handle that turns the limb that a vertex is on: the nearest one that was turned, on the way to what it hangs
    /// on, or else a new one where the limb begins. \pre as addPoint() \return its tag, 0: there is no limb
    int limbAt(std::size_t slot, double usual);
    /// The handle that turns what lies beyond the begin of a stroke, about the middle of the limb there: one that holds
    /// that place, or else a new one. \pre, usual as addPoint() \return its tag \throw vcg::fcd::Error it leads along
    /// no limb, or to what is fixed
    int strokeAt(const BendStroke &stroke, double usual);
    /// How far a handle, and its twin, bend what is around them where nothing is marked as fixed, world units; within
    /// what the panel has room for.
    void setRadius(int tag, double radius);
    /// Sets it for what hangs together with a vertex that is marked as fixed, and is so, too.
    void setRimAt(std::size_t slot, double radius);
    void removeHandle(int tag); ///< its vertices are free
    /// All motions; and no handle keeps what others had bent, unless there are poses with names, which may rely on
    /// that.
    void reset();

    // --- poses that have names, which the layer keeps as FCD: Pose Sequence knows them (session_poses.cpp) ---

    /// Takes the poses that the layer has been given elsewhere. \return whether they are of this surface
    bool takePoses();
    /// The layer keeps \p poses. \throw vcg::fcd::Error they make no sense
    void setPoses(vcg::fcd::PoseSequence poses);
    /// The motions become a pose, shown alone. \return the filter call that makes it
    /// \throw vcg::fcd::Error there are no motions
    std::string keepPose();
    /// A pose takes the place of another one, whose name it gets, and which is gone.
    void replacePose(std::size_t other, std::size_t number);
    void removePose(std::size_t number);
    /// The motions become the blend of the poses. \throw vcg::fcd::Error a pose moves what is no handle here
    void blend(const std::vector<double> &weights);
    /// Poses of a file take the place of those that there are. \throw vcg::fcd::Error as readPoses
    void loadPoses(const QString &file);
    /// Begins to show the animation, which is no change, as long as nothing else is posed. \return seconds that it
    /// takes \throw vcg::fcd::Error there is none, as blend(), or as prepare()
    double beginAnimation(const vcg::fcd::Progress &progress);
    /// \param time seconds since it began
    void showAnimation(double time);
    void endAnimation() { solver.endBlends(); }

    /// What the shapes of blends follow from: while it is the same, so are they.
    struct BlendSource {
        std::shared_ptr<const BendTags> tags;
        std::shared_ptr<const vcg::fcd::PoseSequence> poses;
        std::shared_ptr<const vcg::fcd::SurfaceArrays> surface; ///< null: the rest shape has not been read
        BendOptions options;

        bool operator==(const BlendSource &o) const {
            return tags == o.tags && poses == o.poses && surface == o.surface && options.givesSameShape(o.options);
        }
    };
    BlendSource blendSource() const;
    /// Finds these shapes. \return null where a pose moves what is no handle here \pre not beside the window
    std::shared_ptr<BlendShapes> blendShapes();

    /// What is exported, as it was when that was asked for.
    struct Animation {
        vcg::fcd::PoseSequence poses; ///< whose motions name no layer
        std::vector<vcg::fcd::KeyFrame> key;
        std::string name; ///< of the layer
        vcg::fcd::SurfaceLook look;
        std::vector<std::string> remarks; ///< on that
    };
    /// \throw vcg::fcd::Error there is none, or not in that range
    Animation animation(const AnimationExport &how);
    /// Writes it as FCD: Pose Sequence does, beside the window too. \param files that get it: once they are saved
    /// \throw vcg::fcd::Error as blend(), prepare() and WriteFrames, or a file that cannot be written
    vcg::fcd::SequenceReport exportAnimation(const Animation &animation, const AnimationExport &how, FilesToSave &files,
                                             const vcg::fcd::Progress &progress);
    /// The filter call that writes the same.
    std::string exportCall(const Animation &animation, const AnimationExport &how) const;

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
    int nodes() const { return solver.prepared() ? int(solver.prepared()->deformer->Nodes()) : 0; }
    /// The rest shape again, to the bit.
    void restore();
    /// Looks where the pose passes through itself and did not at rest, in layers with no more than
    /// vcg::fcd::contactUnasked faces: as long as several steps of a drag. \pre the last pose was a full one
    void findContact();
    /// What that has found; empty since the next pose.
    const vcg::fcd::SurfaceContact &contact() const { return contactOfPose; }

    /// The layer gets the present pose as FCD: Pose in Place gives it. It stays a pose of the rest shape, and the
    /// session goes on if the layer isAsLeft(). \return the filter calls, empty where the layer has it already, or is
    /// at rest
    std::string leave(const Remark &remark);
    /// The same, and that becomes the rest shape.
    std::string applyInPlace(const Remark &remark);
    /// The layer is at rest, and new layers hold the pose as FCD: Deform Mesh gives it; one of them is the current
    /// layer. \return the filter call
    std::string applyToNewLayer(bool graphLayers, const Remark &remark);

  private:
    using Centers = std::map<vcg::fcd::Index, Eigen::Vector3d>;

    static std::shared_ptr<const BendTags> marksNow(const MeshModel &layer);
    void keepRest();
    void updateTags();
    void changeTags();
    void changeTagsOf(int tag);
    void keepPlace(int tag);
    std::vector<vcg::fcd::MotionStep> stepsSeen(int tag) const;
    int turnedLimb(std::size_t slot) const;
    std::optional<std::size_t> newLimb(std::size_t slot, double usual);
    std::pair<int, std::optional<std::size_t>> limbOf(std::size_t slot, double usual);
    std::shared_ptr<const BendExtent> glimpseAt(std::size_t slot, double usual);
    int addAt(std::size_t slot, double radius);
    Turned turnedBy(BendReach &from, const BendStroke &stroke, double usual) const;
    std::optional<std::size_t> mirroredSlot(std::size_t slot) const;
    void readSurface();
    void writeMarks();
    void takeState();

    void keepPlaceInPoses(int tag, std::shared_ptr<const BendTags> tagsBefore, const Centers &centerBefore);
    std::string inNumbers(const std::string &motions) const;
    vcg::fcd::PoseSequence posesInNumbers() const;
    std::vector<std::map<int, vcg::fcd::Motion>> motionsOfPoses() const;
    std::vector<Point3m> positionsIn(const vcg::fcd::Deformer::Pose &pose) const;
    void writePoses();

    void writePose(const vcg::fcd::Deformer::Pose &pose);
    HandleParam handleParam() const;
    std::shared_ptr<const ToolState> toolNow() const;
    void keepState();
    void handOver();
    void writeAppliedTags();
    LayerDeformer applying(const Remark &remark);
    std::string poseByFilter(const Remark &remark);
    void beginAnew();
    void forgetMotions();
    void crossApplies();
    void forgetWhatIsGone();

    /// How a filter is told of the motions.
    struct Call {
        std::string transforms; ///< as "Motions as text" takes them
        double pose;            ///< percent
        bool isExact;           ///< it makes what is shown to the bit
    };
    std::string filterCall(const std::string &script, const Call &call, bool graphLayers) const;
    std::string sequenceCall(bool hasTable) const;
    std::optional<std::size_t> poseOfFilter() const;
    Call callOfPose() const;
    std::string blendCall() const;
    std::string callInPlace() const;
    std::string callToNewLayer(bool graphLayers) const;

    MeshDocument &document;
    MeshModel &layer;
    RestGuard rest;
    BendReach reach;
    BendModel data;

    /// What was applied.
    struct Applied {
        BendState state;
        BendOptions options;
        std::uint64_t rest; ///< shape, as shapeOf tells it
    };

    History<BendState> history{32};        // each may hold tags of its own
    std::vector<Applied> applied;          ///< also what has been undone
    std::size_t applies = 0;               ///< that led to the present rest shape
    std::shared_ptr<const ToolState> kept; ///< what the layer keeps of all this, since that was known last
    std::vector<BendOptions> optionsOf{1}; ///< by loads: what the options were when that was left
    std::size_t loads = 0;                 ///< that led to the present options
    std::shared_ptr<BendTags> marking;     ///< the marks, while they change
    std::vector<std::size_t> marked;       ///< where, then

    std::shared_ptr<const vcg::fcd::SurfaceArrays> surface; ///< at rest, once it has been read
    std::uint64_t facesOfSurface = 0;                       ///< facesOf the mesh then
    vcg::fcd::SurfaceContact contactOfPose;

    /// What is done beside the window has in the place of the layer, and of the document.
    struct Beside {
        std::vector<Point3m> position;            ///< as the layer shows them; empty: it is at rest
        std::map<std::string, std::string> poses; ///< motions of the named poses: the same without names of layers
        bool arePosesNew = false;                 ///< the layer has not got them yet
    };
    std::unique_ptr<Beside> besides; ///< between beginBeside() and endBeside()

    PoseSolver solver;
    bool isMarkedHere = false; ///< the layer has marks, not other tags
    bool isLeft = false;       ///< the layer has what leave() gave it
    bool isFresh = false;      ///< prepared since a pose was written: what others have moved, this one may not move
};

#endif
