// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_parameters.h"

using host::Shown;
using vcg::fcd::Error;

void askTargetRadius(Fields &fields, vcg::fcd::GraphParam &graph, Shown shown) {
    fields.length("target_radius", graph.targetRadius, shown, "Patch radius",
                  "How far a patch reaches from its centre along the surface, in units of the layer. Larger patches "
                  "are split. <b>0</b> (the default): chosen from the number of patches and the area. <b>Raise it</b> "
                  "for fewer patches: faster and stiffer. <b>Lower it</b> for more: they follow tighter bends.");
}

void askInitialPatches(Fields &fields, vcg::fcd::GraphParam &graph, Shown shown) {
    fields.field(
        "initial_patches", graph.initialPatches, shown, "Initial patches",
        QString("Number of patches to start from, where the surface is free. Splitting adds to it. ") +
            (graph.initialPatches == 0
                 ? "<b>0</b> (the default): as many as the surface needs, whatever its number of vertices: some 300 "
                   "for most scans, 100 where little bends, up to 1500 where it is thin, folded or torn. "
                 : "A few hundred are enough for most scans, whatever their number of vertices. ") +
            "<b>Raise it</b> for finer bends; it takes longer.");
}

void askRandomSeed(Fields &fields, vcg::fcd::GraphParam &graph) {
    int seed = int(graph.randomSeed);
    fields.field("random_seed", seed, Shown::Advanced, "Random seed",
                 "Chooses where the first patches lie. The same seed gives exactly the same result; another one gives "
                 "another, equally good.");
    graph.randomSeed = unsigned(seed);
}

void askSmoothness(Fields &fields, double &smoothness, Shown shown) {
    fields.field(
        "smoothness", smoothness, shown, "Smoothness (0.001 loose, 0.1 stiff)",
        "How strongly neighbouring parts turn alike: 0.001 is loose, 0.1 is stiff. <b>Raise it</b> to spread bends and "
        "stiffen the surface. <b>Lower it</b> to keep lengths better; bends may then be sharp near handles.");
}

void askElasticity(Fields &fields, vcg::fcd::DeformationParam &deformation) {
    askSmoothness(fields, deformation.smoothness, Shown::Always);
    if (!host::scriptsMayLackParameters)
        return;
    fields.choice("falloff", deformation.falloff, Shown::Advanced, falloffText());
    fields.field("elastic", deformation.elastic, Shown::Advanced, elasticText());
    fields.field("rigidity", deformation.rigidity, Shown::Advanced, rigidityText());
}

void askBending(Fields &fields, vcg::fcd::DeformationParam &deformation, bool all) {
    using vcg::fcd::GraphWeights;
    using vcg::fcd::PatchMeasure;
    askElasticity(fields, deformation);
    fields.field("max_iterations", deformation.maxIterations, Shown::Advanced, "Maximum iterations",
                 "The most steps to the shape; fewer if it converges before. <b>Raise it</b> when the log says that it "
                 "did not converge. A converged result does not change.");
    fields.field("tolerance", deformation.tolerance, Shown::Advanced, "Tolerance",
                 "Converged means: no node is farther from its final place than ten times this fraction of the "
                 "bounding box diagonal, by estimate. <b>Raise it</b> to end sooner and less exactly.");
    int chosen = 0;
    fields.choice(
        "graph_weights", chosen, Shown::Advanced,
        {"Common border", "Uniform", "As in the paper", "The paper to the letter"}, "Graph weights",
        "For comparisons; leave it. How strongly neighbouring patches hold together. <i>Common border</i>: by the "
        "length of the border and the distance of the centres. The shape then hardly depends on where the patches lie. "
        "<i>Uniform</i>: all alike. <i>As in the paper</i>: all alike, and patches are balanced by number of vertices, "
        "not by area. <i>The paper to the letter</i>: everything else is as printed, too. Vertices follow the nodes "
        "whose patch would reach them (Eqs. 7 and 8). Held parts do not give way or blend. Iterations end at a step "
        "that moves no node by more than the tolerance. 'Distances' and 'Influence' do not count then.");
    deformation.graphWeights = chosen == 0   ? GraphWeights::Border
                               : chosen == 3 ? GraphWeights::Printed
                                             : GraphWeights::Uniform;
    deformation.graph.measure = chosen >= 2 ? PatchMeasure::Vertices : PatchMeasure::Area;
    fields.choice("weights", deformation.weights, Shown::Advanced, weightsText());
    fields.field("influence", deformation.influence, Shown::Advanced, "Influence",
                 "How far a node reaches, in radii of its patch. <b>Raise it</b> to blend over more nodes: smoother "
                 "and a little slower. Below 2 the patches begin to show.");
    fields.choice("loose_parts", deformation.looseParts, Shown::Advanced, {"Follow", "Stay"}, "Loose parts",
                  "Parts that are connected to no handle and nothing fixed <i>follow</i> the nearest connected part (a "
                  "button follows the sleeve), or <i>stay</i>.");
    if (all)
        fields.field("weld_distance", deformation.weldDistance, Shown::Advanced, "Weld distance",
                     "Vertices on open borders that are at most this far apart count as one, so a seam does not tear. "
                     "A fraction of the bounding box diagonal of the surface that bends. <b>Raise it</b> when the log "
                     "says that close borders are not joined. <b>0</b>: only vertices at the same place count as one.");
    fields.field("pose", deformation.pose, Shown::Always, "Pose (percent)",
                 "How far handles move, as a part of their motion: 0 is the mesh as it is, 100 the full motion. It may "
                 "exceed 100.");
    if (all)
        fields.field(
            "pose_steps", deformation.steps, Shown::Advanced, "Pose in steps",
            "The least number of steps to the pose, each from the shape before. A handle that turns takes at least one "
            "for each 60 degrees. <b>Raise it</b> (to 10, say) when the log says that the shape jumps on its way.");
    deformation.Validate();
}

