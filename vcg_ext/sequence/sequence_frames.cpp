// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/map/carrier.h>
#include <vcg_ext/sequence/gltf_file.h>
#include <vcg_ext/sequence/sequence_frames.h>
#include <vcg_ext/surface/face_normals.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <sstream>
#include <utility>

namespace vcg::fcd {

namespace {

/// A time at which a pose is wanted.
struct Stop {
    static constexpr std::size_t none = std::size_t(-1);
    double time = 0;
    std::size_t frame = none, key = none;
};

std::vector<Stop> StopsOf(const PoseSequence &sequence, double rate, bool frames, bool keys) {
    std::vector<Stop> stops;
    const std::vector<double> times = FrameTimes(sequence, rate);
    for (std::size_t i = 0; frames && i < times.size(); ++i)
        stops.push_back({times[i], i, Stop::none});
    for (std::size_t i = 0; keys && i < sequence.key.size(); ++i) {
        const double time = sequence.key[i].time;
        const auto at =
            std::find_if(stops.begin(), stops.end(), [&](const Stop &each) { return each.time >= time - 1e-6 / rate; });
        if (at != stops.end() && at->frame != Stop::none && at->time <= time + 1e-6 / rate) // but for rounding
            at->key = i;
        else
            stops.insert(at, {time, Stop::none, i});
    }
    return stops;
}

/// The surface in the world, as glTF has it.
class WorldShape {
  public:
    WorldShape(const SurfaceView &surface, const Eigen::Affine3d &world, const Progress &progress)
        : surface(surface), world(world), threads(progress.threads) {}

    void Set(const Eigen::Matrix3Xd &mesh) {
        position.resize(3, mesh.cols());
        ParallelFor(threads, std::size_t(mesh.cols()), 1 << 14, [&](std::size_t first, std::size_t last) {
            for (auto i = Eigen::Index(first); i < Eigen::Index(last); ++i)
                position.col(i) = world * Eigen::Vector3d(mesh.col(i));
        });
        if (surface.isCloud)
            return;
        normal.resize(3, mesh.cols());
        FaceNormals(surface, position.data(), normal.data(), threads);
    }

    Eigen::Matrix3Xd position, normal;

  private:
    const SurfaceView &surface;
    const Eigen::Affine3d world;
    const unsigned threads;
};

/// The glTF file of a sequence, and by how much it is off.
class Morphs {
  public:
    Morphs(const SequenceOutput &output, const PackedSurface &packed, const SurfaceView &surface,
           const Handles &handles, const PoseSequence &sequence, const std::vector<double> &time,
           const Progress &progress)
        : packed(packed), eachPose(output.shapes == SequenceOutput::EachPose), rest(surface, handles.world, progress),
          now(surface, handles.world, progress), threads(progress.threads) {
        rest.Set(surface.Positions());
        MorphAnimation animation;
        animation.time = time;
        for (std::size_t i = 0; !eachPose && i < time.size(); ++i)
            animation.target.push_back("frame " + std::to_string(i));
        for (std::size_t k = 0; eachPose && k < sequence.pose.size(); ++k)
            animation.target.push_back(sequence.pose[k].name);
        for (std::size_t i = 0; eachPose && i < time.size(); ++i) {
            animation.weight.push_back(sequence.WeightsAt(time[i]));
            for (double &each : animation.weight.back())
                each /= 100;
        }
        weight = animation.weight;
        file = std::make_unique<GltfFile>(output.gltf, output.name, packed, rest.position, rest.normal,
                                          std::move(animation), output.color);
    }

    void AddPose(const Eigen::Matrix3Xd &position) {
        now.Set(position);
        file->Add(now.position, now.normal);
        shape.emplace_back((now.position - rest.position).cast<float>());
    }

    void AddFrame(std::size_t number, const Eigen::Matrix3Xd &position) {
        now.Set(position);
        if (!eachPose) {
            file->Add(now.position, now.normal);
            return;
        }
        std::mutex lock;
        ParallelFor(threads, packed.slot.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
            double most = 0;
            for (std::size_t i = first; i < last; ++i) {
                const auto slot = Eigen::Index(packed.slot[i]);
                Eigen::Vector3d mixed = rest.position.col(slot);
                for (std::size_t k = 0; k < shape.size(); ++k)
                    mixed += weight[number][k] * shape[k].col(slot).cast<double>();
                most = std::max(most, (mixed - now.position.col(slot)).norm());
            }
            const std::lock_guard<std::mutex> guard(lock);
            difference = std::max(difference, most);
        });
    }

    void Finish() { file->Finish(); }

    double difference = 0;

  private:
    const PackedSurface &packed;
    const bool eachPose;
    WorldShape rest, now;
    const unsigned threads;
    std::vector<std::vector<double>> weight;
    std::unique_ptr<GltfFile> file;
    std::vector<Eigen::Matrix3Xf> shape; ///< of each pose, what it adds to that at rest
};

} // namespace

