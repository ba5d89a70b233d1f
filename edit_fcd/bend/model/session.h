// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_BEND_SESSION_H
#define FCD_BEND_SESSION_H

#include "edit_fcd/bend/model/named_poses.h" // these before Qt
#include "edit_fcd/bend/model/model.h"
#include "edit_fcd/kit/history.h"
#include "edit_fcd/shape/layer_shape.h"

#include <vcg_ext/sequence/surface_look.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

struct AnimationExport;
struct ExportedAnimation;
struct ToolState;

/// The filters' parameters for the panel's options.
vcg::fcd::DeformationParam deformationOf(const BendOptions &options);

/// A stroke along a limb, from its joint towards its end; slots of vertices.
struct BendStroke {
    std::size_t from, to;
    Eigen::Vector3d through; ///< the middle of the body at its begin, as seen; the pivot if it is on no limb; world
};

/// A layer while it is bent: rest shape, BendModel, and the deformer for it. It knows neither mouse nor screen.
///
/// The layer shows the pose; its tags are the marks, and colours, quality and textures are unchanged. leave() gives it
/// the exact pose that a filter makes. The session continues when the tool comes back. Motions and places are in world
/// units, after the layer's matrix. (It has more than 25 functions: changes of marks, poses or shape change all.)
class BendSession {
  public:
    /// The present shape of \p layer becomes the rest shape, its tags the marks.
    /// \throw vcg::fcd::Error no vertices, or a matrix without an inverse
    BendSession(MeshDocument &document, MeshModel &layer);

    /// Whether the layer has as many vertices and faces as it had.
    bool fits() const { return rest.fits(); }
    /// Continues with what the layer keeps of an earlier session or a file: rest shape, handles, motions, line and
    /// options. \return whether it keeps any \throw vcg::fcd::Error they do not fit the layer; nothing has changed
    bool goOn();
    /// Takes over the undo history of another session of the layer, if that began from the same shape.
    void follow(BendSession &&before);

    /// Whether the layer has the shape and marks that it got here; if not, something else changed it.
    bool isUpToDate() const;
    /// The same for all that a filter may have changed while the tool was on another layer.
    bool isAsLeft() const;

    const BendModel &model() const { return data; }
    /// Change only motions, BendHandle data, line and options here; for all else there are functions below.
    BendModel &edit() { return data; }
    const BendState &state() const { return data.state; }
    const BendTags &tags() const { return *data.influence.tags; }
    const RestGuard &restShape() const { return rest; }
    double diagonal() const { return rest.diagonal(); }              ///< of the bounding box
    const BendTags *marksBeingMade() const { return marking.get(); } ///< null if nothing is being marked

    Eigen::Vector3d positionOf(std::size_t slot) const; ///< in the pose
    /// The free or held vertex nearest to \p place in the pose, and how far it is. \return none in an empty layer
    std::optional<std::size_t> nearest(const Eigen::Vector3d &place, double &distance) const;

    /// Begins to read the surface for handles, in the background. \return whether it is read
    bool readAhead() { return reach.begin(); }
    /// The faces of each vertex, null while the surface is being read.
    const VertexFaces *faces() { return reach.faces(); }
    /// A preview of the extent of a new handle at a vertex, or of a handle, on the coarse surface. Null while the
    /// surface is being read. \param usual as in addPoint()
    std::shared_ptr<const BendExtent> glimpse(std::size_t slot, double usual);
    std::shared_ptr<const BendExtent> glimpseOf(int tag);
    /// The same for what symmetry adds; null: nothing. \param tag of a handle, or 0: a new one \param own its extent
    std::shared_ptr<const BendExtent> glimpseTwin(int tag, const BendExtent &own);
    /// The same for the limb that limbAt() would turn, at a vertex or a handle. \return also its handle, 0: a new one
    std::pair<int, std::shared_ptr<const BendExtent>> glimpseLimb(int tag, std::optional<std::size_t> slot,
                                                                  double usual);
    /// The same for what strokeAt() would turn, with its present pivot, world.
    struct Turned {
        int tag = 0;                              ///< 0: a new handle
        std::shared_ptr<const BendExtent> extent; ///< null: nothing would turn
        Eigen::Vector3d pivot = Eigen::Vector3d::Zero();
    };
    Turned glimpseStroke(const BendStroke &stroke, double usual);
    /// The present position of a point at rest that moves with a vertex; world.
    Eigen::Vector3d seenAt(const Eigen::Vector3d &place, std::size_t slot) const;
    /// From now to endBeside(), addPoint(), makeGrip(), prepare() and beginAnimation() neither read nor change the
    /// layer and its document. So they may run in the background, while the layer can be shown, saved or deleted.
    void beginBeside();
    /// Applies to the layer what was done meanwhile. \pre the layer is there
    void endBeside();

