// SPDX-License-Identifier: GPL-3.0-or-later
#include "sequenced.h"
#include "space_order.h"

#include <vcg_ext/handles/motion_text.h>

using vcg::fcd::BadInput;
using vcg::fcd::Motion;
using vcg::fcd::Progress;

namespace {

vcg::fcd::SurfaceMark markOf(const Prepared &prepared) {
    const nb::gil_scoped_release release;
    return vcg::fcd::SurfaceMark::Of(prepared.view, prepared.handles.world);
}

/// Passes bytes to a callable of Python; empty for None.
vcg::fcd::WriteAt writerOf(const nb::object &take) {
    if (take.is_none())
        return {};
    return [&take](std::uint64_t at, const char *data, std::size_t size) {
        const nb::gil_scoped_acquire acquire;
        take(at, nb::bytes(data, size));
    };
}

template <class Rows_>
vcg::fcd::ElementColors colorsOf(const std::optional<Rows_> &rows, std::size_t count) {
    vcg::fcd::ElementColors colors(rows ? count : 0);
    if (rows && rows->shape(0) != count)
        throw nb::value_error("colours have another number of rows than there are vertices, or faces");
    if (count > 0 && rows)
        std::copy_n(rows->data(), 4 * count, colors.front().data());
    return colors;
}

vcg::fcd::SurfaceLook lookOf(const Sequence::Look &given, const vcg::fcd::SurfaceView &surface) {
    const auto &[name, colors, faceColors, places, textures, images] = given;
    vcg::fcd::SurfaceLook look;
    look.color = colorsOf(colors, surface.vertexSlots);
    look.faceColor = colorsOf(faceColors, surface.faces);
    if ((places && places->shape(0) != surface.faces) || (textures && textures->shape(0) != surface.faces))
        throw nb::value_error("an array has another number of rows than the surface has faces");
    if (places)
        look.place.assign(places->data(), places->data() + 6 * surface.faces);
    if (textures)
        look.texture.assign(textures->data(), textures->data() + surface.faces);
    for (const auto &[title, content] : images)
        look.image.push_back({title, std::string(content.c_str(), content.size())});
    return look;
}

/// The places on the surface of another mesh's vertices, as in Posed::map.
std::vector<vcg::fcd::SurfacePlace> placesOf(const Rows &rows, const Prepared &prepared, const Progress &progress) {
    std::vector<vcg::fcd::SurfacePlace> found(rows.shape(0));
    const vcg::fcd::NearestPlace &places = prepared.places(progress.Slice(0, 0.5));
    forInSpaceOrder(rows.data(), found.size(), prepared.box, progress.Slice(0.5, 1), "Mapping points",
                    [&](std::size_t i, vcg::fcd::NearestPlace::Hint &hint) {
                        found[i] = places(Eigen::Vector3d(rowOf(rows.data(), i)), hint);
                    });
    return found;
}

vcg::fcd::Companion companionOf(const Sequence::Other &given, const Prepared &prepared) {
    const auto &[rows, corners, look] = given;
    vcg::fcd::Companion companion;
    companion.surface.position = rows.data();
    companion.surface.vertexSlots = rows.shape(0);
    companion.surface.isCloud = !corners;
    if (corners) {
        companion.surface.corner = corners->data();
        companion.surface.faces = corners->shape(0);
    }
    companion.world = prepared.handles.world;
    companion.name = std::get<0>(look);
    companion.look = lookOf(look, companion.surface);
    return companion;
}

} // namespace

Sequence::Sequence(const std::vector<std::pair<std::string, std::string>> &poses, const std::vector<Key> &keys) {
    for (const auto &[name, motions] : poses)
        sequence.pose.push_back({name, motions});
    for (const auto &[time, easing, weight] : keys)
        sequence.key.push_back({time, vcg::fcd::Easing(easing), weight});
    sequence.Validate();
}

std::string Sequence::text(const Prepared *prepared) const {
    vcg::fcd::PoseSequence marked = sequence;
    marked.surface.reset();
    if (prepared)
        marked.surface = markOf(*prepared);
    return vcg::fcd::PoseSequenceText(marked);
}

std::vector<std::pair<std::string, std::string>> Sequence::poses() const {
    std::vector<std::pair<std::string, std::string>> all;
    for (const vcg::fcd::NamedPose &each : sequence.pose)
        all.emplace_back(each.name, each.motions);
    return all;
}

