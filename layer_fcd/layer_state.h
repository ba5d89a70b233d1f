// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_LAYER_STATE_H
#define FCD_LAYER_STATE_H

#include <vcg_ext/sequence/pose_sequence.h> // before Qt

#include "parameters.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

struct Deformation;

/// What the rest shape knows of a vertex; zero for a vertex that something else makes.
struct PosedVertex {
    Eigen::Vector3d place() const { return Eigen::Vector3d(double(now[0]), double(now[1]), double(now[2])); }
    bool isKnown() const { return before != 0; }
    bool isAt(const Point3m &p) const { return p[0] == now[0] && p[1] == now[1] && p[2] == now[2]; }

    std::array<Scalarm, 3> now; ///< the position that the last pose gave it
    std::uint64_t before; ///< the position before the last pose, as RestShape::placeOf encodes it, where a preview
                          ///< begins; 0: unknown
};

/// A shape of a layer: positions and normals per vertex slot.
struct Shape {
    std::vector<Point3m> position, normal;
};

/// The rest shape of a layer that is posed in place (rest_shape.h).
struct RestState : Shape {
    std::vector<PosedVertex> vertex; ///< per vertex slot
    std::uint64_t faces = 0;         ///< facesOf the mesh
    std::size_t vertexSlots = 0;     ///< of the mesh
    bool ownNormals = false;         ///< as hasOwnNormals tells it
    std::uint64_t normalsNow = 0;    ///< normalsOf the mesh after the last pose, where it has own ones
    std::uint64_t normalsBefore = 0; ///< and before that: a preview begins there
    std::vector<Shape> earlier;      ///< earlier rest shapes, oldest first: that of the file
};

/// A vertex that was live when its layer was tagged.
struct TaggedVertex {
    static constexpr int noTag = std::numeric_limits<int>::min();
    bool hasQuality() const { return tag != noTag; } ///< by its tag

    Point3m place;          ///< then
    std::uint32_t tagColor; ///< that it got by its tag, as numberOf tells it
    int tag;                ///< that its quality is since then; noTag: its quality is its own
    bool hasColor;          ///< by its tag
};

/// Colours and quality of a layer as they were before tags took their place, with the places that the vertices had
/// then: what is new since lies on that surface (kept_scan.h).
struct KeptScan {
    bool color = false, quality = false;       ///< kept, or known not to have been there
    bool hadColor = false, hadQuality = false; ///< and there was some
    bool countedQuality = false;               ///< the layer was marked as having quality, even if it was 0 everywhere
    vcg::Color4b lowColor, highColor;          ///< of the tags, by channel
    double lowTag = 0, highTag = 0;            ///< with 0, which vertices have that nothing has given a quality
    std::uint64_t faces = 0;                   ///< facesOf the mesh then
    std::size_t vertexSlots = 0;               ///< of the mesh then
    Matrix44m matrix;                          ///< of the layer then
    std::vector<TaggedVertex> vertices;
    std::vector<vcg::Color4b> colors;             ///< of each of these; empty unless color
    std::vector<CVertexO::QualityType> qualities; ///< of each of these; empty unless quality
    std::vector<std::uint32_t> number;            ///< per vertex slot: which of these it is, from 1; 0: a new one
    std::vector<std::pair<Point3m, std::uint32_t>> gone; ///< places in a pose, and numbers, of those that were deleted
};

/// What the tool FCD: Bend knew of a layer when it left it (kept_tool.h).
struct ToolState {
    std::string text;        ///< as the tool writes it; vertices are numbered as the live ones follow each other
    bool isPosed;            ///< the tool left the layer in a pose of its rest shape
    std::uint64_t shape = 0; ///< of the layer then, as shapeOf tells it
    Matrix44m matrix;        ///< of the layer then
};

/// A pair of landmarks of the tool FCD: Fit, of which one end may still be missing.
struct FitPair {
    std::string name;
    std::optional<std::size_t> slot;      ///< of a vertex of the layer that is fitted
    std::optional<Eigen::Vector3d> place; ///< on the target, world

    bool isWhole() const { return slot && place; }
    bool operator==(const FitPair &other) const {
        return name == other.name && slot == other.slot && place == other.place;
    }
};

/// What a layer that is fitted shows.
enum class FitShape { Rest, Landmarks, Pulled };

/// What the panel of the tool FCD: Fit sets.
struct FitOptions {
    static constexpr double leastStiffness = 0.01, mostStiffness = 100; ///< of the slider
    static constexpr double mostDistance = 1e9;

    double stiffness = 1;
    vcg::fcd::FitStart start = vcg::fcd::FitStart::Similar; ///< by landmarks only where these tell a motion
    double largestDistance = 0;                             ///< world units; 0: no limit
    /// How much the vertices count when the layer is pulled: those of the layer, and of the target; of attributes
    /// only FitMeshParam::paintedAttribute.
    FitMeshParam::Weights weights = FitMeshParam::AllCounts, targetWeights = FitMeshParam::AllCounts;

