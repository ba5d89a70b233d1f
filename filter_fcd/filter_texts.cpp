// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_fcd.h"

// What the filters are called, in the window and in scripts, and what they say of themselves.

namespace {

const char *const reference = "<br>Method: A. Morsucci, M. Centin, A. Signoroni, <i>Fast centroidal deformation for "
                              "large mesh models</i>, STAG 2018 "
                              "(<a href='https://doi.org/10.2312/stag.20181302'>doi:10.2312/stag.20181302</a>)";

} // namespace

QString FilterFcd::filterName(int id) const {
    switch (id) {
    case BuildGraph: return "FCD: Build Deformation Graph";
    case DeformMesh: return "FCD: Deform Mesh";
    case FitMesh: return "FCD: Fit to Layer";
    case StraightenMesh: return "FCD: Straighten Mesh";
    case Symmetrize: return "FCD: Symmetrize";
    case PoseSequence: return "FCD: Pose Sequence";
    case PoseInPlace: return "FCD: Pose in Place";
    case ResetPose: return "FCD: Reset Pose";
    case CopyDeformation: return "FCD: Apply Deformation to Layer";
    case SaveDeformation: return "FCD: Save Deformation";
    case TagSelection: return "FCD: Tag Selection";
    case TagsFromFiles: return "FCD: Tags from Files";
    case ClearTags: return "FCD: Clear Tags";
    case SaveTags: return "FCD: Save Tags";
    case SaveSession: return "FCD: Save Session";
    case LoadSession: return "FCD: Load Session";
    }
    return QString();
}

QString FilterFcd::scriptName(int id) const {
    switch (id) {
    case BuildGraph: return "generate_fcd_deformation_graph";
    case DeformMesh: return "generate_fcd_deformed_mesh";
    case FitMesh: return "generate_fcd_fitted_mesh";
    case StraightenMesh: return "generate_fcd_straightened_mesh";
    case Symmetrize: return "generate_fcd_symmetrized_mesh";
    case PoseSequence: return "generate_fcd_pose_sequence";
    case PoseInPlace: return "apply_coord_fcd_deformation";
    case ResetPose: return "apply_coord_fcd_reset";
    case CopyDeformation: return "generate_fcd_deformed_copy";
    case SaveDeformation: return "save_fcd_deformation";
    case TagSelection: return "compute_fcd_tags_from_selection";
    case TagsFromFiles: return "compute_fcd_tags_from_files";
    case ClearTags: return "clear_fcd_tags";
    case SaveTags: return "save_fcd_tags";
    case SaveSession: return "save_fcd_session";
    case LoadSession: return "load_fcd_session";
    }
    return QString();
}

