// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_reports.h"

#include <layer_fcd/layer_labels.h>

#include <array>
#include <cmath>
#include <sstream>
#include <utility>

std::string describe(const vcg::fcd::SurfaceReport &surface) {
    std::ostringstream line;
    line << (surface.pointCloud ? "Point cloud" : "Surface") << " of " << surface.vertices << " vertices";
    const auto mention = [&](vcg::fcd::Index count, const char *what) {
        if (count > 0)
            line << ", " << count << " " << what;
    };
    mention(surface.components, surface.components == 1 ? "connected part" : "connected parts");
    mention(surface.welded, "vertices at the place of another (treated as one)");
    mention(surface.seams, "on borders a hair from another (treated as one)");
    mention(surface.isolated, "isolated vertices");
    mention(surface.nonManifoldEdges, "non-manifold edges");
    mention(surface.degenerateFaces, "degenerate faces");
    line << ".";
    if (surface.together > 0)
        line << " There are so many regions that " << surface.together
             << " of them, the smallest, share one deformation graph, and depend on each other a little.";
    if (surface.limited > 0)
        line << " There are so many regions that " << surface.limited
             << " of them have fewer patches than they would have alone.";
    return line.str();
}

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::SurfaceReport &surface) {
    return {{"components", surface.components},           {"welded_vertices", surface.welded},
            {"joined_vertices", surface.seams},           {"gap_vertices", surface.gaps},
            {"isolated_vertices", surface.isolated},      {"non_manifold_edges", surface.nonManifoldEdges},
            {"degenerate_faces", surface.degenerateFaces}};
}

std::string describe(const vcg::fcd::TagCount &tags) {
    return inWords(tags.fixed, " fixed, ", tags.handle, " handle, ", tags.free, " free, ", tags.outside,
                   " outside vertices");
}

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::TagCount &tags) {
    return {{"fixed_vertices", tags.fixed},
            {"handle_vertices", tags.handle},
            {"free_vertices", tags.free},
            {"outside_vertices", tags.outside}};
}

std::string describe(const MeshModel &layer, const TagTarget &target) {
    const bool quality = target.attribute.isEmpty();
    if (!target.colorize && !quality)
        return {};
    return "Save " + inQuotes(layer) + " now, and the file has the tags as " +
           (target.colorize && quality ? "colours and quality"
            : quality                  ? "quality"
                                       : "colours") +
           " instead of its own: 'FCD: Clear Tags' brings these back.";
}

/// A warning about flipped triangles of a pose.
static std::string describeFlipped(vcg::fcd::Index count) {
    return trianglesFlipped(std::size_t(count)) +
           ": the surface is squeezed or twisted too much there. Move the handles less, or leave more free surface "
           "between them.";
}

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::PosePath &path) {
    return {{"steps", path.steps}, {"jumps", path.jumps}, {"stable", !path.unstable}};
}

std::vector<std::string> describe(const DeformedLayers &made, const DeformMeshParam &param) {
    const vcg::fcd::DeformationResult &result = made.result;
    std::vector<std::string> remarks;
    if (result.looseParts > 0)
        remarks.push_back(
            counted(std::size_t(result.looseParts), "part is", "parts are") + " loose (no fixed or handle vertex): " +
            (param.deformation.looseParts == vcg::fcd::LooseParts::Follow ? "following the nearest held part."
                                                                          : "staying in place."));
    if (made.isOwnGraph)
        remarks.push_back(inQuotes(*param.graphLayer) +
                          " is the graph that these parameters make here, so its own patches are used.");
    else if (param.useGraphLayer)
        remarks.push_back(std::to_string(result.placedNodes) + " of the " + std::to_string(made.givenNodes) +
                          " nodes of " + inQuotes(*param.graphLayer) + " lie on the surface" +
                          (result.placedNodes < made.givenNodes ? "; the others are left out." : ".") +
                          " Their patches are grown anew.");
    if (made.isStopped)
        remarks.push_back(inWords("Stopped at ", made.percent, " of ", param.deformation.pose,
                                  " percent, the last hundredth before the surface passes through itself."));
    return remarks;
}

