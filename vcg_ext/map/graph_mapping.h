// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_MAPPING_H
#define VCG_FCD_GRAPH_MAPPING_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/map/mapping_kernel.h>
#include <vcg_ext/map/mapping_weights.h>
#include <vcg_ext/patches/patch_sampling.h>
#include <vcg_ext/shape_constants.h>
#include <vcg_ext/solve/graph_pose.h>
#include <vcg_ext/surface/surface_graph.h>

#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace vcg::fcd {

class MappingCandidates;
class ConstraintBlend;

/// Carries the motion of the deformation graph's nodes over to the nodes of the surface (paper, sec. 2.3, Eqs. 7 and
/// 8).
///
/// p' = sum_j w_j(p) ((R_j + R(p)) / 2 (p - c_j) + c'_j), weights normalised to sum one, w_j falling smoothly to zero
/// at `influence` times the radius of j's patch, and R(p) = sum_j w_j(p) R_j. (The paper has R_j alone, which is of
/// first order from node to vertex and leaves ripples of patch size where the surface bends; the mean of the two ends
/// is of second order, as the trapezoidal rule is.) Near a held region, the blend runs over into that region's own
/// motion, with continuous tangents at its border, so that held nodes are exact and no crease is left there. Small held
/// parts may lie in patches of free nodes.
///
/// As printed, it is p' = sum_j w_j(p) (R_j (p - c_j) + c'_j), w_j = (1 - |p - c_j| / d_j)^2 inside the patch's radius
/// d_j by the straight distance, and nothing runs over.
class GraphMapping {
  public:
    /// \param tag tag of each surface node: 0 fixed, 1 free, else handle
    /// \param influence node radius over patch radius, > 1
    /// \param fade greatest width of the run-over into held regions along the surface, units of the positions
    /// \param beyond without smoothMapping by Eqs. 7 and 8 to the letter; influence and fade are not read then
    GraphMapping(const Graph &surface, const std::vector<Index> &tag, const Patches &patches,
                 const DeformationGraph &graph, MappingWeights weights, double influence, double fade,
                 const Progress &progress = {}, const ShapeConstants &shape = {},
                 const BeyondPaper &beyond = BeyondPaper());
    ~GraphMapping();
    GraphMapping(const GraphMapping &) = delete;
    GraphMapping &operator=(const GraphMapping &) = delete;

    /// What a free node of the surface follows.
    struct Influences {
        std::vector<std::pair<Index, float>> nodes; ///< of the graph, and their weights
        std::vector<std::pair<Index, float>> held;  ///< tags whose motion it runs over into, and their weights
    };

    /// \param influences out: all weights are > 0 and their sum is 1
    void InfluencesAt(Index node, Influences &influences) const;

    /// The mapping of one pose: from a place on the surface, and the position of a vertex there, to where that goes.
    class Posed {
      public:
        /// Vertices that are mapped, and memory that many calls of Map use again.
        struct Scratch {
            detail::Vertices vertices;
            detail::Blending blending;
            std::vector<float> weight, shareWeight, strainTerm;
            std::vector<std::uint32_t> active, shareActive;
            alignas(64) float strain[detail::terms][detail::lanes];

            template <class T>
            static T *AtLeast(std::vector<T> &memory, std::size_t size) {
                if (memory.size() < size)
                    memory.resize(size);
                return memory.data();
            }
            static auto Rows(std::vector<float> &memory, std::size_t rows) {
                return reinterpret_cast<float(*)[detail::lanes]>(AtLeast(memory, rows * detail::lanes));
            }
        };

        /// \param node of the surface \param p mesh units
        /// \param linear if given: how the surface around the vertex turns and stretches
        Eigen::Vector3d operator()(Index node, const Eigen::Vector3d &p, Eigen::Matrix3f *linear = nullptr) const;

        /// Maps \p count vertices, detail::lanes at most, at free nodes of one patch: those of \p scratch.
        /// \param linear whether to give their linear maps, too
        void Map(const Index *node, int count, bool linear, Scratch &scratch) const;

        /// As of At.
        Posed(const GraphMapping &mapping, const GraphPose &pose, const std::map<Index, Eigen::Affine3d> &inFrame,
              const Frame &frame, unsigned threads);
        Posed(const Posed &) = delete;
        Posed &operator=(const Posed &) = delete;

      private:
        friend class GraphMapping;

        void MapAsPrinted(Index node, int lane, bool linear, detail::Vertices &vertices) const;
        void SumStrain(Scratch &scratch) const;
        void RunIntoHeld(Index node, int lane, bool linear, Scratch &scratch) const;
        Eigen::Vector3d RestOf(Index j) const;
        void SetOwn(Index j, const GraphPose &pose, const Frame &frame);
        void SetTerms(Index patch, const GraphPose &pose);

        const GraphMapping &mapping;
        std::map<Index, Eigen::Affine3d> motion;         // of each held tag, mesh units
        std::vector<const Eigen::Affine3d *> heldMotion; // of each of constraintBlend.heldTag
        std::vector<Eigen::Matrix3f> unstretched; // of each: what takes back how it stretches; empty: not asked for
        std::vector<detail::PatchMotion> own;     // of each node
        std::vector<Eigen::Matrix3f> nodeStrain;  // stretch minus identity
        /// Of each candidate, about the patch's centre: columns of the 3 x 4 affine map by which it moves otherwise
        /// than the patch's node, the way to it, 1; in the frame.
        std::vector<float> term;
        detail::Space space;
    };

    /// \param motion of each held tag, 0 included, in the frame
    /// \param frame of the surface; by default all is in the frame \param threads 0 = one a core
    /// The mapping must outlive the result.
    Posed At(const GraphPose &pose, const std::map<Index, Eigen::Affine3d> &motion, const Frame &frame = {},
             unsigned threads = 0) const {
        return Posed(*this, pose, motion, frame, threads);
    }

  private:
    void PutCandidates(Index patch, Posed::Scratch &scratch) const;
    template <class Add>
    void ForPrintedWeights(Index node, const Add &add) const;

    const Graph &surface;
    const std::vector<Index> &tag;
    const Patches &patches;
    const DeformationGraph &graph;
    const bool isSmooth;
    const std::unique_ptr<const MappingCandidates> candidates;
    const std::unique_ptr<const ConstraintBlend> constraintBlend;
};

} // namespace vcg::fcd

#endif
