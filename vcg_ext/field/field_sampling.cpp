// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/field/field_sampling.h>
#include <vcg_ext/patches/lloyd.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <utility>

namespace vcg::fcd {
namespace detail {

/// The deformation of a mesh as it is sampled.
class FieldSampler {
  public:
    FieldSampler(const SurfaceGraph &surface, std::vector<std::array<Index, 3>> face, const Eigen::Matrix3Xd &rest,
                 const Eigen::Matrix3Xd &deformed, const std::vector<Eigen::Matrix3f> &linear, const FieldParam &param)
        : surface(surface), face(std::move(face)), rest(rest), deformed(deformed), linear(linear), most(param.most) {
        const std::size_t slotCount = surface.nodeOf.size();
        counts.assign(slotCount, this->face.empty());
        for (const auto &corners : this->face)
            for (Index i : corners)
                counts[std::size_t(i)] = 1;
        const Index nodes = surface.graph.Size();
        slotOf.assign(std::size_t(nodes), -1);
        std::vector<char> rests(std::size_t(nodes), 1);
        Eigen::AlignedBox3d box;
        double motion = 0, farthest = 0;
        for (std::size_t i = 0; i < slotCount; ++i) {
            const Index node = surface.nodeOf[i];
            if (node < 0) {
                counts[i] = 0;
                continue;
            }
            if (slotOf[std::size_t(node)] < 0)
                slotOf[std::size_t(node)] = Index(i);
            if (!Rests(i)) {
                rests[std::size_t(node)] = 0;
                const Eigen::Vector3d from = rest.col(Eigen::Index(i)), to = deformed.col(Eigen::Index(i));
                box.extend(from);
                motion = std::max(motion, (to - from).norm());
                farthest = std::max({farthest, from.cwiseAbs().maxCoeff(), to.cwiseAbs().maxCoeff()});
            }
        }
        accuracy = param.accuracy > 0 ? param.accuracy : std::min(1e-4 * box.diagonal().norm(), motion / 50);
        accuracy =
            std::max(accuracy, 4 * std::numeric_limits<double>::epsilon() * farthest); // as positions are rounded

        // A wall of samples around what moves: no triangle is part of both what moves and what rests farther away.
        isSeed.assign(std::size_t(nodes), 0);
        std::vector<float> movingArea(surface.nodeArea), restingArea(surface.nodeArea);
        for (Index u = 0; u < nodes; ++u) {
            (rests[std::size_t(u)] ? movingArea : restingArea)[std::size_t(u)] = 0;
            for (Index v : surface.graph.adjacency[u])
                isSeed[std::size_t(u)] |= char(rests[std::size_t(u)] && !rests[std::size_t(v)]);
        }
        for (Index u : RandomSample(movingArea, param.moving, 1))
            isSeed[std::size_t(u)] = 1;
        for (Index u : RandomSample(restingArea, param.resting, 1))
            isSeed[std::size_t(u)] = 1;
    }

    /// The dual of the patches around the samples: a triangle where three of them meet in a face, an edge or a point
    /// for what is narrower than a patch.
    FieldSamples Sample(const Progress &progress) {
        std::vector<Index> seed;
        for (Index u = 0; u < Index(isSeed.size()); ++u)
            if (isSeed[std::size_t(u)])
                seed.push_back(u);
        patches = GrowPatches(surface.graph, {}, seed, progress.Slice(0, 0.5));
        for (Index u : patches.center) // those of parts without a seed, too
            isSeed[std::size_t(u)] = 1;

        FieldSamples samples;
        std::vector<Index> sampleOf(std::size_t(patches.Size()), -1), used;
        const auto use = [&](Index patch) {
            Index &sample = sampleOf[std::size_t(patch)];
            if (sample < 0) {
                sample = Index(used.size());
                used.push_back(slotOf[std::size_t(patches.center[std::size_t(patch)])]);
            }
            return sample;
        };
        if (face.empty())
            for (Index patch = 0; patch < patches.Size(); ++patch)
                use(patch);
        dual = Dual(progress.Slice(0.5, 1));
        for (const auto &corners : dual)
            samples.triangle.push_back({use(corners[0]), use(corners[1]), use(corners[2])});
        const auto n = Eigen::Index(used.size());
        samples.position.resize(3, n);
        samples.displacement.resize(3, n);
        for (Index i : used) {
            const Eigen::Index k = Eigen::Index(samples.gradient.size());
            samples.position.col(k) = rest.col(i);
            samples.displacement.col(k) = deformed.col(i) - rest.col(i);
            samples.gradient.emplace_back(linear[std::size_t(i)] - Eigen::Matrix3f::Identity());
        }
        return samples;
    }

