// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/lists.h>
#include <vcg_ext/field/field_sampler.h>

#include <cassert>
#include <cmath>
#include <sstream>

namespace vcg::fcd {
std::vector<std::array<Index, 3>> detail::DualOf(const Patches &patches, const SurfaceGraph &surface,
                                                 const std::vector<std::array<Index, 3>> &face,
                                                 const Progress &progress) {
    using Corners = std::array<Index, 3>;
    const std::size_t grain = 1 << 16;
    std::vector<std::vector<Corners>> found((face.size() + grain - 1) / grain);
    ParallelFor(progress, "Sampling", face.size(), grain, [&](std::size_t first, std::size_t last) {
        std::vector<Corners> list;
        for (std::size_t f = first; f < last; ++f) {
            Corners corners;
            for (int k = 0; k < 3; ++k)
                corners[k] = patches.patchOf[std::size_t(surface.nodeOf[std::size_t(face[f][k])])];
            std::sort(corners.begin(), corners.end());
            if (corners[0] == corners[1]) // an edge is (a, b, b)
                corners[1] = corners[2];
            if (list.empty() || list.back() != corners)
                list.push_back(corners);
        }
        SortUnique(list);
        found[first / grain] = std::move(list);
    });
    std::vector<Corners> all = Together(found);
    SortUnique(all);

    // Keep edges and points only if they are in no triangle or edge.
    std::vector<std::array<Index, 2>> edges;
    std::vector<char> covered(std::size_t(patches.Size()), 0);
    for (const Corners &c : all) {
        if (c[1] != c[2])
            for (int k = 0; k < 3; ++k)
                edges.push_back({c[k == 2], c[k == 0 ? 1 : 2]});
        if (c[0] != c[1])
            for (Index patch : c)
                covered[patch] = 1;
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

void detail::FieldSampler::Compare(const DeformationField &field, SampledField &result, const Progress &progress) {
    const std::size_t slotCount = counts.size();
    error.resize(slotCount, 0);
    std::vector<NearestPlace::Hint> nearPatch(std::size_t(patches.Size()));
    for (std::size_t t = 0; t < dual.size(); ++t)
        for (Index patch : dual[t])
            nearPatch[patch].triangle = Index(t);
    if (face.empty())
        for (Index patch = 0; patch < patches.Size(); ++patch)
            field(field.samples.position.col(patch), nullptr, &nearPatch[patch]);
    const auto isAsked = [&](std::size_t i) {
        const Piece &piece = pieces[PieceOf(surface.nodeOf[i])];
        return !piece.isDone && (!piece.isNearby || isNear[i]);
    };
    ParallelForEach(progress, "Comparing", slotCount, 1 << 12, [&](std::size_t i) {
        if (surface.nodeOf[i] >= 0 && isAsked(i)) {
            NearestPlace::Hint hint = nearPatch[std::size_t(patches.patchOf[std::size_t(surface.nodeOf[i])])];
            const Eigen::Vector3d p = rest.col(Eigen::Index(i)), displacement = field(p, nullptr, &hint);
            error[i] = float((p + displacement - deformed.col(Eigen::Index(i))).norm());
            if (Rests(i) && p + displacement != p)
                error[i] = std::max(error[i], std::numeric_limits<float>::min());
        }
    });
    result.off = result.stirred = result.faceless = 0;
    result.largest = 0;
    double sum = 0;
    std::size_t moving = 0;
    for (std::size_t i = 0; i < slotCount; ++i) {
        result.largest = std::max(result.largest, double(error[i]));
        if (!counts[i]) {
            result.faceless += error[i] > result.accuracy;
            continue;
        }
        if (Rests(i)) {
            result.stirred += error[i] > 0;
            continue;
        }
        ++moving;
        sum += double(error[i]) * error[i];
        result.off += error[i] > pieces[PieceOf(surface.nodeOf[i])].accuracy;
    }
    result.rms = moving ? std::sqrt(sum / double(moving)) : 0;
}

void detail::FieldSampler::FindNear(const std::vector<Index> &added) {
    std::vector<char> changes(std::size_t(patches.Size()), 0), isBeside(changes);
    for (Index node : added) {
        const auto patch = std::size_t(patches.patchOf[node]);
        changes[patch] = isBeside[patch] = 1;
    }
    for (const auto &corners : dual)
        if (changes[std::size_t(corners[0])] || changes[std::size_t(corners[1])] || changes[std::size_t(corners[2])])
            for (Index patch : corners)
                isBeside[patch] = 1;
    // A point of a cloud moves with the nearest samples: of the patches around it, and around these.
    for (int ring = 0; face.empty() && ring < 2; ++ring) {
        const std::vector<char> inner = isBeside;
        for (Index u = 0; u < surface.graph.Size(); ++u)
            if (inner[std::size_t(patches.patchOf[u])])
                for (Index v : surface.graph.adjacency[u])
                    isBeside[std::size_t(patches.patchOf[v])] = 1;
    }
    isNear.resize(counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i)
        isNear[i] = counts[i] && isBeside[std::size_t(patches.patchOf[std::size_t(surface.nodeOf[i])])];
}

/// As SampleField, in units of which squares are numbers of single precision.
static SampledField Sampled(const SurfaceGraph &surface, std::vector<std::array<Index, 3>> face,
                            const Eigen::Matrix3Xd &rest, const Eigen::Matrix3Xd &deformed,
                            const std::vector<Eigen::Matrix3f> &linear, const FieldParam &param,
                            const std::vector<Index> &regionOf, const Progress &progress) {
    detail::FieldSampler sampler(surface, std::move(face), rest, deformed, linear, regionOf, param,
                                 progress.Slice(0.2, 0.2));
    SampledField result;
    result.accuracy = sampler.Accuracy();
    double from = 0.2;
    for (bool isDone = false; !isDone; ++result.rounds) {
        const double to = from + 0.2 * (1 - from);
        const Progress round = progress.Slice(from, to);
        const DeformationField field(sampler.Sample(round.Slice(0, 0.3)), round.Slice(0.3, 0.4));
        isDone = sampler.Refine(field, result, round.Slice(0.4, 1));
        result.samples = field.samples;
        from = to;
    }
    progress(1, "Comparing");
    result.samples.largestDifference = result.largest;
    return result;
}

SampledField SampleField(const SurfaceView &mesh, const Eigen::Matrix3Xd &rest, const Eigen::Matrix3Xd &deformed,
                         const std::vector<Eigen::Matrix3f> &linear, const FieldParam &param, const Progress &progress,
                         const Eigen::Matrix3d &metric, const std::vector<Index> &regionOf) {
    assert(rest.cols() == Eigen::Index(mesh.vertexSlots) && deformed.cols() == rest.cols());
    assert(linear.size() == mesh.vertexSlots);
    assert(regionOf.empty() || regionOf.size() == mesh.vertexSlots);
    if (!(param.accuracy >= 0) || std::isinf(param.accuracy))
        throw BadInput(
            "The accuracy of a saved deformation must be a positive number, or 0: its largest motion then sets it.");
    const SurfaceGraph surface = BuildSurfaceGraph(mesh, nullptr, {}, metric, progress.Slice(0, 0.2));
    std::vector<std::array<Index, 3>> face;
    face.reserve(mesh.faces);
    for (std::size_t f = 0; f < mesh.faces; ++f)
        if (mesh.IsFace(f))
            face.push_back({Index(mesh.corner[3 * f]), Index(mesh.corner[3 * f + 1]), Index(mesh.corner[3 * f + 2])});
    progress(0.2, "Sampling");
    double farthest = 0;
    for (std::size_t i = 0; i < surface.nodeOf.size(); ++i)
        if (surface.nodeOf[i] >= 0)
            farthest = std::max({farthest, rest.col(Eigen::Index(i)).cwiseAbs().maxCoeff(),
                                 deformed.col(Eigen::Index(i)).cwiseAbs().maxCoeff()});
    const double unit = detail::UnitOf(farthest); // errors are in single precision
    if (unit == 1)
        return Sampled(surface, std::move(face), rest, deformed, linear, param, regionOf, progress);
    FieldParam scaled = param;
    scaled.accuracy /= unit;
    SampledField result =
        Sampled(surface, std::move(face), rest / unit, deformed / unit, linear, scaled, regionOf, progress);
    result.samples.position *= unit;
    result.samples.displacement *= unit;
    for (double *each : {&result.samples.largestDifference, &result.accuracy, &result.largest, &result.rms})
        *each *= unit;
    return result;
}

Index Invert(std::vector<Eigen::Matrix3f> &linear) {
    Index folded = 0;
    for (Eigen::Matrix3f &each : linear) {
        const Eigen::Matrix3d map = each.cast<double>();
        // A map that flattens to a thousandth may as well be inside out.
        const bool isFolded = !(map.determinant() > 1e-3);
        folded += isFolded;
        each = isFolded ? Eigen::Matrix3f::Identity() : Eigen::Matrix3f(map.inverse().cast<float>());
    }
    return folded;
}

std::string SampledField::Warning() const {
    if (off + stirred + faceless == 0)
        return "";
    std::ostringstream line;
    const auto tellFar = [&](Index count, const char *which) {
        line << count << which << " are farther off than " << accuracy << ", up to " << largest;
    };
    if (off + stirred > 0) {
        if (off > 0)
            tellFar(off, " vertices");
        if (stirred > 0)
            line << (off > 0 ? " and " : "") << stirred << " vertices that rest move";
        line << ": parts at one place move differently there, or a million samples are not enough.";
    } else {
        tellFar(faceless, " vertices without a face");
        line << ": samples lie on faces.";
    }
    line << " If that matters, use the graph layers (in Python, Pose.map).";
    return line.str();
}

std::string FoldsWarning(Index folded) {
    return folded == 0 ? ""
                       : "The deformation folds the surface at " + std::to_string(folded) +
                             " vertices: these have no way back, and points near them may come to another place.";
}

} // namespace vcg::fcd
