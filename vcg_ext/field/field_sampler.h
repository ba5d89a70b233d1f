// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_FIELD_SAMPLER_H
#define VCG_FCD_FIELD_SAMPLER_H

#include <vcg_ext/field/field_sampling.h>
#include <vcg_ext/patches/lloyd.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace vcg::fcd::detail {

/// The dual graph of patches, as triangles of patches: (a, b, c) where three meet in a face, (a, b, b) and (a, a, a)
/// for edges and points that are in no triangle. \param face corners, vertex slots
std::vector<std::array<Index, 3>> DualOf(const Patches &patches, const SurfaceGraph &surface,
                                         const std::vector<std::array<Index, 3>> &face, const Progress &progress);

/// Samples the deformation of a mesh, each region apart.
class FieldSampler {
  public:
    /// \throw Cancelled
    FieldSampler(const SurfaceGraph &surface, std::vector<std::array<Index, 3>> face, const Eigen::Matrix3Xd &rest,
                 const Eigen::Matrix3Xd &deformed, const std::vector<Eigen::Matrix3f> &linear,
                 const std::vector<Index> &regionOf, const FieldParam &param, const Progress &progress)
        : surface(surface), face(std::move(face)), rest(rest), deformed(deformed), linear(linear), param(param),
          pieces(1) {
        const std::size_t slotCount = surface.nodeOf.size();
        counts.assign(slotCount, this->face.empty());
        for (const auto &corners : this->face)
            for (Index i : corners)
                counts[i] = 1;
        progress(0, stage);
        const Index nodes = surface.graph.Size();
        slotOf.assign(std::size_t(nodes), -1);
        pieceOf.assign(std::size_t(nodes), 0);
        std::vector<char> rests(std::size_t(nodes), 1);
        for (std::size_t i = 0; i < slotCount; ++i) {
            const Index node = surface.nodeOf[i];
            if (node < 0) {
                counts[i] = 0;
                continue;
            }
            if (slotOf[node] < 0)
                slotOf[node] = Index(i);
            if (Index &piece = pieceOf[node]; !regionOf.empty() && (regionOf[i] >= 0 || piece == 0))
                piece = regionOf[i] < 0 ? regionOf[i] : 1 + regionOf[i];
            if (!Rests(i))
                rests[node] = 0;
        }
        progress(0.2, stage);
        const Index regions = std::max(Index(0), *std::max_element(pieceOf.begin(), pieceOf.end()));
        NumberOthers(rests, 1 + regions);
        progress(0.4, stage);
        pieces.resize(std::size_t(1) + std::size_t(*std::max_element(pieceOf.begin(), pieceOf.end())));
        FindAccuracy();
        progress(0.6, stage);
        PutSeeds(rests, std::size_t(regions));
    }

    /// The samples, and the dual graph of the patches around them.
    FieldSamples Sample(const Progress &progress) {
        std::vector<Index> seed;
        for (Index u = 0; u < Index(isSeed.size()); ++u)
            if (isSeed[u])
                seed.push_back(u);
        progress(0, stage);
        // A spacing that does not depend on the number of seeds elsewhere.
        patches = GrowPatches(surface.graph, {}, seed, progress.Slice(0, 0.5), 1 / std::sqrt(float(param.moving)));
        for (Index u : patches.center) // also of parts without a seed
            isSeed[u] = 1;

        FieldSamples samples;
        std::vector<Index> sampleOf(std::size_t(patches.Size()), -1), used;
        const auto use = [&](Index patch) {
            Index &sample = sampleOf[patch];
            if (sample < 0) {
                sample = Index(used.size());
                used.push_back(slotOf[std::size_t(patches.center[patch])]);
            }
            return sample;
        };
        if (face.empty())
            for (Index patch = 0; patch < patches.Size(); ++patch)
                use(patch);
        dual = DualOf(patches, surface, face, progress.Slice(0.5, 1));
        for (const auto &corners : dual)
            samples.triangle.push_back({use(corners[0]), use(corners[1]), use(corners[2])});
        const auto n = Eigen::Index(used.size());
        samples.position.resize(3, n);
        samples.displacement.resize(3, n);
        for (Index i : used) {
            const Eigen::Index k = Eigen::Index(samples.gradient.size());
            samples.position.col(k) = rest.col(i);
            samples.displacement.col(k) = deformed.col(i) - rest.col(i);
            samples.gradient.emplace_back(linear[i] - Eigen::Matrix3f::Identity());
        }
        return samples;
    }

