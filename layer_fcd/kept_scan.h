// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_SCAN_H
#define FCD_KEPT_SCAN_H

#include <vcg_ext/base/point_tree.h> // before Qt

#include "layer_state.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

/// A colour as a number.
std::uint32_t numberOf(const vcg::Color4b &color);

/// What is kept aside for the present vertices of a layer. If the mesh has changed since tagging, a vertex is
/// recognised if all were moved alike, or if it is within half its longest edge of its position when tagged, or after a
/// pose. (Filters that make all vertices anew leave them the numbers of others.)
class KeptVertices {
  public:
    /// \param scan of the layer, which must outlive this
    KeptVertices(const MeshModel &layer, const KeptScan &scan);

    /// Whether a vertex is one that was tagged.
    bool isOld(std::size_t i) const { return isKnown[i] != 0; }
    /// The colour of its tag.
    std::uint32_t tagColor(std::size_t i) const { return isOld(i) ? vertexOf(i).tagColor : 0; }

    bool isColorOfTag(std::size_t i) const {
        return isOld(i) && vertexOf(i).hasColor && vertexOf(i).tagColor == numberOf(mesh.vert[i].cC());
    }
    bool isQualityTag(std::size_t i) const { return areTags && isOld(i) && vertexOf(i).hasQuality(); }
    /// The colour before tagging of a vertex that has the colour of its tag. A new vertex with a mixture of tags'
    /// colours gets the colour at its position, if the layer still has the shape in which it was tagged.
    std::optional<vcg::Color4b> color(std::size_t i) const;
    /// The same for the quality.
    std::optional<CVertexO::QualityType> quality(std::size_t i) const;

  private:
    struct Near {
        std::size_t kept;
        double weight; ///< they sum to 1
    };
    const TaggedVertex &vertexOf(std::size_t i) const { return scan.vertices[scan.number[i] - 1]; }
    std::vector<Near> nearTo(std::size_t i) const;

    const KeptScan &scan;
    const CMeshO &mesh;
    std::vector<char> isKnown;
    std::vector<Eigen::Vector3d> points; ///< positions when tagged, if there are new vertices
    std::unique_ptr<vcg::fcd::PointTree<double>> tree;
    bool areTags;
};

#endif