void askGraphLayers(Fields &fields, bool &graphLayers) {
    fields.field(
        "graph_layers", graphLayers, Shown::Advanced, "Add graph layers",
        "Also adds the deformation graph, at rest and deformed, as two layers. 'FCD: Apply Deformation to Layer' and "
        "'FCD: Save Deformation' need them. Their attribute <i>energy</i> says where the deformation costs most.");
}

namespace {

void askTagAttribute(Fields &fields, HandleParam &handles) {
    fields.field("tag_attribute", handles.tagAttribute, Shown::Advanced, "Attribute with tags",
                 "Name of the scalar attribute per vertex that holds the tags. Only read when handles come from a "
                 "custom attribute.");
}

/// \param others the last sentence: what handles without a text do
void askMotionText(Fields &fields, HandleParam &handles, const QString &others, Shown shown = Shown::Always) {
    fields.field(
        "transforms", handles.transforms, shown, "Motions as text",
        "A motion for each handle, in world coordinates. For example <i>2: rotate 0 0 1 135 about 0 0 0 translate 0 0 "
        "5; 3: translate 1 0 0</i>: tag, colon, the steps in their order; a semicolon between handles. The steps "
        "are:<ul><li><i>translate x y z</i></li><li><i>rotate ax ay az degrees</i>: about the axis (ax, ay, az), "
        "counterclockwise when it points at you; any angle</li><li><i>scale s</i>, or <i>scale sx sy sz</i>: positive "
        "factors</li><li><i>matrix m11 m12 ... m44</i>: 16 numbers, row by row, the last row 0 0 0 1</li><li><i>layer "
        "'NAME'</i>: as the layer of that name lies to this one</li></ul><i>rotate</i> and <i>scale</i> may end in "
        "<i>about x y z</i>, the pivot. Without it, the pivot is the mean of the handle's vertices after the earlier "
        "steps. Case, line breaks and commas between numbers do not matter. " +
            others);
}

void askMotion(Fields &fields, HandleParam &handles, Shown shown = Shown::Always) {
    fields.position("translation", handles.translation, shown, "Translation",
                    "How far handles move along x, y and z, in world units. Applied last.");
    fields.direction("rotation_axis", handles.rotationAxis, shown, "Rotation axis",
                     "The axis that handles turn about. Only its direction counts.");
    fields.field("rotation_angle", handles.rotationAngle, shown, "Rotation angle (degrees)",
                 "How far handles turn, counterclockwise when the axis points at you. Applied before the translation. "
                 "Any angle: 190 degrees twist by 190, not by 170 the other way, and half of 270 (pose 50) is 135. If "
                 "the matrix rotates, too, handles take the shortest way.");
    fields.choice("rotation_center", handles.rotationCenter, shown,
                  {"Barycentre of the handle", "Origin", "Rotation point"}, "Rotation centre",
                  "The pivot that a handle turns about: the mean of its vertices (after the matrix), the origin of the "
                  "world, or the point below.");
    fields.position("rotation_point", handles.rotationPoint, Shown::Advanced, "Rotation point",
                    "The pivot, in world coordinates. Only read when the rotation centre is 'Rotation point'. It is in "
                    "single precision: at 600 000, in steps of 0.06. 'Motions as text' keeps all digits.");
    fields.matrix("TransformMatrix", handles.matrix, Shown::Advanced, "Matrix",
                  "A 4x4 affine matrix in world coordinates (last row 0 0 0 1). It moves handles before rotation and "
                  "translation. It may scale or shear.");
    fields.layer(
        handleLayer, handles.likeLayer, fields.document.mm(), Shown::Advanced, "Move like layer",
        "Handles move from where the deformed layer is to where this one is. Duplicate the layer, move the copy with "
        "the manipulators until the handle is in its place, and choose it here. Only its matrix counts. Matrix, "
        "rotation and translation come on top. <b>The deformed layer itself</b> (the default): not used.");
    if (fields.isGiven(handleLayer) && !handles.likeLayer && fields.document.mm())
        throw Error("'handle_layer' names no layer of this document. Choose the layer that the handles move like, or, "
                    "for none, the layer that is deformed.");
}

void askTarget(Fields &fields, TagTarget &target) {
    fields.field("tag_attribute", target.attribute, Shown::Advanced, "Attribute for tags",
                 "Name of the scalar attribute per vertex that gets the tags. The filter adds it if it is missing. "
                 "<b>Empty</b> (the default): the vertex quality gets them.");
    fields.field("colorize", target.colorize, Shown::Always, "Colour by tag",
                 "Colours vertices by tag: fixed blue, free yellow, handles red in shades, outside grey. The layer's "
                 "own colours are not lost: deformed layers have them, and 'FCD: Clear Tags' brings them back.");
}

void askRole(Fields &fields, TagParam &param, bool all) {
    QStringList roles = {"Fixed", "Free", "Handle", "Outside"};
    QString help = "What selected vertices, and the vertices of selected faces, become.<ul><li><i>Fixed</i>: stays "
                   "where it is (tag 0).</li><li><i>Free</i>: follows (tag 1).</li><li><i>Handle</i>: moves as you say "
                   "(the tag is the number below).</li><li><i>Outside</i>: is ignored, and never moves (tag -1).</li>";
    if (all) {
        roles << "(all tags are in the file below)"
              << "(all tags stay as they are)";
        help += "<li>Or take all tags from a file.</li><li>Or leave them, and only write files.</li>";
    }
    fields.choice("role", param.role, Shown::Always, roles, "The selection is", help + "</ul>");
    fields.field("handle_number", param.handleNumber, Shown::Always, "Handle number",
                 "Which handle the selection becomes: 2 is the first, 3 the second, and so on. Handles with different "
                 "numbers can move differently. Only read for handles.");
}

void askTagFile(Fields &fields, TagParam &param) {
    fields.openFile("tag_file", param.tagFile, Shown::Always, {"*.sel"}, "All tags from (.sel)",
                    "One tag a line, in the order of the vertices. Lines that begin with # are comments.");
}

} // namespace