    /// Compares samples and deformation at the vertices of pieces that are not done, or only where samples were added.
    /// Adds samples at all vertices that rest and would move, and at the largest error of each octant of a patch.
    /// \return whether all is done
    bool Refine(const DeformationField &field, SampledField &result, const Progress &progress) {
        Compare(field, result, progress);
        progress(1, "Comparing"); // between long walks, where it may be cancelled
        struct PieceErrors {
            Index off = 0, patches = 0;
            std::vector<Index> worst, all; // slots beyond the accuracy: largest of each octant; all
            bool any = false;              // samples were added
        };
        std::vector<PieceErrors> found(pieces.size());
        for (Index center : patches.center)
            ++found[PieceOf(center)].patches;
        constexpr std::size_t octants = 8; // of a patch, around its centre
        std::vector<Index> farthest(octants * std::size_t(patches.Size()), -1);
        std::map<std::pair<std::size_t, std::size_t>, Index> across; // the same in patches of another piece, by piece
        std::vector<Index> added;
        for (std::size_t i = 0; i < counts.size(); ++i) {
            if (!counts[i] || pieces[PieceOf(surface.nodeOf[i])].isDone)
                continue;
            const Index node = surface.nodeOf[i];
            const std::size_t piece = PieceOf(node), patch = std::size_t(patches.patchOf[node]);
            if (Rests(i)) {
                if (error[i] > 0)
                    added.push_back(node);
                continue;
            }
            if (!(error[i] > pieces[piece].accuracy))
                continue;
            ++found[piece].off;
            if (isSeed[node])
                continue;
            found[piece].all.push_back(Index(i));
            const Index center = patches.center[patch];
            const Eigen::Vector3f offset = surface.graph.position.col(node) - surface.graph.position.col(center);
            const std::size_t octant =
                octants * patch + std::size_t(offset[0] > 0) + (offset[1] > 0 ? 2 : 0) + (offset[2] > 0 ? 4 : 0);
            Index &worst = PieceOf(center) == piece ? farthest[octant]
                                                    : across.emplace(std::make_pair(piece, octant), -1).first->second;
            if (worst < 0 || error[i] > error[worst])
                worst = Index(i);
        }
        const auto take = [&](Index i) {
            if (i >= 0)
                found[PieceOf(surface.nodeOf[i])].worst.push_back(i);
        };
        std::for_each(farthest.begin(), farthest.end(), take);
        for (const auto &each : across)
            take(each.second);
        for (PieceErrors &each : found) {
            std::vector<Index> &worst = each.worst;
            if (16 * std::int64_t(each.off) < each.patches) // few: take all, for fewer rounds
                worst = std::move(each.all);
            const Index room = param.most - each.patches;
            const std::size_t wanted =
                room > param.most / 50 ? std::size_t(room) / 2 : 0; // the largest errors, half of the room at a time
            if (worst.size() > wanted) {
                std::sort(worst.begin(), worst.end(), [this](Index a, Index b) {
                    return std::make_pair(-error[a], a) < std::make_pair(-error[b], b);
                });
                worst.resize(wanted);
            }
            for (Index i : worst)
                added.push_back(surface.nodeOf[i]);
        }
        for (Index node : added) {
            found[PieceOf(node)].any |= !isSeed[node];
            isSeed[node] = 1;
        }
        progress(1, "Comparing");
        FindNear(added);
        progress(1, "Comparing");
        bool isDone = true, isCompared = true;
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            Piece &piece = pieces[p];
            isCompared = isCompared && !piece.isDone;
            piece.isDone =
                piece.isDone || (!found[p].any && !piece.isNearby); // done only after all its vertices were compared
            // While more than a few are off, only vertices near new samples are compared in the next round.
            piece.isNearby = found[p].any && 1000 * std::int64_t(found[p].off) > found[p].patches;
            isDone = isDone && piece.isDone;
        }
        if (isDone && !isCompared) // compare all once more: later samples may lie near pieces that were done
            for (Piece &piece : pieces)
                piece.isDone = false;
        return isDone && isCompared;
    }

    double Accuracy() const {
        return std::max_element(pieces.begin(), pieces.end(),
                                [](const Piece &a, const Piece &b) { return a.accuracy < b.accuracy; })
            ->accuracy;
    }

  private:
    static constexpr const char *stage = "Sampling";

    /// A region, or a moving part of a handle, or a loose part. The first piece is all the rest.
    struct Piece {
        double accuracy = 0;
        bool isNearby = false; ///< compared only where samples were added
        bool isDone = false;
    };

    std::size_t PieceOf(Index node) const { return std::size_t(pieceOf[node]); }

    /// Numbers the pieces that move and are in no region, from \p next on. Each handle has pieces of its own, so that
    /// they do not depend on the motion of others.
    void NumberOthers(const std::vector<char> &rests, Index next) {
        const auto isOther = [&](Index u) { return pieceOf[u] < 0 && !rests[u]; };
        DisjointSets joined(surface.graph.Size());
        for (Index u = 0; u < surface.graph.Size(); ++u)
            if (isOther(u))
                for (Index v : surface.graph.adjacency[u])
                    if (v < u && isOther(v) && pieceOf[v] == pieceOf[u])
                        joined.Join(u, v);
        const std::vector<Index> root = joined.TakeRoots(); // the first of its nodes
        for (Index u = 0; u < Index(root.size()); ++u)
            if (isOther(u))
                pieceOf[u] = root[u] == u ? next++ : pieceOf[std::size_t(root[u])];
            else
                pieceOf[u] = std::max(pieceOf[u], Index(0));
    }

    void FindAccuracy() {
        struct Extent {
            Eigen::AlignedBox3d box;
            double motion = 0, farthest = 0;
        };
        std::vector<Extent> extent(pieces.size());
        for (std::size_t i = 0; i < surface.nodeOf.size(); ++i)
            if (surface.nodeOf[i] >= 0 && !Rests(i)) {
                Extent &grown = extent[PieceOf(surface.nodeOf[i])];
                const Eigen::Vector3d from = rest.col(Eigen::Index(i)), to = deformed.col(Eigen::Index(i));
                grown.box.extend(from);
                grown.motion = std::max(grown.motion, (to - from).norm());
                grown.farthest = std::max({grown.farthest, from.cwiseAbs().maxCoeff(), to.cwiseAbs().maxCoeff()});
            }
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            const Extent &piece = extent[p];
            const double automatic =
                piece.box.isEmpty() ? 0 : std::min(1e-4 * piece.box.diagonal().norm(), piece.motion / 50);
            pieces[p].accuracy = std::max(param.accuracy > 0 ? param.accuracy : automatic,
                                          4 * std::numeric_limits<double>::epsilon() * piece.farthest); // rounding
        }
    }

    /// Chooses the first samples. \param rests flags of nodes \param regions number of regions, the pieces after the
    /// first
    void PutSeeds(const std::vector<char> &rests, std::size_t regions) {
        // A wall of samples around what moves, and between pieces. No triangle joins what moves with what rests behind
        // the wall, and triangles of two pieces only join their walls.
        isSeed.assign(rests.size(), 0);
        std::vector<std::vector<Index>> moving(pieces.size()); // nodes of each piece
        for (Index u = 0; u < Index(rests.size()); ++u) {
            if (!rests[u])
                moving[PieceOf(u)].push_back(u);
            for (Index v : surface.graph.adjacency[u])
                isSeed[u] |= char((rests[u] && !rests[v]) || PieceOf(u) != PieceOf(v));
        }
        std::vector<float> area;
        for (std::size_t p = 0; p < moving.size(); ++p) {
            const std::vector<Index> &nodes = moving[p];
            area.clear();
            for (Index u : nodes)
                area.push_back(surface.nodeArea[u]);
            // A handle's piece mostly moves by one map: it gets samples by its share of the area only.
            const double own = std::accumulate(area.begin(), area.end(), 0.0);
            const Index most =
                p > regions && surface.area > 0 ? Index(param.moving * (own / surface.area)) + 1 : param.moving;
            for (Index k : RandomSample(area, std::min(param.moving, most), 1))
                isSeed[std::size_t(nodes[k])] = 1;
        }
        // Chosen on all the surface, so that they do not depend on what moves.
        for (Index u : RandomSample(surface.nodeArea, param.resting, 1))
            isSeed[u] |= rests[u];
    }

    /// Sets error, and the figures of \p result.
    void Compare(const DeformationField &field, SampledField &result, const Progress &progress);

    /// Sets isNear. \param added nodes with new samples
    void FindNear(const std::vector<Index> &added);

    bool Rests(std::size_t i) const {
        return rest.col(Eigen::Index(i)) == deformed.col(Eigen::Index(i)) && linear[i] == Eigen::Matrix3f::Identity();
    }

    const SurfaceGraph &surface;
    const std::vector<std::array<Index, 3>> face;
    const Eigen::Matrix3Xd &rest, &deformed;
    const std::vector<Eigen::Matrix3f> &linear;
    const FieldParam &param;
    std::vector<Piece> pieces;
    std::vector<Index> pieceOf; ///< of each node
    std::vector<char> counts;   ///< flags of slots: corners of faces, or all points of a cloud
    std::vector<Index> slotOf;  ///< of each node: its first slot
    std::vector<char> isSeed;   ///< flags of nodes
    std::vector<float> error;   ///< of each slot, as compared last
    std::vector<char> isNear;   ///< flags of slots: in patches with new samples, or beside these
    Patches patches;
    std::vector<std::array<Index, 3>> dual; ///< of the patches
};

} // namespace vcg::fcd::detail

#endif