    /// Compares at every vertex, or only \p nearby those that were off, and adds samples: wherever something would
    /// move that rests, and where each octant of a patch is off most. \return whether there are any
    bool Refine(const DeformationField &field, bool nearby, SampledField &result, const Progress &progress) {
        const std::size_t slotCount = counts.size();
        error.resize(slotCount, 0);
        std::vector<NearestPlace::Hint> nearPatch(std::size_t(patches.Size()));
        for (std::size_t t = 0; t < dual.size(); ++t)
            for (Index patch : dual[t])
                nearPatch[std::size_t(patch)].triangle = Index(t);
        if (face.empty())
            for (Index patch = 0; patch < patches.Size(); ++patch)
                field(field.samples.position.col(patch), nullptr, &nearPatch[std::size_t(patch)]);
        ParallelFor(progress, "Comparing", slotCount, 1 << 12, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                if (surface.nodeOf[i] >= 0 && (!nearby || isNear[i])) {
                    NearestPlace::Hint hint = nearPatch[std::size_t(patches.patchOf[std::size_t(surface.nodeOf[i])])];
                    const Eigen::Vector3d p = rest.col(Eigen::Index(i)), way = field(p, nullptr, &hint);
                    error[i] = float((p + way - deformed.col(Eigen::Index(i))).norm());
                    if (Rests(i) && p + way != p)
                        error[i] = std::max(error[i], std::numeric_limits<float>::min());
                }
        });
        result.off = result.stirred = 0;
        result.largest = 0;
        double sum = 0;
        std::size_t moving = 0;
        constexpr std::size_t octants = 8; // of a patch, around its centre
        std::vector<Index> worst(octants * std::size_t(patches.Size()), -1);
        std::vector<Index> added;
        for (std::size_t i = 0; i < slotCount; ++i) {
            result.largest = std::max(result.largest, double(error[i]));
            if (!counts[i])
                continue;
            const Index node = surface.nodeOf[i];
            if (Rests(i)) {
                if (error[i] > 0) {
                    ++result.stirred;
                    added.push_back(node);
                }
                continue;
            }
            ++moving;
            sum += double(error[i]) * error[i];
            if (error[i] > accuracy) {
                ++result.off;
                const auto patch = std::size_t(patches.patchOf[std::size_t(node)]);
                const auto &x = surface.graph.position;
                const Eigen::Vector3f way = x.col(node) - x.col(patches.center[patch]);
                const std::size_t octant = (way[0] > 0) + 2 * (way[1] > 0) + 4 * (way[2] > 0);
                Index &farthest = worst[octants * patch + octant];
                if (!isSeed[std::size_t(node)] && (farthest < 0 || error[i] > error[std::size_t(farthest)]))
                    farthest = Index(i);
            }
        }
        result.rms = moving ? std::sqrt(sum / double(moving)) : 0;
        worst.erase(std::remove(worst.begin(), worst.end(), -1), worst.end());
        if (16 * std::size_t(result.off) < std::size_t(patches.Size())) { // few: all of them, in fewer rounds
            worst.clear();
            for (std::size_t i = 0; i < slotCount; ++i)
                if (counts[i] && !Rests(i) && error[i] > accuracy && !isSeed[std::size_t(surface.nodeOf[i])])
                    worst.push_back(Index(i));
        }
        const Index room = most - patches.Size();
        const std::size_t wanted = room > most / 50 ? std::size_t(room) / 2 : 0; // what is off most first, bit by bit
        if (worst.size() > wanted) {
            std::sort(worst.begin(), worst.end(), [this](Index a, Index b) {
                return std::make_pair(-error[std::size_t(a)], a) < std::make_pair(-error[std::size_t(b)], b);
            });
            worst.resize(wanted);
        }
        for (Index i : worst)
            added.push_back(surface.nodeOf[std::size_t(i)]);
        bool any = false;
        std::vector<char> changes(std::size_t(patches.Size()), 0), isBeside(changes);
        for (Index node : added) {
            any |= !isSeed[std::size_t(node)];
            isSeed[std::size_t(node)] = 1;
            const auto patch = std::size_t(patches.patchOf[std::size_t(node)]);
            changes[patch] = isBeside[patch] = 1;
        }
        for (const auto &corners : dual)
            if (changes[std::size_t(corners[0])] || changes[std::size_t(corners[1])] ||
                changes[std::size_t(corners[2])])
                for (Index patch : corners)
                    isBeside[std::size_t(patch)] = 1;
        // Of a cloud, a point goes with the nearest samples: those of the patches around it, and around these.
        for (int ring = 0; face.empty() && ring < 2; ++ring) {
            const std::vector<char> inner = isBeside;
            for (Index u = 0; u < surface.graph.Size(); ++u)
                if (inner[std::size_t(patches.patchOf[std::size_t(u)])])
                    for (Index v : surface.graph.adjacency[u])
                        isBeside[std::size_t(patches.patchOf[std::size_t(v)])] = 1;
        }
        isNear.resize(slotCount);
        for (std::size_t i = 0; i < slotCount; ++i)
            isNear[i] = counts[i] && isBeside[std::size_t(patches.patchOf[std::size_t(surface.nodeOf[i])])];
        return any;
    }

