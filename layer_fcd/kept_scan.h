// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_KEPT_SCAN_H
#define FCD_KEPT_SCAN_H

#include <vcg_ext/base/point_tree.h> // before Qt

#include "meshlab_host.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

/// Colours and quality of a layer as they were before tags took their place, by vertex, with the places that the
/// vertices had then: what is new since lies on that surface. Who changes it changes the number in its name.
struct KeptScan {
    static const char *const name;

    bool color = false, quality = false;       ///< kept, or known not to have been there
    bool hadColor = false, hadQuality = false; ///< and there was some
    bool countedQuality = false;               ///< the layer said that it had some, be it 0
    vcg::Color4b lowColor, highColor;          ///< of the tags, by channel
    double lowTag = 0, highTag = 0;            ///< with 0, which vertices have that nothing has given a quality
    std::uint64_t faces = 0;                   ///< facesOf the mesh then
    std::size_t vertexSlots = 0;               ///< of the mesh then
    std::vector<Point3m> places;
    std::vector<vcg::Color4b> colors;
    std::vector<CVertexO::QualityType> qualities;
};

/// What a vertex knows of that, zero for one that something else makes. Who changes it changes the number in its name.
struct TaggedVertex {
    static const char *const name;

    std::uint32_t number; ///< of its place among those that are kept, from 1; 0: none
    std::uint32_t color;  ///< that it got by its tag
    bool hasColor, hasQuality;
};

/// A number for a colour.
std::uint32_t numberOf(const vcg::Color4b &color);

/// What is kept of the vertices that a layer has now. Where vertices and faces are not those that were tagged, a vertex
/// is one of these if all were moved alike, or it is no farther from its place, or from where a pose left it, than half
/// its longest edge: something that makes all vertices anew leaves them the numbers of others.
class KeptVertices {
  public:
    /// \pre the layer has a KeptScan and a TaggedVertex each
    explicit KeptVertices(const MeshModel &layer);

    /// Whether a vertex is one of those that were tagged.
    bool isOld(std::size_t i) const { return isKnown[i] != 0; }
    /// The colour of its tag.
    std::uint32_t colorNumber(std::size_t i) const { return tagged[i].color; }

    bool isColorOfTag(std::size_t i) const { return isOld(i) && tagged[i].hasColor && wasColor(i); }
    bool isQualityTag(std::size_t i) const { return areTags && isOld(i) && tagged[i].hasQuality; }
    /// The colour of before, of a vertex that has the colour of a tag. A new one that has a mixture of these has what
    /// was at its place, where the layer has the shape still that it was tagged in.
    std::optional<vcg::Color4b> color(std::size_t i) const;
    /// The same, of the quality.
    std::optional<CVertexO::QualityType> quality(std::size_t i) const;

  private:
    struct Near {
        std::size_t kept;
        double weight; ///< they sum to 1
    };
    bool wasColor(std::size_t i) const { return tagged[i].color == numberOf(mesh.vert[i].cC()); }
    const Point3m &placeOf(std::size_t i) const { return scan.places[tagged[i].number - 1]; }
    std::optional<Eigen::Affine3d> moveOfAll() const;
    std::vector<Near> nearTo(std::size_t i) const;

    const KeptScan &scan;
    const CMeshO &mesh;
    const TaggedVertex *const tagged;
    std::vector<char> isKnown;
    std::vector<Eigen::Vector3d> points; ///< kept places, where something is new
    std::unique_ptr<vcg::fcd::PointTree<double>> tree;
    bool areTags;
};

#endif