double valueOfDiscretisation(double error) { return std::isfinite(error) ? error : -1; }

std::vector<std::string> describe(const vcg::fcd::DeformationCheck &check, const vcg::fcd::SurfaceReport &surface) {
    std::vector<std::string> warnings;
    if (check.rigid)
        warnings.emplace_back("Nothing is fixed beside the free surface, so it moves rigidly with the handles. Mark as "
                              "fixed (tag 0) what has to stay, beside the free surface.");
    if (IsInLines(surface))
        warnings.push_back(
            std::to_string(surface.oneSided) +
            " points have neighbours only on their own scan line, so the lines are hardly connected. If this is a "
            "surface, first thin out the points along the lines, as with 'Point Cloud Simplification'.");
    if (surface.gaps > 3)
        warnings.push_back(std::to_string(surface.gaps) +
                           " vertices on open borders nearly touch another border (within a tenth of their edges): "
                           "such a slit may open. To close it, use 'Merge Close Vertices' first" +
                           (host::scriptsMayLackParameters ? ", or raise weld_distance." : "."));
    if (surface.unenclosed > 0)
        warnings.push_back(counted(std::size_t(surface.unenclosed), "free part encloses", "free parts enclose") +
                           " no volume that 'elastic' could keep: a cloud, or a surface with open borders in its free "
                           "part. It bends as without 'elastic'.");
    if (check.volumeOff > check.volumeIsSeen)
        warnings.push_back("The volume of the free surface is off by " +
                           std::to_string(int(std::lround(100 * check.volumeOff))) +
                           " percent: 'elastic' makes a limb at most twice or half as thick. Move the handles less, or "
                           "leave more of the surface free.");
    if (check.overruled > 0)
        warnings.push_back(counted(std::size_t(check.overruled), "handle vertex is", "handle vertices are") +
                           " at the place of a fixed vertex, or of one with a smaller tag, which counts. Give all "
                           "vertices at a place the same tag.");
    if (check.strained > 0)
        warnings.push_back(inWords(counted(std::size_t(check.strained), "edge joins", "edges join"),
                                   " two held regions that move differently: less than half or more than twice as long "
                                   "as at rest (the longest: ",
                                   check.longest, " times). Leave free vertices between them."));
    if (check.flipped > 0)
        warnings.push_back(describeFlipped(check.flipped));
    return warnings;
}

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::SurfaceContact &contact) {
    return {{"contact_triangles", int(contact.face.size())}, {"contact_depth", contact.largest}};
}

std::vector<std::string> warningsOf(const vcg::fcd::SurfaceContact &contact) {
    if (contact.face.empty())
        return {};
    return {contact.Text() + " Move the handles less."};
}

HostFilterPlugin::ReturnedValues valuesOf(const vcg::fcd::DeformationResult &result) {
    HostFilterPlugin::ReturnedValues values = valuesOf(result.surface);
    values.merge(valuesOf(result.contact));
    values.insert({{"folded_triangles", result.check.flipped},
                   {"nodes", int(result.rest.position.cols())},
                   {"converged", result.converged}});
    return values;
}

HostFilterPlugin::ReturnedValues valuesOf(const StraightenedLayers &made) {
    const vcg::fcd::StraightenReport &report = made.report;
    return {{"length", report.length},
            {"new_length", report.newLength},
            {"jitter", report.jitter},
            {"middle_left", report.leftMiddle},
            {"lengthening", report.lengthening},
            {"twist", report.twist},
            {"following_nodes", report.following},
            {"released_nodes", report.released},
            {"rms", report.rms},
            {"largest", report.largest},
            {"seconds", made.seconds}};
}