    double Accuracy() const { return accuracy; }

  private:
    bool Rests(std::size_t i) const {
        return rest.col(Eigen::Index(i)) == deformed.col(Eigen::Index(i)) && linear[i] == Eigen::Matrix3f::Identity();
    }

    std::vector<std::array<Index, 3>> Dual(const Progress &progress) const {
        using Corners = std::array<Index, 3>;
        const auto unique = [](std::vector<Corners> &list) {
            std::sort(list.begin(), list.end());
            list.erase(std::unique(list.begin(), list.end()), list.end());
        };
        const std::size_t grain = 1 << 16;
        std::vector<std::vector<Corners>> found((face.size() + grain - 1) / grain);
        ParallelFor(progress, "Sampling", face.size(), grain, [&](std::size_t first, std::size_t last) {
            std::vector<Corners> list;
            for (std::size_t f = first; f < last; ++f) {
                Corners corners;
                for (int k = 0; k < 3; ++k)
                    corners[std::size_t(k)] =
                        patches.patchOf[std::size_t(surface.nodeOf[std::size_t(face[f][std::size_t(k)])])];
                std::sort(corners.begin(), corners.end());
                if (corners[0] == corners[1]) // an edge is (a, b, b)
                    corners[1] = corners[2];
                if (list.empty() || list.back() != corners)
                    list.push_back(corners);
            }
            unique(list);
            found[first / grain] = std::move(list);
        });
        std::vector<Corners> all = Together(found);
        unique(all);

        // Of edges and points, those that are no part of anything wider.
        std::vector<std::array<Index, 2>> edges;
        std::vector<char> covered(std::size_t(patches.Size()), 0);
        for (const Corners &c : all) {
            if (c[1] != c[2])
                for (int k = 0; k < 3; ++k)
                    edges.push_back({c[k == 2], c[k == 0 ? 1 : 2]});
            if (c[0] != c[1])
                for (Index patch : c)
                    covered[std::size_t(patch)] = 1;
        }
        std::sort(edges.begin(), edges.end());
        const auto isPart = [&](const Corners &c) {
            return c[1] == c[2] &&
                   (c[0] == c[1] ? bool(covered[std::size_t(c[0])])
                                 : std::binary_search(edges.begin(), edges.end(), std::array<Index, 2>{c[0], c[1]}));
        };
        all.erase(std::remove_if(all.begin(), all.end(), isPart), all.end());
        return all;
    }

