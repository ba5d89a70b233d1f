// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_fcd.h"
#include "filter_parameters.h"

#include <iterator>

// The filters: names, parameters, what they change, and help texts.

namespace {

const char *const reference = "<br>Method: A. Morsucci, M. Centin, A. Signoroni, <i>Fast centroidal deformation for "
                              "large mesh models</i>, STAG 2018 "
                              "(<a href='https://doi.org/10.2312/stag.20181302'>doi:10.2312/stag.20181302</a>)";

// MM_VERTNUMBER switches off a preview that writes files, or cannot be undone (the host does not restore attributes).
const int shape = MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL,
          tags = MeshModel::MM_VERTQUALITY | MeshModel::MM_VERTCOLOR;

// Flags of a filter: its help names the reference; the host loads the new layer's textures (by the class Texture).
const int ofMethod = 1, textured = 2;

struct Described {
    const char *inWindow, *inScripts; ///< names
    RichParameterList (*parameters)(const MeshDocument &);
    int changes; ///< as HostFilterPlugin::changes
    int flags;
    const char *help;
};

RichParameterList noParameters(const MeshDocument &) { return RichParameterList(); }

const Described described[] = {
    // in the order of FilterFcd::Filter
    {"FCD: Build Deformation Graph", "generate_fcd_deformation_graph", parametersOf<BuildGraphParam>,
     MeshModel::MM_NONE, ofMethod,
     "Shows the <b>deformation graph</b> of a layer: the surface in a few hundred round patches, with a node at the "
     "centre of each. 'FCD: Deform Mesh' builds such a graph by itself; here you can look at it, or build one to use "
     "several times.<br>Works on any mesh and on point clouds. The current layer is not changed. One new layer is the "
     "graph: a vertex for each patch, its radius as quality, and edges between neighbours. Another one, on request, is "
     "the mesh coloured by patch."},
    {"FCD: Deform Mesh", "generate_fcd_deformed_mesh", parametersOf<DeformMeshParam>, MeshModel::MM_NONE,
     textured | ofMethod,
     "Bends a mesh of any size smoothly, with all its detail. Say what <b>stays</b> fixed and which "
     "<b>handles</b> move: run 'FCD: Tag' on each, or select the vertices of the handle "
     "and the faces that stay. Then say how the handles move. The rest follows; fixed vertices stay "
     "to the bit. Any scan will do (unwelded, non-manifold, in pieces), and any point cloud. The "
     "result is a new layer with all that the mesh carries. Motions are in world coordinates. Pose, "
     "warp or bend a mesh; as rigid as possible (ARAP)."},
    {"FCD: Fit to Layer", "generate_fcd_fitted_mesh", parametersOf<FitMeshParam>, MeshModel::MM_NONE,
     textured | ofMethod,
     "Lays the current layer onto another one, with pairs of <b>landmarks</b> or without. The surface bends, as "
     "rigidly as possible, until it lies on the target: a template on a scan, last year's scan on this year's, a "
     "decimated model on the full cloud. Parts without a counterpart on the target go along.<br>The layers should lie "
     "roughly on each other; if not, 'Start' moves the current one there. Their matrices count. You need no tags; "
     "tagged vertices stay, to the bit, or move as you say. Any scan or point cloud will do, as source and as "
     "target.<br>The result is a new layer with all that the source carries. Non-rigid registration (ICP), template "
     "fitting, shrink wrap, morph; as rigid as possible (ARAP)."},
    {"FCD: Straighten Mesh", "generate_fcd_straightened_mesh", parametersOf<StraightenMeshParam>, MeshModel::MM_NONE,
     textured | ofMethod,
     "Straightens the current layer along a <b>line</b>, or bends it: fish, bones, roots, pipes, prints. Each "
     "cross-section keeps its shape and goes to its place on a straight line, an arc, or the line of another "
     "layer.<br>The line is a layer with edges, picked points in their order, or a list of points, in world "
     "coordinates. A smooth curve leads through its points. It should run through the middle of the surface: the line "
     "keeps its length, the inner side of a bend gets longer, and the outer side shorter. Where cross-sections would "
     "meet, the surface follows as rigidly as possible instead; the log says where.<br>The result is a new layer with "
     "all that the layer carries. Straighten, unbend, unroll, bend along a curve."},
    {"FCD: Symmetrize", "generate_fcd_symmetrized_mesh", parametersOf<SymmetrizeParam>, MeshModel::MM_NONE,
     textured | ofMethod,
     "Restores the symmetry of a layer that was <b>sheared, bent or pressed</b>: fits the layer onto its own mirror "
     "image, and goes half of the way (retrodeformation). Rotations go half of their angle, so bent parts keep their "
     "length.<br>The filter finds the plane of symmetry, or takes it from landmarks, or from you. Parts without a "
     "counterpart on the other side go along; their mirror image can fill what is missing. The log says how asymmetric "
     "the layer was; the quality of the result says where.<br>The result is a new layer with all that the layer "
     "carries."},
    {"FCD: Compensate", "generate_fcd_compensated_mesh", parametersOf<CompensateLayerParam>, MeshModel::MM_NONE,
     textured,
     "Tells <b>what to print</b> so that the current layer, the nominal part, comes out. A scan of the printed "
     "(sintered, pressed) part tells its warp. The filter turns the warp round.<br>The scan is a mesh or a point "
     "cloud, in the same units, rigidly aligned with the nominal part. The warp is smooth and moves all of space. So "
     "flat faces, round holes and sharp edges stay what they are, noise does not come through, and vertices need not "
     "be welded. Parts that were not scanned go along. The next print has to warp as this one did.<br>The result is a "
     "new layer with all that the layer carries."},
    {"FCD: Pose Sequence", "generate_fcd_pose_sequence", parametersOf<SequenceParam>, MeshModel::MM_NONE,
     textured | ofMethod,
     "Makes an animation of the current layer, or a row of its poses. Each pose has a name and says "
     "how the handles move. <b>Key frames</b> say how much of each pose there is at which time. "
     "Poses are blended: the turns, moves and scalings of a handle add up.<br>The poses come from a "
     "table in a file, or are those that the layer keeps. The results are new layers, an animation "
     "(glTF with morph targets, colours and textures) or a point cache (PC2, MDD). The current layer is "
     "not changed. Animate, keyframes, blend shapes, shape keys, ARAP."},
    {"FCD: Pose in Place", "apply_coord_fcd_deformation", parametersOf<PoseParam>, shape, ofMethod,
     "Bends the current layer itself, as 'FCD: Deform Mesh' bends a copy of it. Tick <i>Preview</i>, and the shape "
     "follows while you change a value. The first pose prepares the layer, which takes a moment; later ones take a "
     "fraction of that, even after you close the dialog and open it again.<br>Every pose begins at the <b>rest "
     "shape</b>: the shape before the first pose, or the one that you applied or kept last. So poses do not add up, "
     "and at 0 percent you see the rest shape. 'FCD: Reset Pose' brings it back. Changes positions and normals, "
     "nothing else. Motions are in world coordinates. Warp, bend, deform with preview; ARAP."},
    {"FCD: Reset Pose", "apply_coord_fcd_reset", parametersOf<ResetPoseParam>, shape | MeshModel::MM_VERTNUMBER, 0,
     "Brings back, to the bit, the shape that the current layer had before its last pose, or before its first. Poses "
     "are those of 'FCD: Pose in Place' and the tool 'FCD: Bend'. Or keeps the present shape, so that later poses "
     "begin there.<br>If something else has moved the whole layer since (turned it, scaled it, frozen its matrix), the "
     "old shape moves with it. If something else has moved some vertices, or made new ones, this is an error and "
     "nothing changes."},
    {"FCD: Apply Deformation to Layer", "generate_fcd_deformed_copy", parametersOf<CopyParam>, MeshModel::MM_NONE,
     textured | ofMethod,
     "Deforms the current layer as 'FCD: Deform Mesh' has deformed another one in the same space, the source. Deform a "
     "decimated copy, then the full scan with it; or a point cloud, landmarks, a textured version. Each vertex follows "
     "the nearest place of the source's surface. It stays, to the bit, if that place is fixed.<br>The deformation is "
     "in the two graph layers of this session, or in a file of 'FCD: Save Deformation'.<br>The result is a new layer "
     "with everything that the layer carries."},
    {"FCD: Save Deformation", "save_fcd_deformation", parametersOf<SaveDeformationParam>, MeshModel::MM_NONE, ofMethod,
     "Writes a deformation to one small file, for 'FCD: Apply Deformation to Layer' in another session, or for points "
     "outside of MeshLab.<br>The file holds some thousand vertices of the source, how they move, and the triangles "
     "between them, in world coordinates. It has enough of them to be off by at most 'Accuracy' at every vertex of the "
     "source (a million at most). Fixed vertices stay, to the bit. Log and file say how far a vertex is off at most. "
     "It is a binary PLY file: any program shows the thinned surface.<br>The layers are not changed."},
    {"FCD: Tag", "compute_fcd_tags", parametersOf<TagParam>, tags | MeshModel::MM_VERTNUMBER, 0,
     "Says what the selected part of the mesh does when the layer is deformed. It stays <b>fixed</b>, "
     "follows (<b>free</b>), moves as you say (<b>handle</b>), or lies <b>outside</b> the region of "
     "influence.<br>Select what stays and run this filter as <i>Fixed</i>. Select what moves and run it as "
     "<i>Handle</i>. Then run 'FCD: Deform Mesh'. Selected vertices and the vertices of selected faces "
     "count. All else keeps its tag; without tags (no quality, or 0 everywhere) all else is free.<br>It also "
     "reads all tags from a file, and writes tags and motions. 'FCD: Deform Mesh' reads these files with "
     "<i>Handles from: Files</i>.<br>Changes the quality, or an attribute, of the current layer and its "
     "colours, nothing else."},
    {"FCD: Clear Tags", "clear_fcd_tags", noParameters, tags | MeshModel::MM_VERTNUMBER, 0,
     "Brings back the colours and the quality that the current layer had before it was tagged. A layer without colours "
     "or quality is without them again. New vertices get those at their place, as long as the layer is not posed. "
     "Vertices that were painted since, or whose old place is unknown, keep theirs; the log counts them."},
    {"FCD: Save Session", "save_fcd_session", parametersOf<SaveSessionParam>, MeshModel::MM_NONE, 0,
     "Writes what no mesh file keeps of the current layer, so that you go on another day: marks, colours and quality "
     "under the tags, rest shapes, poses and key frames; handles, motions and line of the tool 'FCD: Bend'; pairs, "
     "options and fit of 'FCD: Fit'. Save the layer itself, too. The filter does not change it."},
    {"FCD: Load Session", "load_fcd_session", parametersOf<LoadSessionParam>,
     shape | tags | MeshModel::MM_VERTNUMBER | MeshModel::MM_TRANSFMATRIX, 0,
     "Reads a file of 'FCD: Save Session' for the same layer. The layer has to be in the shape that it was saved in, "
     "or in its rest shape. Filters and tools then go on where they were. Vertices with newer colours or quality keep "
     "these.<br>Changes positions, normals, colours, quality and matrix where they differ, nothing else."},
    {"FCD: Tag Selection", "compute_fcd_tags_from_selection", parametersOf<TagSelectionParam>, tags, 0,
     "For older scripts: what 'FCD: Tag' does with the selection."},
    {"FCD: Tags from Files", "compute_fcd_tags_from_files", parametersOf<TagsFromFilesParam>, tags, 0,
     "For older scripts: what 'FCD: Tag' does with a .sel file."},
    {"FCD: Save Tags", "save_fcd_tags", parametersOf<SaveTagsParam>, MeshModel::MM_NONE, 0,
     "For older scripts: writes the tags to a .sel file and, on request, the motions of the handles to a "
     ".def file, as 'FCD: Tag' does. The layer is not changed."},
};
static_assert(std::size(described) == FilterFcd::SaveTags + 1);

const Described &textsOf(int id) { return described[std::size_t(id)]; }

} // namespace

QString FilterFcd::filterName(int id) const { return textsOf(id).inWindow; }

QString FilterFcd::scriptName(int id) const { return textsOf(id).inScripts; }

int FilterFcd::changes(int id) const { return textsOf(id).changes; }

HostFilterPlugin::FilterClass FilterFcd::menus(int id) const {
    const int both = int(Smoothing) | int(Texture);
    // NOLINTNEXTLINE(clang-analyzer-optin.core.EnumCastOutOfRange): the host takes it as bits
    return (textsOf(id).flags & textured) != 0 ? FilterClass(both) : Smoothing;
}

RichParameterList FilterFcd::defaults(int id, const MeshDocument &document) { return textsOf(id).parameters(document); }

QString FilterFcd::filterInfo(int id) const {
    return (id == DeformMesh ? shown() : QString()) + textsOf(id).help +
           ((textsOf(id).flags & ofMethod) != 0 ? reference : "");
}