std::vector<Sequence::Key> Sequence::keys() const {
    std::vector<Key> all;
    for (const vcg::fcd::KeyFrame &each : sequence.key)
        all.emplace_back(each.time, int(each.easing), each.weight);
    return all;
}

std::vector<std::map<int, Motion>> Sequence::motionsOf(const Prepared &prepared) const {
    sequence.ExpectSurface(markOf(prepared));
    std::vector<std::map<int, Motion>> motions;
    for (const vcg::fcd::NamedPose &pose : sequence.pose) {
        motions.emplace_back();
        try {
            for (const auto &[tag, steps] : vcg::fcd::ReadMotionText(pose.motions, "the motion")) {
                const auto center = prepared.deformer->center.find(tag);
                if (center == prepared.deformer->center.end())
                    throw BadInput("handle " + std::to_string(tag) + " moves, but no vertex has tag " +
                                   std::to_string(tag) + ".");
                motions.back()[tag] = vcg::fcd::ToMotion(steps, center->second);
            }
        } catch (const BadInput &error) {
            throw BadInput("pose '" + pose.name + "': " + error.what());
        }
    }
    return motions;
}

nb::dict Sequence::write(const std::shared_ptr<Prepared> &prepared, double rate, const nb::object &gltf, int shapes,
                         const nb::object &pc2, const nb::object &mdd, const Look &look,
                         const std::vector<Other> &others, const nb::object &report) const {
    const std::vector<std::map<int, Motion>> motions = motionsOf(*prepared);
    vcg::fcd::SequenceOutput output;
    output.rate = rate;
    output.name = std::get<0>(look);
    output.look = lookOf(look, prepared->view);
    output.shapes = vcg::fcd::SequenceOutput::Shapes(shapes);
    output.gltf = writerOf(gltf);
    output.pc2 = writerOf(pc2);
    output.mdd = writerOf(mdd);
    for (const Other &each : others)
        output.companions.push_back(companionOf(each, *prepared));
    vcg::fcd::SequenceReport made;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        const double begin = others.empty() ? 0 : 0.2; // an estimate of the time for the places
        for (std::size_t i = 0; i < others.size(); ++i) {
            const auto share = [&](std::size_t n) { return begin * double(n) / double(others.size()); };
            const Rows &rows = std::get<0>(others[i]);
            output.companions[i].carry = [places = placesOf(rows, *prepared, progress.Slice(share(i), share(i + 1))),
                                          threads = prepared->threads](const vcg::fcd::Carrier &carrier,
                                                                       Eigen::Matrix3Xd &position) {
                vcg::fcd::ParallelFor(threads, places.size(), 1 << 12, [&](std::size_t first, std::size_t last) {
                    std::vector<Eigen::Vector3d> p, displacement;
                    std::vector<Eigen::Matrix3f> linear;
                    for (std::size_t n = first; n < last; ++n)
                        p.push_back(position.col(Eigen::Index(n)));
                    carrier.Displacements(
                        {places.begin() + std::ptrdiff_t(first), places.begin() + std::ptrdiff_t(last)}, p,
                        displacement, linear);
                    for (std::size_t n = first; n < last; ++n)
                        position.col(Eigen::Index(n)) += displacement[n - first];
                });
            };
        }
        made = vcg::fcd::WriteFrames(prepared->view, prepared->handles, *prepared->deformer, sequence, motions,
                                     prepared->param, output, progress.Slice(begin, 1));
    });
    nb::dict all;
    all["frames"] = made.frames;
    all["largest_difference"] = made.difference;
    all["converged"] = made.converged;
    all["jumps"] = made.jumps;
    all["folded"] = made.folded;
    nb::list contacts;
    for (const vcg::fcd::FrameContact &each : made.contacts)
        contacts.append(nb::make_tuple(each.time, each.triangles, each.depth));
    all["contacts"] = nb::tuple(contacts);
    all["contact_text"] = made.ContactText();
    all["discretisation_error"] = made.discretisationError;
    return all;
}

Sequencer::Sequencer(std::shared_ptr<Prepared> given, const Sequence &sequence)
    : prepared(std::move(given)),
      solver(*prepared->deformer, prepared->handles.world, sequence.motionsOf(*prepared), prepared->param) {}

std::unique_ptr<Posed> Sequencer::go(const std::vector<double> &weight, const nb::object &report) {
    const vcg::fcd::Stopwatch watch;
    vcg::fcd::SurfacePose pose;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) { pose = solver.Go(weight, progress); });
    return std::make_unique<Posed>(prepared, std::move(pose), watch.Seconds());
}
