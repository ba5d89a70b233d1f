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

/// A time at which a pose is solved, with the number of its frame or key frame.
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
        if (at != stops.end() && at->frame != Stop::none && at->time <= time + 1e-6 / rate) // up to rounding
            at->key = i;
        else
            stops.insert(at, {time, Stop::none, i});
    }
    return stops;
}

/// \throw BadInput no vertices, or one that is not finite
void ExpectPlaces(const Companion &companion) {
    const SurfaceView &surface = companion.surface;
    std::size_t count = 0;
    for (std::size_t i = 0; i < surface.vertexSlots; ++i) {
        if (surface.IsDeleted(i))
            continue;
        ++count;
        if (!surface.At(i).allFinite())
            throw BadInput("Vertex " + std::to_string(i) + " of '" + companion.name +
                           "' has a coordinate that is not a finite number. Remove it, or leave this mesh out.");
    }
    if (count == 0)
        throw BadInput("'" + companion.name + "' has no vertices. Leave it out.");
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

/// The glTF file of a sequence, and its error.
class Morphs {
  public:
    Morphs(const SequenceOutput &output, const SurfaceView &surface, const Handles &handles,
           const PoseSequence &sequence, const std::vector<double> &time, const Progress &progress)
        : eachPose(output.shapes == SequenceOutput::EachPose), threads(progress.threads) {
        bodies.push_back(std::make_unique<Body>(surface, handles.world, output.look, nullptr, progress));
        for (const Companion &each : output.companions)
            bodies.push_back(std::make_unique<Body>(each.surface, each.world, each.look, &each, progress));
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
        std::vector<GltfMesh> meshes;
        meshes.reserve(bodies.size());
        for (const auto &each : bodies)
            meshes.push_back({each->companion ? each->companion->name : output.name, each->packed, each->look,
                              each->rest.position, each->rest.normal});
        file = std::make_unique<GltfFile>(output.gltf, meshes, std::move(animation));
    }

    /// \param position of the posed surface
    void AddPose(const Carrier &carrier, const Eigen::Matrix3Xd &position) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            Body &body = *bodies[i];
            body.Go(carrier, position);
            file->Add(i, body.now.position, body.now.normal);
            body.shape.emplace_back((body.now.position - body.rest.position).cast<float>());
        }
    }

    void AddFrame(std::size_t number, const Carrier &carrier, const Eigen::Matrix3Xd &position) {
        for (std::size_t i = 0; i < bodies.size(); ++i) {
            bodies[i]->Go(carrier, position);
            if (eachPose)
                Compare(*bodies[i], number);
            else
                file->Add(i, bodies[i]->now.position, bodies[i]->now.normal);
        }
    }

    void Finish() { file->Finish(); }

    double difference = 0;

  private:
    /// A surface of the file.
    struct Body {
        Body(const SurfaceView &surface, const Eigen::Affine3d &world, const SurfaceLook &look,
             const Companion *companion, const Progress &progress)
            : surface(surface), look(look), companion(companion), packed(surface, look, progress),
              rest(surface, world, progress), now(surface, world, progress) {
            progress(0, readingStage);
            rest.Set(surface.Positions());
        }

        void Go(const Carrier &carrier, const Eigen::Matrix3Xd &posed) {
            if (companion) {
                Eigen::Matrix3Xd position = surface.Positions();
                companion->carry(carrier, position);
                now.Set(position);
            } else {
                now.Set(posed);
            }
        }

        const SurfaceView surface;
        const SurfaceLook &look;
        const Companion *companion; ///< null for the posed surface
        const PackedSurface packed;
        WorldShape rest, now;
        std::vector<Eigen::Matrix3Xf> shape; ///< of each pose: displacements from rest
    };

    void Compare(const Body &body, std::size_t number) {
        std::mutex lock;
        ParallelFor(threads, body.packed.slot.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
            double most = 0;
            for (std::size_t i = first; i < last; ++i) {
                const auto slot = Eigen::Index(body.packed.slot[i]);
                Eigen::Vector3d mixed = body.rest.position.col(slot);
                for (std::size_t k = 0; k < body.shape.size(); ++k)
                    mixed += weight[number][k] * body.shape[k].col(slot).cast<double>();
                most = std::max(most, (mixed - body.now.position.col(slot)).norm());
            }
            const std::lock_guard<std::mutex> guard(lock);
            difference = std::max(difference, most);
        });
    }

    const bool eachPose;
    const unsigned threads;
    std::vector<std::unique_ptr<Body>> bodies;
    std::vector<std::vector<double>> weight;
    std::unique_ptr<GltfFile> file;
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
    const std::size_t shown = 10; // nobody reads more
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
    for (const Companion &each : output.companions)
        ExpectPlaces(each);
    const bool frames = output.gltf || output.pc2 || output.mdd || output.frame;
    const std::vector<double> time = FrameTimes(sequence, output.rate);
    const std::vector<Stop> stops = StopsOf(sequence, output.rate, frames, bool(output.keyFrame));
    if (stops.empty())
        throw BadInput("There is nothing to make from the poses. Give key frames, and a file or layers to make.");
    SequenceSolver solver(deformer, handles.world, motions, param);
    SequenceReport report;
    Eigen::Matrix3Xd position;
    std::unique_ptr<Carrier> carrier; // of the same pose as position
    Deformer::Pose farthest;          // the one with most energy
    std::size_t done = 0;
    const bool posesFirst = bool(output.gltf) && output.shapes == SequenceOutput::EachPose;
    const std::size_t all = stops.size() + (posesFirst ? motions.size() : 0);
    const auto go = [&](SequenceSolver &from, const std::vector<double> &weight) -> const Deformer::Pose & {
        const Progress part = progress.Slice(double(done) / double(all), double(done + 1) / double(all));
        ++done;
        const Deformer::Pose &pose = from.Go(weight, part.Slice(0, 0.5));
        position = surface.Positions();
        carrier = std::make_unique<Carrier>(deformer, pose, part.threads);
        carrier->Apply(position, nullptr, part.Slice(0.5, 0.8));
        report.converged = report.converged && pose.converged;
        report.jumps = report.jumps || pose.path.jumps;
        report.unstable = report.unstable || pose.path.unstable;
        if (farthest.region.empty() || pose.energy > farthest.energy)
            farthest = pose;
        report.folded =
            std::max(report.folded, CheckPose(surface, handles, deformer, pose, position, part.Slice(0.8, 1)).flipped);
        return pose;
    };

    std::unique_ptr<const PackedSurface> packed;
    std::vector<PointCacheFile> caches;
    if (output.pc2 || output.mdd)
        packed = std::make_unique<const PackedSurface>(surface, progress.Slice(0, 0));
    if (output.pc2)
        caches.emplace_back(output.pc2, *packed, time, output.rate, PointCacheFile::Pc2);
    if (output.mdd)
        caches.emplace_back(output.mdd, *packed, time, output.rate, PointCacheFile::Mdd);
    std::unique_ptr<Morphs> morphs;
    if (output.gltf)
        morphs = std::make_unique<Morphs>(output, surface, handles, sequence, time, progress.Slice(0, 0));
    for (std::size_t k = 0; posesFirst && k < motions.size(); ++k) {
        std::vector<double> weight(motions.size(), 0);
        weight[k] = 100;
        solver.Rest();
        go(solver, weight);
        morphs->AddPose(*carrier, position);
    }
    solver.Rest();
    for (const Stop &stop : stops) {
        SequenceSolver aside = solver; // for key frames between: they must not change the frames
        const bool isBetween = stop.frame == Stop::none && frames;
        const Deformer::Pose &pose = go(isBetween ? aside : solver, sequence.WeightsAt(stop.time));
        if (param.contact || surface.faces <= contactUnasked)
            if (const SurfaceContact found = ContactOf(surface, deformer, position, param); !found.face.empty())
                report.contacts.push_back({stop.time, found.face.size(), found.largest});
        if (stop.frame != Stop::none) {
            for (PointCacheFile &each : caches)
                each.Add(position);
            if (morphs)
                morphs->AddFrame(stop.frame, *carrier, position);
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