    // --- changes; each begins with change(), which undo() takes back ---

    void change() {
        marking.reset(); // of a stroke that was cancelled
        marked.clear();
        history.begin(data.state);
    }
    void undo();
    void redo();
    /// Takes back all since the last change(), without a redo.
    void cancel();

    /// Marks vertices; endMarks() gives the layer these marks.
    void mark(const std::vector<std::size_t> &vertices, int tag);
    /// \param rim radius of the new marks, world units
    void endMarks(double rim);
    void clearMarks();
    /// Adds a handle around a vertex (for one of a tiny part, around BendReach::carrierOf()), where it is now.
    /// \pre canBecomePoint(); the layer has the pose at 100 % \param usual radius if it is on no limb, world units
    /// \return its tag
    int addPoint(std::size_t slot, double usual);
    /// Makes a point a grip, which can turn and scale. It holds all vertices that follow it, where they are now, and
    /// turns about its joint or its vertex. \pre the layer has the pose at 100 %
    void makeGrip(int tag);
    /// The handle that turns the limb of a vertex: the nearest turned one towards the body, or else a new one.
    /// \param nearer as in BendReach::rootOfLimb() \pre as addPoint() \return its tag, 0: there is no limb
    int limbAt(std::size_t slot, double usual, int nearer);
    /// The handle that turns the limb beyond the begin of a stroke, about the middle of the limb there: one that holds
    /// that place already, or else a new one. \pre, usual as addPoint() \return its tag \throw vcg::fcd::Error the
    /// stroke leads along no limb, or to fixed vertices
    int strokeAt(const BendStroke &stroke, double usual);
    /// Sets the radius within which handle and twin bend if nothing is fixed, world units; clamped to the panel's.
    void setRadius(int tag, double radius);
    /// Sets the radius for a vertex that is marked as fixed, and for fixed vertices connected with it.
    void setRimAt(std::size_t slot, double radius);
    void removeHandle(int tag); ///< its vertices are free
    /// Resets all motions. Ranks are reset, too, unless there are named poses, which may rely on them.
    void reset();

    // --- named poses, which the layer keeps for FCD: Pose Sequence (session_poses.cpp) ---

    /// Takes poses that the layer got elsewhere. \return whether they are of this surface
    bool takePoses();
    /// Sets the poses, also of the layer. \throw vcg::fcd::Error they make no sense
    void setPoses(vcg::fcd::PoseSequence poses);
    /// Makes a pose of the motions, and shows it alone.
    /// \return the filter call that makes it \throw vcg::fcd::Error there are no motions
    std::string keepPose();
    /// Replaces pose \p other by pose \p number, which gets its name.
    void replacePose(std::size_t other, std::size_t number);
    void removePose(std::size_t number);
    /// Sets the motions to a blend of the poses. \throw vcg::fcd::Error a pose moves a handle that does not exist
    void blend(const std::vector<double> &weights);
    /// Replaces all poses by those of a file. \throw vcg::fcd::Error as readPoses
    void loadPoses(const QString &file);
    /// Begins to show the animation, until something else is posed. It is no change. \return its length, seconds
    /// \throw vcg::fcd::Error there is none; as blend() and prepare()
    double beginAnimation(const vcg::fcd::Progress &progress);
    /// \param time seconds since the begin
    void showAnimation(double time);
    void endAnimation() { solver.endBlends(); }

    /// All that the shapes of blends depend on: if it is equal, so are they.
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
    /// Computes these shapes; null if a pose moves a handle that is gone. \pre not in beginBeside() to endBeside()
    std::shared_ptr<BlendShapes> blendShapes();

    /// A snapshot of an animation for export.
    struct Animation {
        vcg::fcd::PoseSequence poses; ///< their motions name no layer
        std::vector<vcg::fcd::KeyFrame> key;
        std::string name; ///< of the layer
        vcg::fcd::SurfaceLook look;
        std::vector<std::string> remarks; ///< on the look
    };
    /// Without look and remarks. \throw vcg::fcd::Error there is none in that range
    Animation animation(const AnimationExport &how);
    /// Adds look and remarks.
    void readLook(Animation &animation) const;
    /// Makes frames as FCD: Pose Sequence does; may run in the background. Afterwards, save the files, and addLayers().
    /// \throw vcg::fcd::Error as blend(), prepare() and WriteFrames; or the file cannot be written
    void exportAnimation(const Animation &animation, const AnimationExport &how, ExportedAnimation &made,
                         const vcg::fcd::Progress &progress);
    /// Adds a hidden layer for each frame, all or none, and frees the frames. The layer is at rest then, and current.
    void addLayers(ExportedAnimation &made, const Remark &remark);
    /// The filter call that makes the same.
    std::string exportCall(const Animation &animation, const AnimationExport &how) const;

    // --- the pose ---