HostFilterPlugin::ReturnedValues valuesOf(const SymmetrizedLayers &made) {
    const vcg::fcd::SymmetryReport &report = made.report;
    const Eigen::Vector3d &point = report.plane.point, &normal = report.plane.normal;
    return {{"plane_point_x", point[0]},
            {"plane_point_y", point[1]},
            {"plane_point_z", point[2]},
            {"plane_normal_x", normal[0]},
            {"plane_normal_y", normal[1]},
            {"plane_normal_z", normal[2]},
            {"plane_is_sure", report.isSure},
            {"rms_before", made.before},
            {"rms_after", made.after},
            {"asymmetry", report.asymmetry},
            {"asymmetry_most", report.asymmetryMost},
            {"moved", report.moved},
            {"moved_most", report.movedMost},
            {"matched", report.fit.matched},
            {"pairs", int(made.pairs)},
            {"midline_points", int(made.midline)},
            {"mirrored_vertices", int(made.mirrored)},
            {"seconds", made.seconds}};
}

HostFilterPlugin::ReturnedValues valuesOf(const CompensatedLayers &made) {
    const vcg::fcd::CompensateReport &report = made.report;
    return {{"rms_before", report.before}, {"rms_left", report.left},          {"scanned", report.scanned},
            {"change", report.change},     {"change_most", report.changeMost}, {"missed", report.missed},
            {"seconds", made.seconds}};
}

std::string describe(const SequenceLayers &made) {
    const vcg::fcd::SequenceReport &report = made.report;
    std::ostringstream line;
    line << describe(made.tags) << "; " << counted(std::size_t(made.poses), "pose, ", "poses, ")
         << counted(std::size_t(made.keyFrames), "key frame, ", "key frames, ") << report.frames << " frames; "
         << made.layers.size() << " new layers. ";
    if (made.companions > 0)
        line << counted(std::size_t(made.companions), "other layer goes", "other layers go") << " along. ";
    if (report.difference > 0)
        line << "Shapes of poses, mixed in straight lines, are off from the frames by up to " << report.difference
             << ". ";
    line << made.seconds << " s.";
    return line.str();
}

HostFilterPlugin::ReturnedValues valuesOf(const SequenceLayers &made) {
    const vcg::fcd::SequenceReport &report = made.report;
    HostFilterPlugin::ReturnedValues values = valuesOf(made.tags);
    values.insert({{"poses", made.poses},
                   {"key_frames", made.keyFrames},
                   {"frames", int(report.frames)},
                   {"layers", int(made.layers.size())},
                   {"largest_difference", report.difference},
                   {"folded_triangles", report.folded},
                   {"contact_frames", int(report.contacts.size())},
                   {"contact_triangles", int(report.MostContact())},
                   {"contact_depth", report.ContactDepth()},
                   {"nodes", made.nodes},
                   {"converged", report.converged},
                   {"jumps", report.jumps},
                   {"stable", !report.unstable},
                   {"discretisation_error", valueOfDiscretisation(report.discretisationError)},
                   {"seconds", made.seconds}});
    return values;
}

std::vector<std::string> warningsOf(const SequenceLayers &made) {
    std::vector<std::string> warnings;
    if (made.report.folded > 0)
        warnings.push_back("In a frame, " + describeFlipped(made.report.folded));
    if (const std::string contact = made.report.ContactText(); !contact.empty())
        warnings.push_back(contact);
    return warnings;
}

std::string describe(const SavedDeformation &saved) {
    const vcg::fcd::SampledField &field = saved.field;
    return inWords(field.samples.Size(), " samples, a file of ", double(saved.bytes) / 1e6, " MB in ", saved.seconds,
                   " s; the vertices of the source that move are off by ", field.rms,
                   " (rms), and none of all its vertices by more than ", field.largest, " (aimed at: ", field.accuracy,
                   ").");
}

HostFilterPlugin::ReturnedValues valuesOf(const SavedDeformation &saved) {
    return {{"samples", int(saved.field.samples.Size())},
            {"rms_difference", saved.field.rms},
            {"largest_difference", saved.field.largest},
            {"accuracy", saved.field.accuracy},
            {"folded_vertices", saved.folded},
            {"megabytes", double(saved.bytes) / 1e6},
            {"seconds", saved.seconds}};
}

std::vector<std::string> warningsOf(const SavedDeformation &saved) {
    std::vector<std::string> warnings;
    for (std::string &each : std::array{saved.field.Warning(), vcg::fcd::FoldsWarning(saved.folded)})
        if (!each.empty())
            warnings.push_back(std::move(each));
    return warnings;
}