void askHandles(Fields &fields, HandleParam &handles, Shown shown) {
    askTags(fields, handles, shown);
    fields.openFile("transform_file", handles.transformFile, Shown::Advanced, {"*.def"}, "Motion file (.def)",
                    "A 4x4 matrix for each handle, in world coordinates: the first moves handle 2, the second handle "
                    "3, and so on. May be empty. Handles without a matrix move by the other parameters.");
    askMotionText(fields, handles, "Handles without a text move by the motion file, or else by the other parameters.",
                  shown);
    fields.openFile(
        "point_handles_file", handles.pointFile, Shown::Advanced, {"*.csv", "*.pp"}, "Point file (.csv, .pp)",
        "Points and where they go, in world coordinates. The surface turns freely there. A list has a line for each "
        "point: <i>vertex, x, y, z</i> (number of the vertex, from 0, and target) or <i>x, y, z, x, y, z</i> (start "
        "and target). Commas, semicolons or blanks separate them; # begins a comment. Picked points (.pp) alternate "
        "start and target. The vertex nearest to a start moves as the start does. You may combine points and tags; "
        "points belong where the surface is free. A layer without tags is then all free.");
    askMotion(fields, handles, shown);
    handles.validate();
}

void askTags(Fields &fields, HandleParam &handles, Shown shown) {
    fields.choice("handles", handles.source, shown,
                  {"Vertex quality", "Selection", "Custom vertex attribute", "Files", "Tags of the layer"},
                  "Handles from",
                  "Where the tags are: <b>0</b> is fixed, <b>1</b> is free, and <b>2, 3, ...</b> are handles. "
                  "<b>Negative</b> is outside: it never moves.<ul><li><i>Vertex "
                  "quality</i>: the quality is the tag. 'FCD: Tag' writes it.</li><li><i>Selection</i>: selected "
                  "vertices are the handle, vertices of selected faces are fixed, the rest is free. The handle wins "
                  "where both are selected.</li><li><i>Custom vertex attribute</i>: the attribute "
                  "below.</li><li><i>Files</i>: the tag file below.</li><li><i>Tags of the layer</i>: marks of the "
                  "tool, or what 'FCD: Tag' wrote, whatever the quality is now; without these, all is free.</li></ul>");
    askTagAttribute(fields, handles);
    fields.openFile("tag_file", handles.tagFile, Shown::Advanced, {"*.sel"}, "Tag file (.sel)",
                    "One tag a line, in the order of the vertices. Lines that begin with # are comments. Only read "
                    "when handles come from files.");
}

