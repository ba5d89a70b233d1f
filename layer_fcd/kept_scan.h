// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_SCAN_H
#define FCD_KEPT_SCAN_H

#include <vcg_ext/base/point_tree.h> // before Qt

#include "layer_state.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

/// A number for a colour.
std::uint32_t numberOf(const vcg::Color4b &color);

/// What is kept of the vertices that a layer has now. Where vertices and faces are not those that were tagged, a vertex
/// is one of these if all were moved alike, or it is no farther from its place, or from where a pose left it, than half
/// its longest edge: something that makes all vertices anew leaves them the numbers of others.
class KeptVertices {
  public:
    /// \param scan of the layer, which must outlive this
    KeptVertices(const MeshModel &layer, const KeptScan &scan);

    /// Whether a vertex is one of those that were tagged.
    bool isOld(std::size_t i) const { return isKnown[i] != 0; }
    /// The colour of its tag.
    std::uint32_t tagColor(std::size_t i) const { return isOld(i) ? vertexOf(i).tagColor : 0; }

    bool isColorOfTag(std::size_t i) const {
        return isOld(i) && vertexOf(i).hasColor && vertexOf(i).tagColor == numberOf(mesh.vert[i].cC());
    }
    bool isQualityTag(std::size_t i) const { return areTags && isOld(i) && vertexOf(i).hasQuality(); }
    /// The colour before tagging, of a vertex that has the colour of its tag. A new vertex with a mixture of such
    /// colours gets what was at its place, if the layer still has the shape in which it was tagged.
    std::optional<vcg::Color4b> color(std::size_t i) const;
    /// The same, of the quality.
    std::optional<CVertexO::QualityType> quality(std::size_t i) const;

  private:
    struct Near {
        std::size_t kept;
        double weight; ///< they sum to 1
    };
    const TaggedVertex &vertexOf(std::size_t i) const { return scan.vertices[scan.number[i] - 1]; }
    std::optional<Eigen::Affine3d> moveOfAll() const;
    std::vector<Near> nearTo(std::size_t i) const;

    const KeptScan &scan;
    const CMeshO &mesh;
    std::vector<char> isKnown;
    std::vector<Eigen::Vector3d> points; ///< kept places, where something is new
    std::unique_ptr<vcg::fcd::PointTree<double>> tree;
    bool areTags;
};

#endif