std::size_t SequenceReport::MostContact() const {
    std::size_t most = 0;
    for (const FrameContact &each : contacts)
        most = std::max(most, each.triangles);
    return most;
}

double SequenceReport::ContactDepth() const {
    double most = 0;
    for (const FrameContact &each : contacts)
        most = std::max(most, each.depth);
    return most;
}

std::string SequenceReport::ContactText() const {
    if (contacts.empty())
        return {};
    const std::size_t shown = 10; // more are not read
    std::ostringstream line;
    line << "In " << contacts.size() << " of " << frames << " frames, triangles pass through others, up to "
         << ContactDepth() << " deep: ";
    for (std::size_t i = 0; i < std::min(shown, contacts.size()); ++i)
        line << (i ? ", " : "") << contacts[i].triangles << " at " << contacts[i].time << " s";
    line << (contacts.size() > shown ? ", and so on" : "") << ". Move the handles less.";
    return line.str();
}

SequenceReport WriteFrames(const SurfaceView &surface, const Handles &handles, const Deformer &deformer,
                           const PoseSequence &sequence, const std::vector<std::map<int, Motion>> &motions,
                           const DeformationParam &param, const SequenceOutput &output, const Progress &progress) {
    sequence.Validate();
    const bool frames = output.gltf || output.pointCache || output.frame;
    const std::vector<double> time = FrameTimes(sequence, output.rate);
    const std::vector<Stop> stops = StopsOf(sequence, output.rate, frames, bool(output.keyFrame));
    if (stops.empty())
        throw BadInput("There is nothing to make of the poses: no key frames, or no file and no layers that are asked "
                       "for.");
    SequenceSolver solver(deformer, handles.world, motions, param);
    SequenceReport report;
    Eigen::Matrix3Xd position;
    Deformer::Pose farthest; // of all, that with most of Eq. 2
    std::size_t done = 0;
    const bool posesFirst = bool(output.gltf) && output.shapes == SequenceOutput::EachPose;
    const std::size_t all = stops.size() + (posesFirst ? motions.size() : 0);
    const auto go = [&](SequenceSolver &from, const std::vector<double> &weight) -> const Deformer::Pose & {
        const Progress part = progress.Slice(double(done) / double(all), double(done + 1) / double(all));
        ++done;
        const Deformer::Pose &pose = from.Go(weight, part.Slice(0, 0.5));
        position = surface.Positions();
        Carrier(deformer, pose, part.threads).Apply(position, nullptr, part.Slice(0.5, 0.8));
        report.converged = report.converged && pose.converged;
        report.jumps = report.jumps || pose.way.jumps;
        report.unstable = report.unstable || pose.way.unstable;
        if (farthest.region.empty() || pose.energy > farthest.energy)
            farthest = pose;
        report.folded =
            std::max(report.folded, CheckPose(surface, handles, deformer, pose, position, part.Slice(0.8, 1)).flipped);
        return pose;
    };

    const PackedSurface packed(surface, progress.threads);
    std::unique_ptr<PointCacheFile> cache;
    if (output.pointCache)
        cache = std::make_unique<PointCacheFile>(output.pointCache, packed, time.size(),
                                                 std::round(time.front() * output.rate));
    std::unique_ptr<Morphs> morphs;
    if (output.gltf)
        morphs = std::make_unique<Morphs>(output, packed, surface, handles, sequence, time, progress);
    for (std::size_t k = 0; posesFirst && k < motions.size(); ++k) {
        std::vector<double> weight(motions.size(), 0);
        weight[k] = 100;
        solver.Rest();
        go(solver, weight);
        morphs->AddPose(position);
    }
    solver.Rest();
    for (const Stop &stop : stops) {
        SequenceSolver aside = solver; // frames do not depend on what else is made
        const bool isBetween = stop.frame == Stop::none && frames;
        const Deformer::Pose &pose = go(isBetween ? aside : solver, sequence.WeightsAt(stop.time));
        if (param.contact || surface.faces <= contactUnasked)
            if (const SurfaceContact found = ContactOf(surface, deformer, position, param); !found.face.empty())
                report.contacts.push_back({stop.time, found.face.size(), found.largest});
        if (stop.frame != Stop::none) {
            if (cache)
                cache->Add(position);
            if (morphs)
                morphs->AddFrame(stop.frame, position);
            if (output.frame)
                output.frame(stop.frame, pose, position);
        }
        if (stop.key != Stop::none)
            output.keyFrame(stop.key, pose, position);
        ++report.frames;
    }
    if (morphs) {
        morphs->Finish();
        report.difference = morphs->difference;
    }
    report.discretisationError = deformer.DiscretisationError(farthest, param);
    progress(1, "Done");
    return report;
}

} // namespace vcg::fcd