    /// Milliseconds.
    struct Times {
        double prepare = 0, solve = 0, write = 0;
    };

    /// Solves the pose, and writes it to the layer's positions and normals. \param full from rest to the end, as the
    /// filters do, with normals of faces and the bounding box; false: some steps from the last pose \param faces
    /// normals of faces in any case \throw vcg::fcd::Error
    Times pose(bool full, bool faces = false);
    /// Prepares the deformer, if needed; the layer keeps its shape. \throw vcg::fcd::Error \throw vcg::fcd::Cancelled
    /// \return milliseconds
    double prepare(const vcg::fcd::Progress &progress = {});
    int nodes() const { return solver.prepared() ? int(solver.prepared()->deformer->Nodes()) : 0; }
    /// Restores the rest shape, to the bit.
    void restore();
    /// Finds contact in layers with at most vcg::fcd::contactUnasked faces; takes as long as several steps of a drag.
    /// \pre the last pose was a full one
    void findContact();
    /// The contact of the last pose, if it was looked for.
    const vcg::fcd::SurfaceContact &contact() const { return contactOfPose; }

    /// Gives the layer the present pose as FCD: Pose in Place makes it. It stays a pose of the rest shape; the session
    /// continues if the layer isAsLeft(). \return the filter calls; empty: it has the pose already, or is at rest
    std::string leave(const Remark &remark);
    /// The same, and the pose becomes the rest shape.
    std::string applyInPlace(const Remark &remark);
    /// Resets the layer, and adds layers as FCD: Deform Mesh does; one becomes the current one. \return the filter call
    std::string applyToNewLayer(bool graphLayers, const Remark &remark);

  private:
    using Centers = std::map<vcg::fcd::Index, Eigen::Vector3d>;

    static std::shared_ptr<const BendTags> marksNow(const MeshModel &layer);
    void keepRest();
    double hair() const { return usualGap(rest.diagonal()); } ///< how near tiny parts are to what carries them
    void updateTags();
    void changeTags();
    void changeTagsOf(int tag);
    void keepPlace(int tag);
    std::vector<vcg::fcd::MotionStep> stepsSeen(int tag) const;
    int turnedLimb(std::size_t slot) const;
    std::optional<std::size_t> newLimb(std::size_t slot, double usual, int nearer);
    std::pair<int, std::optional<std::size_t>> limbOf(std::size_t slot, double usual, int nearer);
    std::shared_ptr<const BendExtent> glimpseAt(std::size_t slot, double usual);
    int addAt(std::size_t slot, double radius);
    Turned turnedBy(BendReach &from, const BendStroke &stroke, double usual) const;
    std::optional<std::size_t> twinSlot(std::size_t slot) const;
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
    void keepState();
    void writeAppliedTags();
    LayerDeformer applying(const Remark &remark);
    std::string poseByFilter(const Remark &remark);
    void beginAnew();
    void forgetMotions();
    void crossApplies();
    void forgetWhatIsGone();

    /// The motions for a filter call.
    struct Call {
        std::string transforms; ///< for "Motions as text"
        double pose;            ///< percent
        bool isExact;           ///< it makes the shown shape, to the bit
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

    /// The state before an apply in place.
    struct Applied {
        BendState state;
        BendOptions options;
        std::uint64_t rest; ///< shapeOf its rest shape
    };

    History<BendState> history{32};        // each state may have its own tags
    std::vector<Applied> applied;          ///< also undone ones
    std::size_t applies = 0;               ///< number of those that led to the present rest shape
    std::shared_ptr<const ToolState> kept; ///< what the layer keeps of this session
    std::vector<BendOptions> optionsOf{1}; ///< by number of loads: the last options there
    std::size_t loads = 0;                 ///< number of loads that led to the present options
    std::shared_ptr<BendTags> marking;     ///< the marks during a stroke
    std::vector<std::size_t> marked;       ///< vertices of the stroke

    std::shared_ptr<const vcg::fcd::SurfaceArrays> surface; ///< at rest; null until it is read
    std::uint64_t facesOfSurface = 0;                       ///< facesOf() the mesh when it was read
    vcg::fcd::SurfaceContact contactOfPose;

    /// Copies that work in the background uses instead of the layer and the document.
    struct Beside {
        std::vector<Point3m> position;            ///< of the layer; empty: at rest
        std::map<std::string, std::string> poses; ///< motions of the named poses, to the same without names of layers
        bool arePosesNew = false;                 ///< the layer does not have them yet
    };
    std::unique_ptr<Beside> besides; ///< between beginBeside() and endBeside()

    PoseSolver solver;
    bool isMarkedHere = false; ///< the layer's tags are the marks
    bool isLeft = false;       ///< the layer has the shape of leave()
    bool isFresh = false; ///< prepared since the last pose was written: vertices that were moved may have to be reset
};

#endif