QString FilterFcd::filterInfo(int id) const {
    switch (id) {
    case BuildGraph:
        return QString(
                   "Divides the surface into a few hundred round patches of similar size and connects the centres of "
                   "neighbouring patches: this is the <b>deformation graph</b> that 'FCD: Deform Mesh' bends in place "
                   "of "
                   "the mesh, which makes the time it takes to bend independent of the size of the mesh.<br>"
                   "'FCD: Deform Mesh' builds such a graph by itself; this filter is for looking at it, and for using "
                   "one "
                   "graph several times.<br>"
                   "Works on any mesh and on point clouds. The current layer is not changed. New layers: the graph (a "
                   "vertex per patch at its centre, quality = radius of the patch, in the colour of the patch, and an "
                   "edge "
                   "between neighbours) and, if wanted, the mesh coloured by patch.") +
               reference;
    case DeformMesh:
        return shown() +
               QString(
                   "Bends a mesh of any size smoothly, with all its detail. Mark what <b>stays</b> fixed and one or "
                   "more "
                   "<b>handles</b> (with 'FCD: Tag Selection', or select vertices of the handle and faces that stay), "
                   "say how the handles move, and the rest follows; fixed vertices stay to the bit. Works on scans as "
                   "they are (unwelded, non-manifold, in pieces) and on point clouds; the result is a new layer with "
                   "all that the mesh carries. Motions are in world coordinates. Pose, warp or bend a mesh; as rigid "
                   "as possible (ARAP).") +
               reference;
    case FitMesh:
        return QString(
                   "Lays the current layer onto another one: bends it, as rigidly as possible, until it lies on the "
                   "target. A template onto a scan, last year's scan onto this year's, a decimated model onto the full "
                   "cloud; with pairs of <b>landmarks</b> or without. What has no counterpart on the target is carried "
                   "along smoothly.<br>"
                   "The layers should lie roughly onto each other, or 'Start' moves the current one there; their "
                   "matrices count. Nothing has to be tagged; what is tagged as for 'FCD: Deform Mesh' stays, to the "
                   "bit, or moves as it is told. Works on scans as they are, and on point clouds, as source and as "
                   "target.<br>"
                   "The result is a new layer with all that the source carries. The layers with the graph serve 'FCD: "
                   "Apply Deformation to Layer' and 'FCD: Save Deformation'. Non-rigid registration (ICP), template "
                   "fitting, shrink wrap, morph; as rigid as possible (ARAP).") +
               reference;
    case StraightenMesh:
        return QString(
                   "Straightens the current layer along a <b>line</b>, or bends it: fish, bones, roots, pipes, prints, "
                   "to "
                   "measure and compare them. Each cross-section, at right angles to the line, goes as it is to its "
                   "place on a straight line, an arc, or the line of another layer, without a twist of its own.<br>"
                   "The line is a layer with edges, MeshLab's picked points in their order, or a list of points, in "
                   "world coordinates; a smooth curve leads through its points. It lies on the surface or, better, "
                   "runs "
                   "through the middle of it: its length is kept, what lies at the inner side of a bend gets longer, "
                   "and "
                   "what lies at the outer side shorter. Where cross-sections would meet and fold the surface, it "
                   "follows as rigidly as possible instead, and the log says where.<br>"
                   "The result is a new layer with all that the layer carries. The layers with the graph serve 'FCD: "
                   "Apply Deformation to Layer' and 'FCD: Save Deformation', which carry clouds and landmarks there, "
                   "and "
                   "back. Straighten, unbend, unroll, bend along a curve.") +
               reference;
    case Symmetrize:
        return QString(
                   "Restores the symmetry of what was <b>sheared, bent or pressed</b>: fits the current layer onto its "
                   "own mirror image, and goes half of the way (retrodeformation). Rotations go half of their angle, "
                   "so that what was bent keeps its length.<br>"
                   "The plane of symmetry is found by itself, or told by pairs of landmarks and points of the "
                   "midline, or given. What has no counterpart on the other side is carried along; its mirror image "
                   "may be added over what is missing. The log says how asymmetric it was, and the quality of the "
                   "result where.<br>"
                   "The result is a new layer with all that the layer carries.") +
               reference;
    case PoseSequence:
        return QString(
                   "Makes an animation of the current layer, or a row of its poses: each pose has a name and says how "
                   "the handles move, and <b>key frames</b> tell when there is how much of each. Poses are blended: "
                   "the turns, the ways and the scalings of a handle add up, each by its share, turns of half a turn "
                   "and more, too. Every frame is bent as 'FCD: Deform Mesh' bends, from the one before.<br>"
                   "The poses come from a table in a file, which any program for tables opens. The results are new "
                   "layers, an animation for other programs (glTF with morph targets) or a point cache (PC2). The "
                   "current layer is not changed. Animate, keyframes, blend shapes, shape keys, ARAP.") +
               reference;
    case PoseInPlace:
        return QString(
                   "Bends the current layer itself, as 'FCD: Deform Mesh' bends a copy of it: tick <i>Preview</i> and "
                   "see "
                   "the shape follow while you change a value. The first time the layer is prepared, which takes a "
                   "moment; each further pose takes a fraction of that, also when you come back to the dialog.<br>"
                   "A pose is always one of the <b>rest shape</b>, that which the layer had before its first pose, "
                   "or when one was applied or kept last: poses "
                   "do not add up, and pose 0 is the rest shape. 'FCD: Reset Pose' brings it back. Changes positions "
                   "and normals, "
                   "nothing else. All motions are in world coordinates. Warp, bend, deform with preview; ARAP.") +
               reference;
    case ResetPose:
        return "Brings a layer that 'FCD: Pose in Place' or the tool 'FCD: Bend' has bent back to the shape that it "
               "had "
               "before its last pose, or before its first, exactly; or keeps the shape that it has and lets later "
               "poses begin from that. Where something else has moved all of the layer alike since (turned it, scaled "
               "it, "
               "frozen its matrix), the shape that it goes back to is moved so, too. Where it has moved some vertices, "
               "or made new ones, going back is refused, and nothing is changed.";
    case CopyDeformation:
        return QString(
                   "Does to the current layer what 'FCD: Deform Mesh' did to another one in the same space: deform a "
                   "decimated copy, then the full scan with it; or a point cloud, landmarks, a textured version. Each "
                   "vertex follows the nearest place of the source's surface, and what is nearest to something fixed "
                   "stays, to the bit.<br>"
                   "What was done is told by the layers with the graph, in the session that made them, or by a file "
                   "of 'FCD: Save Deformation'.<br>"
                   "The layers are left as they are: the result is a new layer with everything that the layer "
                   "carries.") +
               reference;
    case SaveDeformation:
        return QString(
                   "Writes what 'FCD: Deform Mesh' did to a layer to one small file, for 'FCD: Apply Deformation to "
                   "Layer' in another session, or for points outside of MeshLab.<br>"
                   "The file holds the deformation at some thousand vertices of the source, and the triangles "
                   "between them, in world coordinates. Vertices are added until at none of the source's the file "
                   "differs from the deformation by more than a fiftieth of the largest motion and 0.01 percent of "
                   "the diagonal of what moves (or there are a million), and all that was fixed stays, to the bit; "
                   "log and file say how far any is off. It is a binary PLY file: "
                   "any program for meshes shows the "
                   "thinned surface.<br>"
                   "The layers are not changed.") +
               reference;
    case TagSelection:
        return "Says what 'FCD: Deform Mesh' does with the selected part of the mesh: it stays <b>fixed</b>, is "
               "<b>free</b> to follow, is a <b>handle</b> that moves as told, or lies <b>outside</b> the region of "
               "influence.<br>"
               "Select what stays, run this filter as <i>Fixed</i>; select what moves, run it as <i>Handle</i>; then "
               "deform. Selected vertices and the vertices of selected faces count. All else keeps its tag; where the "
               "layer has no tags yet (no quality, or 0 everywhere) all else is free.<br>"
               "Changes the quality, or an attribute, of the current layer and its colours, nothing else.";
    case TagsFromFiles:
        return "Gives the vertices of the current layer the tags of a .sel file, to look at them, to change them with "
               "'FCD: Tag Selection', or for 'FCD: Deform Mesh'.<br>"
               "Changes the quality, or an attribute, of the current layer and its colours, nothing else.";
    case ClearTags:
        return "Gives the current layer back the colours and the quality that it had before it was tagged by 'FCD: Tag "
               "Selection' or 'FCD: Tags from Files'. Where it had none, none is left. Vertices that something else "
               "has made since have what was at their place, as long as the layer is not posed; those that it has "
               "coloured "
               "keep what they have, and so do those of no known place; the log says how many.";
    case SaveTags:
        return "Writes the tags of the vertices to a .sel file and, if wanted, the motions of the handles to a .def "
               "file. 'FCD: Deform Mesh' with <i>Handles from: Files</i> then deforms as it would with the tags of "
               "the layer and these motions. The layer is not changed.";
    case SaveSession:
        return "Writes what is known of the current layer to a file, to go on another day: its marks, the colours and "
               "the quality that tags stand in the place of, its rest shape and those before it, its poses and key "
               "frames. No mesh file keeps these. Save the layer itself, too. The layer is not changed.";
    case LoadSession:
        return "Reads a session of 'FCD: Save Session' for the current layer, which must be the layer of then, opened "
               "from its file: in the shape that it was saved in, or in its rest shape, from which it is brought to "
               "the pose of then. What the filters and the tool knew of it, they know again. Vertices that have got "
               "other colours or another quality since keep them.<br>"
               "Changes positions, normals, colours and quality where they were others then, nothing else.";
    }
    return QString();
}
