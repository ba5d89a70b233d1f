// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_ASIDE_H
#define FCD_KEPT_ASIDE_H

#include <vcg_ext/base/point_tree.h> // before Qt

#include "layer_state.h"
#include "meshlab_host.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

/// \file
/// Colours and quality of a layer, kept aside while tags replace them. They are kept for each vertex. So vertices that
/// something else has coloured or made since are recognised.

/// Call it before tags replace colours (\p color) or quality (\p quality): keeps these aside. If earlier tags have
/// replaced them already, the older ones stay kept.
void keepAside(const MeshDocument &document, MeshModel &layer, bool color, bool quality);

/// Call it after each keepAside(): remembers the new tags of \p layer. \param tag one per vertex slot
/// \param color, quality whether they are shown as colours, and are the layer's quality
void takeTags(const MeshModel &layer, const std::vector<int> &tag, bool color, bool quality);

/// Numbers of vertices that bringBack did not simply restore.
struct BroughtBack {
    int others = 0; ///< vertices that keep what they have
    int placed = 0; ///< new vertices, which got what was at their position
};

/// Drops the marks of \p layer, and restores its colours and quality, or its lack of these. Vertices that something
/// else has coloured since keep their colours. So do new vertices, unless they lie on the surface that was tagged.
/// \throw vcg::fcd::Error nothing is kept
BroughtBack bringBack(const MeshDocument &document, MeshModel &layer);

/// Gives \p copy, of the live vertices of \p layer, the colours and quality that are kept aside for \p layer. If there
/// were no colours, it has none; if there was no quality, it has the tags.
void bringBackTo(const MeshDocument &document, MeshModel &copy, const MeshModel &layer);

/// The colours that bringBackTo gives a copy, by slots of \p layer; empty: none.
std::vector<vcg::Color4b> ownColors(const MeshDocument &document, const MeshModel &layer);

/// The tags that a filter wrote into the quality of \p layer, one per vertex slot, whatever its quality is now. New
/// vertices are free, and so are all if none wrote any.
std::vector<int> writtenTags(const MeshModel &layer);

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
    /// The tag that was written into its quality; 1, free, if none was.
    int tag(std::size_t i) const { return isOld(i) && vertexOf(i).hasQuality() ? vertexOf(i).tag : 1; }
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