    const SurfaceGraph &surface;
    const std::vector<std::array<Index, 3>> face;
    const Eigen::Matrix3Xd &rest, &deformed;
    const std::vector<Eigen::Matrix3f> &linear;
    const Index most;
    double accuracy;
    std::vector<char> counts;  ///< flags of slots: that of a corner of a face, or of any point of a cloud
    std::vector<Index> slotOf; ///< each node
    std::vector<char> isSeed;  ///< flags of nodes
    std::vector<float> error;  ///< of each slot, when it was compared last
    std::vector<char> isNear;  ///< flags of slots: of patches that got a sample since, and beside them
    Patches patches;
    std::vector<std::array<Index, 3>> dual; ///< of the patches
};

} // namespace detail

SampledField SampleField(const SurfaceView &mesh, const Eigen::Matrix3Xd &rest, const Eigen::Matrix3Xd &deformed,
                         const std::vector<Eigen::Matrix3f> &linear, const FieldParam &param, const Progress &progress,
                         const Eigen::Matrix3d &metric) {
    assert(rest.cols() == Eigen::Index(mesh.vertexSlots) && deformed.cols() == rest.cols());
    assert(linear.size() == mesh.vertexSlots);
    if (!(param.accuracy >= 0) || std::isinf(param.accuracy))
        throw BadInput("The accuracy of a saved deformation must be a positive number, or 0 for that which its largest "
                       "motion asks for.");
    const SurfaceGraph surface = BuildSurfaceGraph(mesh, nullptr, {}, metric, progress.Slice(0, 0.2));
    std::vector<std::array<Index, 3>> face;
    face.reserve(mesh.faces);
    for (std::size_t f = 0; f < mesh.faces; ++f)
        if (mesh.IsFace(f))
            face.push_back({Index(mesh.corner[3 * f]), Index(mesh.corner[3 * f + 1]), Index(mesh.corner[3 * f + 2])});
    detail::FieldSampler sampler(surface, std::move(face), rest, deformed, linear, param);
    SampledField result;
    result.accuracy = sampler.Accuracy();
    double from = 0.2;
    for (bool done = false, nearby = false; !done; ++result.rounds) {
        const double to = from + 0.2 * (1 - from);
        const Progress round = progress.Slice(from, to);
        const DeformationField field(sampler.Sample(round.Slice(0, 0.3)), round.Slice(0.3, 0.4));
        const bool more = sampler.Refine(field, nearby, result, round.Slice(0.4, 1));
        done = !more && !nearby; // when all have been compared
        // Few that are left are seen to with what comes to light elsewhere.
        nearby = more && 1000 * std::size_t(result.off) > std::size_t(field.samples.Size());
        result.samples = field.samples;
        from = to;
    }
    progress(1, "Comparing");
    result.samples.largestDifference = result.largest;
    return result;
}

Index Invert(std::vector<Eigen::Matrix3f> &linear) {
    Index folded = 0;
    for (Eigen::Matrix3f &each : linear) {
        const Eigen::Matrix3d map = each.cast<double>();
        // What is flattened to a thousandth cannot be told from what is turned inside out.
        const bool isFolded = !(map.determinant() > 1e-3);
        folded += isFolded;
        each = isFolded ? Eigen::Matrix3f::Identity() : Eigen::Matrix3f(map.inverse().cast<float>());
    }
    return folded;
}

} // namespace vcg::fcd
