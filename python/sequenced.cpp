// SPDX-License-Identifier: GPL-3.0-or-later
#include "sequenced.h"

#include <vcg_ext/handles/motion_text.h>

using vcg::fcd::BadInput;
using vcg::fcd::Motion;
using vcg::fcd::Progress;

namespace {

vcg::fcd::SurfaceMark markOf(const Prepared &prepared) {
    const nb::gil_scoped_release release;
    return vcg::fcd::SurfaceMark::Of(prepared.view, prepared.handles.world);
}

/// What hands bytes to a callable of Python; empty for None.
vcg::fcd::WriteAt writerOf(const nb::object &take) {
    if (take.is_none())
        return {};
    return [&take](std::uint64_t at, const char *data, std::size_t size) {
        const nb::gil_scoped_acquire acquire;
        take(at, nb::bytes(data, size));
    };
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
                         const nb::object &pointCache, const std::optional<Colors> &colors,
                         const nb::object &report) const {
    const std::vector<std::map<int, Motion>> motions = motionsOf(*prepared);
    vcg::fcd::SequenceOutput output;
    output.rate = rate;
    output.name = "surface";
    output.shapes = vcg::fcd::SequenceOutput::Shapes(shapes);
    output.gltf = writerOf(gltf);
    output.pointCache = writerOf(pointCache);
    if (colors) {
        expectRows(*colors, prepared->view.vertexSlots);
        output.color.resize(prepared->view.vertexSlots);
        std::copy_n(colors->data(), 4 * output.color.size(), output.color.front().data());
    }
    vcg::fcd::SequenceReport made;
    Listener::Run(report, prepared->threads, [&](const Progress &progress) {
        made = vcg::fcd::WriteFrames(prepared->view, prepared->handles, *prepared->deformer, sequence, motions,
                                     prepared->param, output, progress);
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
