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

/// A vertex of a posed layer; zero for a vertex that something else made.
struct PosedVertex {
    Eigen::Vector3d place() const { return Eigen::Vector3d(double(now[0]), double(now[1]), double(now[2])); }
    bool isKnown() const { return before != 0; }
    bool isAt(const Point3m &p) const { return p[0] == now[0] && p[1] == now[1] && p[2] == now[2]; }

    std::array<Scalarm, 3> now; ///< the position that the last pose gave it
    std::uint64_t before;       ///< RestShape::placeOf() before the last pose, where a preview begins; 0: unknown
};

/// A shape of a layer: positions and normals per vertex slot.
struct Shape {
    std::vector<Point3m> position, normal;
};

/// The rest shape of a layer that is posed in place (rest_shape.h).
struct RestState : Shape {
    std::vector<PosedVertex> vertex;          ///< per vertex slot
    std::uint64_t faces = 0;                  ///< facesOf the mesh
    std::size_t vertexSlots = 0;              ///< of the mesh
    Matrix44m matrix = Matrix44m::Identity(); ///< of the layer when a filter last looked
    bool ownNormals = false;                  ///< as in hasOwnNormals
    std::uint64_t normalsNow = 0;             ///< normalsOf the mesh after the last pose, if it has own normals
    std::uint64_t normalsBefore = 0;          ///< and before it, where a preview begins
    std::vector<Shape> earlier;               ///< earlier rest shapes, oldest first: that of the file
};

/// A vertex that was live when its layer was tagged.
struct TaggedVertex {
    static constexpr int noTag = std::numeric_limits<int>::min();
    bool hasQuality() const { return tag != noTag; } ///< its quality is its tag

    Point3m place;          ///< its position then
    std::uint32_t tagColor; ///< the colour of its tag, as in numberOf
    int tag;                ///< its quality since then; noTag: its quality is its own
    bool hasColor;          ///< it has the colour of its tag
};

/// Colours and quality of a layer before tags replaced them. The positions of the vertices then are kept, too, so that
/// new vertices on that surface get colours and quality (kept_aside.h).
struct KeptScan {
    bool color = false, quality = false;       ///< tags replaced them: they are kept, or there were none
    bool hadColor = false, hadQuality = false; ///< there were some
    bool countedQuality = false;               ///< the layer was marked as having quality, even if it was 0 everywhere
    vcg::Color4b lowColor, highColor;          ///< range of the tags' colours, by channel
    double lowTag = 0, highTag = 0;            ///< range of the tags and 0, the quality of new vertices
    std::uint64_t faces = 0;                   ///< facesOf the mesh then
    std::size_t vertexSlots = 0;               ///< of the mesh then
    Matrix44m matrix;                          ///< of the layer then
    std::vector<TaggedVertex> vertices;
    std::vector<vcg::Color4b> colors;             ///< of each tagged vertex; empty unless color
    std::vector<CVertexO::QualityType> qualities; ///< of each tagged vertex; empty unless quality
    std::vector<std::uint32_t> number;            ///< per vertex slot: number of the tagged vertex, from 1; 0: new
    std::vector<std::pair<Point3m, std::uint32_t>> gone; ///< deleted ones: position in the last pose, and number
};

/// The settings of FCD: Bend when it left a layer (kept_tool.h).
struct ToolState {
    std::string text;        ///< as in bend_state.h
    bool isPosed;            ///< the tool left the layer in a pose of its rest shape
    std::uint64_t shape = 0; ///< shapeOf the layer then
    Matrix44m matrix;        ///< of the layer then
};

/// A pair of landmarks of the tool FCD: Fit, of which one end may still be missing.
struct FitPair {
    std::string name;
    std::optional<std::size_t> slot;      ///< of a vertex of the layer that is fitted
    std::optional<Eigen::Vector3d> place; ///< on the target, world units
    /// From the vertex to the landmark at rest, layer units; not 0 only for places that were read from a file.
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();

    bool isWhole() const { return slot && place; }
    bool operator==(const FitPair &o) const {
        return name == o.name && slot == o.slot && place == o.place && offset == o.offset;
    }
};

/// The shape of a layer that is fitted: at rest, by its landmarks, or pulled onto the target.
enum class FitShape { Rest, Landmarks, Pulled };

/// The options of the panel of FCD: Fit.
struct FitOptions {
    static constexpr double leastStiffness = 0.01, mostStiffness = 100; ///< of the slider
    static constexpr double mostDistance = 1e9;

    double stiffness = 1;
    vcg::fcd::FitStart start = vcg::fcd::FitStart::Similar; ///< by landmarks only if these determine a motion
    double largestDistance = 0;                             ///< world units; 0: no limit
    /// Weights of the layer's and the target's vertices in a pull; of attributes, only FitMeshParam::paintedAttribute.
    FitMeshParam::Weights weights = FitMeshParam::AllCounts, targetWeights = FitMeshParam::AllCounts;