    bool operator==(const FitOptions &other) const {
        return stiffness == other.stiffness && start == other.start && largestDistance == other.largestDistance &&
               weights == other.weights && targetWeights == other.targetWeights;
    }
};

/// Pairs, options and fit of a layer in the tool FCD: Fit.
struct FitToolState {
    std::vector<FitPair> pairs;
    FitOptions options;
    std::string target;                       ///< name of the layer that it is fitted to; empty: the first other one
    std::string curves;                       ///< file with curves that lead it, UTF-8; empty: none
    FitShape shown = FitShape::Rest;          ///< by which the tool left the layer: a pose of its rest shape
    std::uint64_t shape = 0;                  ///< of the layer then, as shapeOf tells it; 0: at rest
    Matrix44m matrix = Matrix44m::Identity(); ///< of the layer then

    /// Besides the pairs and the shape.
    bool isSet() const { return !target.empty() || !curves.empty() || !(options == FitOptions()); }
    bool operator==(const FitToolState &other) const {
        return pairs == other.pairs && options == other.options && target == other.target && curves == other.curves &&
               shown == other.shown && shape == other.shape && matrix == other.matrix;
    }
};

/// What a layer was made from, and how it was then (results.h).
struct ResultState {
    int source = 0;             ///< number of that layer
    std::uint64_t contents = 0; ///< as contentsOf tells them
    bool ownNormals = false;    ///< as hasOwnNormals tells it
    QString label;
};

/// Of which layer's surface a layer is the deformation graph (kept_graph.h).
struct GraphState {
    int source = 0;          ///< number of that layer
    bool isDeformed = false; ///< and not at rest
    std::uint64_t shape = 0; ///< of the graph when it was made, as shapeOf tells it: a copy has it, too
};

/// What the plugins know of a layer beyond its mesh. The document keeps it until the layer or the document is closed.
/// The mesh has one attribute without memory: through it the host tells where it moves vertices, and the values per
/// vertex slot here move with them.
struct LayerState {
    std::optional<RestState> rest;                  ///< none: it has never been posed in place
    std::optional<KeptScan> scan;                   ///< none: no tags stand in the place of colours or quality
    std::vector<int> marks;                         ///< tag - 1 per vertex slot; empty: none (marks.h)
    std::uint64_t measured = 0;                     ///< qualityOf the mesh when a filter here measured it; 0: none did
    std::string appliedName;                        ///< of the attribute for the tool's tags; empty: none (marks.h)
    std::optional<vcg::fcd::PoseSequence> poses;    ///< that have names
    std::shared_ptr<const Deformation> deformation; ///< of a deformed graph
    std::shared_ptr<const ToolState> tool;          ///< null: FCD: Bend knows no more than marks and poses
    std::shared_ptr<const FitToolState> fit;        ///< null: FCD: Fit knows nothing
    std::optional<GraphState> graph;                ///< none: no filter has made it as a graph in this run
    std::optional<ResultState> result;              ///< none: it is no result of a filter in the window

    /// That of a layer, null where nothing is known of it.
    static LayerState *of(const CMeshO &mesh);
    static LayerState *of(const MeshModel &layer) { return of(layer.cm); }
    /// The same, to be read; where nothing is known of the layer, one that says so.
    static const LayerState &known(const MeshModel &layer);
    /// The same, made where there is none.
    static LayerState &made(const MeshDocument &document, MeshModel &layer);
    /// Removes a state that says nothing, with its attribute of the mesh.
    static void tidy(MeshModel &layer);
    /// Those of the other layers of a document.
    static std::vector<const LayerState *> ofOthers(const MeshDocument &document, const MeshModel &layer);

    /// Whether it is the attribute by which states follow their vertices.
    static bool isIts(const vcg::PointerToAttribute &attribute);

    /// Resizes the values per slot, with zero for new slots.
    void resize(std::size_t n);
    /// Moves the value of each slot to newSlots[slot]; drops it if that is the largest number.
    void reorder(const std::vector<std::size_t> &newSlots);

  private:
    bool isEmpty() const;
    void leave(std::size_t slot);

    bool isCleared = false; ///< the mesh has no vertices any more, and the values per slot are of those that it had
};

/// Calls LayerState::tidy for the current layer at the end, so that a filter that fails leaves nothing with it.
class TidyLater {
  public:
    explicit TidyLater(MeshDocument &document) : document(document), layer(document.mm() ? document.mm()->id() : -1) {}
    TidyLater(const TidyLater &) = delete;
    TidyLater &operator=(const TidyLater &) = delete;
    ~TidyLater() {
        if (MeshModel *its = document.getMesh(layer))
            LayerState::tidy(*its);
    }

  private:
    MeshDocument &document;
    const int layer;
};

#endif