void ask(Fields &fields, TagSelectionParam &param) {
    askRole(fields, param, false);
    askTarget(fields, param.target);
    if (fields.areRead())
        param.validate();
}

void ask(Fields &fields, TagsFromFilesParam &param) {
    param.role = TagParam::FromFile;
    askTagFile(fields, param);
    askTarget(fields, param.target);
    if (fields.areRead())
        param.validate();
}

void ask(Fields &fields, TagParam &param) {
    askRole(fields, param, true);
    askTagFile(fields, param);
    askTarget(fields, param.target);
    fields.saveFile("save_tag_file", param.save.tagFile, Shown::Advanced, "*.sel", "Write tags to (.sel)",
                    "The file to write all tags to: one a line, in the order of the vertices. An existing file is "
                    "replaced. <b>Empty</b> (the default): none is written.");
    fields.saveFile(
        "save_transform_file", param.save.transformFile, Shown::Advanced, "*.def", "Write motions to (.def)",
        "The file to write 'Motions as text' to: a 4x4 matrix for each handle, in world coordinates, for handle 2, 3, "
        "and so on. An existing file is replaced. <b>Empty</b> (the default): none is written.");
    askMotionText(fields, param.save.handles, "Handles without a text stay. Only read when motions are written.",
                  Shown::Advanced);
    if (fields.areRead())
        param.validate();
}

void ask(Fields &fields, SaveTagsParam &param) {
    fields.choice("handles", param.handles.source, Shown::Always,
                  {"Vertex quality", "Selection", "Custom vertex attribute"}, "Tags from",
                  "Where the tags are, as in 'FCD: Deform Mesh'.<ul><li><i>Vertex quality</i>: the quality is the "
                  "tag.</li><li><i>Selection</i>: selected vertices are the handle, vertices of selected faces are "
                  "fixed, the rest is free. The handle wins where both are selected.</li><li><i>Custom vertex "
                  "attribute</i>: the attribute below.</li></ul>");
    fields.letLack();
    askTagAttribute(fields, param.handles);
    fields.saveFile("tag_file", param.tagFile, Shown::Always, "*.sel", "Write tags to (.sel)",
                    "The file to write: one tag a line, in the order of the vertices. An existing file is replaced.");
    fields.saveFile("transform_file", param.transformFile, Shown::Always, "*.def", "Write motions to (.def)",
                    "The file to write the motions below to: a 4x4 matrix for each handle, in world coordinates, for "
                    "handle 2, 3, and so on (the identity for a number without vertices). An existing file is "
                    "replaced. <b>Empty</b> (the default): only tags are saved.");
    askMotionText(fields, param.handles, "Handles without a text move by the parameters below.");
    askMotion(fields, param.handles);
    fields.order({}, true);
    if (fields.areRead()) {
        param.handles.validate();
        param.validate();
    }
}
