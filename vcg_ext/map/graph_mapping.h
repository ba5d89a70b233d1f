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

/// Maps the motion of the deformation graph's nodes to the nodes of the surface (paper, sec. 2.3, Eqs. 7 and 8).
///
/// p' = sum_j w_j(p) ((R_j + R(p)) / 2 (p - c_j) + c'_j), with R(p) = sum_j w_j(p) R_j. The weights w_j sum to 1; they
/// fall smoothly to 0 at `influence` times the radius of j's patch. (The paper has R_j instead of the mean with R(p).
/// That is of first order from node to vertex, and leaves ripples of patch size where the surface bends. The mean is of
/// second order, like the trapezoidal rule.) Near a held region, this is blended into the region's own motion, with
/// continuous tangents at the border: held nodes are exact, without a crease. Small held parts may lie in patches of
/// free nodes.
///
/// As printed, p' = sum_j w_j(p) (R_j (p - c_j) + c'_j), w_j = (1 - |p - c_j| / d_j)^2 within the radius d_j of j's
/// patch, by straight distance, without a blend into held regions.
class GraphMapping {
  public:
    /// \param tag tag of each surface node: 0 fixed, 1 free, else handle
    /// \param influence node radius over patch radius, > 1 \param fade greatest width of the blend into held regions
    /// along the surface, units of the positions \param beyond without smoothMapping: as printed, and influence and
    /// fade are not read
    GraphMapping(const Graph &surface, const std::vector<Index> &tag, const Patches &patches,
                 const DeformationGraph &graph, MappingWeights weights, double influence, double fade,
                 const Progress &progress = {}, const ShapeConstants &shape = {},
                 const BeyondPaper &beyond = BeyondPaper());
    ~GraphMapping();
    GraphMapping(const GraphMapping &) = delete;
    GraphMapping &operator=(const GraphMapping &) = delete;

    /// What moves a free node of the surface.
    struct Influences {
        std::vector<std::pair<Index, float>> nodes; ///< nodes of the graph, with weights
        std::vector<std::pair<Index, float>> held;  ///< tags of held regions, with weights
    };

    /// \param influences out: all weights are > 0 and their sum is 1
    void InfluencesAt(Index node, Influences &influences) const;

    /// The mapping of one pose.
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

        /// \param node of the surface
        /// \param p position of a vertex there, mesh units \param linear if not null, out: the linear map of the
        /// surface there, mesh units \return its position in the pose, mesh units
        Eigen::Vector3d operator()(Index node, const Eigen::Vector3d &p, Eigen::Matrix3f *linear = nullptr) const;

        /// Maps the first \p count vertices of \p scratch, detail::lanes at most, at free nodes of one patch.
        /// \param node of each vertex \param linear whether to set their linear maps, too
        void Map(const Index *node, int count, bool linear, Scratch &scratch) const;

        /// Parameters as in At.
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
        std::vector<const Eigen::Affine3d *> heldMotion; // of each of constraintBlend->heldTag
        std::vector<Eigen::Matrix3f> unstretched; // of each: inverse of its stretch; empty unless the pose is affine
        std::vector<detail::PatchMotion> own;     // of each node of the graph
        std::vector<Eigen::Matrix3f> nodeStrain;  // of each: stretch minus identity
        /// detail::terms numbers of each candidate, frame units: the difference of its affine map from that of the
        /// patch's node, about the patch's centre (3 x 4, column by column); the vector from the patch's centre to the
        /// candidate's; 1.
        std::vector<float> term;
        detail::Space space;
    };

    /// The mapping of a pose; this must outlive it. \param motion of each held tag, with 0, frame units \param frame of
    /// the surface; the default: mesh units are frame units \param threads 0 = one a core
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