    bool operator==(const FitOptions &o) const {
        return stiffness == o.stiffness && start == o.start && largestDistance == o.largestDistance &&
               weights == o.weights && targetWeights == o.targetWeights;
    }
};

/// Pairs, options and fit of a layer in the tool FCD: Fit.
struct FitToolState {
    std::vector<FitPair> pairs;
    FitOptions options;
    std::string target;                       ///< name of the layer that it is fitted to; empty: the first other one
    std::string curves;                       ///< file with curves, UTF-8; empty: none
    FitShape shown = FitShape::Rest;          ///< the shape that the tool left the layer in
    std::uint64_t shape = 0;                  ///< shapeOf the layer then; 0: at rest
    Matrix44m matrix = Matrix44m::Identity(); ///< of the layer then

    /// Whether anything is set besides the pairs and the shape.
    bool isSet() const { return !target.empty() || !curves.empty() || !(options == FitOptions()); }
    bool operator==(const FitToolState &o) const {
        return pairs == o.pairs && options == o.options && target == o.target && curves == o.curves &&
               shown == o.shown && shape == o.shape && matrix == o.matrix;
    }
};

/// A layer that is a result: its source, and its contents when it was made (new_layers.h).
struct ResultState {
    int source = 0;             ///< number of that layer
    std::uint64_t contents = 0; ///< as in contentsOf
    bool ownNormals = false;    ///< as in hasOwnNormals
    QString label;
};

/// A layer that is a deformation graph (kept_graph.h).
struct GraphState {
    int source = 0;          ///< number of the layer with the surface
    bool isDeformed = false; ///< false: it is at rest
    std::uint64_t shape = 0; ///< shapeOf the graph when it was made, as a copy has, too
};

/// The vertices of a layer when a filter here measured its quality, or gave it tags as its quality, by numbers for
/// their quality and place (measured_quality.h).
struct MeasuredState {
    bool areTags = false;              ///< the quality is tags, of the layer that this one is a result of
    std::vector<std::uint64_t> number; ///< per vertex slot; 0: a new vertex
    std::vector<std::uint64_t> gone;   ///< of vertices that were deleted since, as other filters move them to copies
};

/// What the plugins keep for a layer besides its mesh. The document owns it until layer or document are closed. By an
/// attribute of the mesh, without memory, the host tells where it moves vertices: values per vertex slot move along.
struct LayerState {
    std::optional<RestState> rest;         ///< none: it has never been posed in place
    std::optional<RestState> whole;        ///< rest before a deletion, until the next pose: it may have moved vertices
    std::optional<KeptScan> scan;          ///< none: no tags replace colours or quality
    std::vector<int> marks;                ///< tag - 1 per vertex slot; empty: none (kept_tool.h)
    std::optional<MeasuredState> measured; ///< none: no filter here has measured its quality
    std::string appliedName;               ///< of the attribute for the tool's tags; empty: none (kept_tool.h)
    std::optional<vcg::fcd::PoseSequence> poses;    ///< poses with names
    std::shared_ptr<const Deformation> deformation; ///< of a deformed graph
    std::shared_ptr<const ToolState> tool;          ///< null: FCD: Bend has marks and poses at most
    std::shared_ptr<const FitToolState> fit;        ///< null: FCD: Fit has nothing
    std::optional<GraphState> graph;                ///< none: no filter of this run has made it as a graph
    std::optional<ResultState> result;              ///< none: it is not a result of a filter in the window

    /// The state of a layer; null: none.
    static LayerState *of(const CMeshO &mesh);
    static LayerState *of(const MeshModel &layer) { return of(layer.cm); }
    /// The state of a layer, or an empty one.
    static const LayerState &known(const MeshModel &layer);
    /// The state of a layer, which is made if there is none.
    static LayerState &made(const MeshDocument &document, MeshModel &layer);
    /// Removes an empty state, with its attribute of the mesh.
    static void tidy(MeshModel &layer);
    /// The states of the other layers of a document.
    static std::vector<const LayerState *> ofOthers(const MeshDocument &document, const MeshModel &layer);

    /// Resizes the values per slot, with zero for new slots.
    void resize(std::size_t n);
    /// Moves the value of each slot to newSlots[slot]; drops it if that is the largest number of its type.
    void reorder(const std::vector<std::size_t> &newSlots);

  private:
    bool isEmpty() const;
    template <class IsGone>
    void leave(const IsGone &isGone);

    bool isCleared = false; ///< the mesh has no vertices now; values per slot are those of its former vertices
};

#endif
