// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/contact/crossing_faces.h>
#include <vcg_ext/contact/surface_contact.h>
#include <vcg_ext/surface/box_tree.h>
#include <vcg_ext/surface/triangle_tree.h>
#include <vcg_ext/surface/vertex_welding.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <utility>

namespace vcg::fcd {

namespace {

using detail::TwoShapes;
constexpr const char *stage = "Measuring contact";

/// The pieces of a surface if the faces that pass through others are left out.
class Pieces {
  public:
    /// \param crosses per face: whether it passes through another, also through one beside it
    Pieces(const TwoShapes &shape, const std::vector<char> &crosses, const std::vector<detail::Pinch> &pinches,
           const Progress &progress)
        : nodeOf(shape.mesh.vertexSlots, -1) {
        const Index nodes = Weld(shape, progress);
        isPinched.assign(std::size_t(nodes), 0);
        for (const detail::Pinch &each : pinches)
            for (const std::uint32_t slot : each.slot)
                if (nodeOf[slot] >= 0)
                    isPinched[std::size_t(nodeOf[slot])] = 1;
        DisjointSets joined(nodes), all(nodes);
        ForFaces(shape, [&](std::size_t f) {
            for (std::size_t k = 0; k < 3; ++k) {
                const Index a = nodeOf[shape.Corner(f, k)], b = nodeOf[shape.Corner(f, (k + 1) % 3)];
                all.Join(a, b);
                if (!crosses[f] && !isPinched[std::size_t(a)] && !isPinched[std::size_t(b)])
                    joined.Join(a, b);
            }
        });
        const std::vector<Index> part = all.TakeRoots();
        pieceOf = joined.TakeRoots();
        std::vector<double> area(std::size_t(nodes), 0);
        ForFaces(shape, [&](std::size_t f) {
            if (!crosses[f]) {
                const detail::Corners3 c = shape.CornersAtRest(f);
                std::size_t k = 0; // a corner that is not pinched, if there is one
                while (k < 2 && isPinched[std::size_t(nodeOf[shape.Corner(f, k)])])
                    ++k;
                area[std::size_t(Of(shape.Corner(f, k)))] += (c[1] - c[0]).cross(c[2] - c[0]).norm();
            }
        });
        main.assign(std::size_t(nodes), -1);
        for (Index u = 0; u < nodes; ++u)
            if (Index &largest = main[std::size_t(part[u])];
                pieceOf[u] == u && (largest < 0 || area[u] > area[largest]))
                largest = u;
        for (Index u = 0; u < nodes; ++u) // ascending: a part's number is its first node
            main[u] = main[std::size_t(part[u])];
    }

    /// The piece of a vertex slot, -1 for none.
    Index Of(std::size_t slot) const { return nodeOf[slot] < 0 ? -1 : pieceOf[std::size_t(nodeOf[slot])]; }
    /// Whether a vertex is in another piece than the largest one of its connected part.
    /// Pinched ones are in none.
    bool IsCutOff(std::size_t slot) const {
        return nodeOf[slot] >= 0 && !isPinched[std::size_t(nodeOf[slot])] &&
               Of(slot) != main[std::size_t(nodeOf[slot])];
    }

    /// body(f) for each face with three nodes, ascending.
    template <class Body>
    void ForFaces(const TwoShapes &shape, const Body &body) const {
        for (std::size_t f = 0; f < shape.mesh.faces; ++f)
            if (shape.mesh.IsFace(f) && nodeOf[shape.Corner(f, 0)] >= 0 && nodeOf[shape.Corner(f, 1)] >= 0 &&
                nodeOf[shape.Corner(f, 2)] >= 0)
                body(f);
    }

  private:
    /// Welds vertices at the same rest position into nodes. \return number of nodes
    Index Weld(const TwoShapes &shape, const Progress &progress) {
        Eigen::AlignedBox3d box;
        std::size_t count = 0;
        for (std::size_t i = 0; i < nodeOf.size(); ++i)
            if (shape.IsUsable(i)) {
                box.extend(shape.Rest(i));
                ++count;
            }
        const double size = std::max(box.diagonal().norm(), 1e-300);
        detail::VertexWelder welder(count, nodeOf.size());
        std::size_t at = 0;
        for (std::size_t i = 0; i < nodeOf.size(); ++i)
            if (shape.IsUsable(i)) // + 0: no negative zeros
                welder.Put(at++, i, ((shape.Rest(i) - box.center()) / size).cast<float>() + Eigen::Vector3f::Zero());
        welder.Sort(progress.Slice(0, 0.4));
        welder.FindNodes([](std::uint32_t) { return false; }, progress.Slice(0.4, 0.8));
        const Index nodes = welder.Nodes();
        welder.ForEach([&](Index node, std::uint32_t slot, std::size_t) { nodeOf[slot] = node; },
                       progress.Slice(0.8, 1));
        return nodes;
    }

    std::vector<Index> nodeOf;        ///< per vertex slot
    std::vector<char> isPinched;      ///< per node: a line of contact ends there, so no piece goes through it
    std::vector<Index> pieceOf, main; ///< per node: its piece, and the largest piece of its connected part
};

/// Triangles of the posed surface with corners of their own, and a tree that finds the nearest one. World units.
struct Triangles {
    std::vector<Eigen::Vector3d> corner;
    std::vector<std::array<Index, 3>> triangle, piece; ///< corners, and the piece of each corner
    Index own = -1;                                    ///< the piece, if all are of one
    Eigen::AlignedBox3d box;
    Eigen::Matrix3Xd position;
    std::unique_ptr<const detail::TriangleTree> tree;

    void Add(const TwoShapes &shape, const Pieces &pieces, std::size_t f) {
        const auto first = Index(corner.size());
        triangle.push_back({first, first + 1, first + 2});
        piece.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
            corner.push_back(shape.Now(shape.Corner(f, k)));
            piece.back()[k] = pieces.Of(shape.Corner(f, k));
            box.extend(corner.back());
        }
    }
    void Sort(const Progress &progress) {
        position = Eigen::Map<const Eigen::Matrix3Xd>(corner.front().data(), 3, Eigen::Index(corner.size()));
        tree = std::make_unique<const detail::TriangleTree>(position, std::move(triangle), progress);
    }
};

/// Sets the depth of vertices of cut-off pieces: the distance from the nearest triangle of another cut-off piece, or
/// the nearest crossing face without a corner in the vertex's own piece. If a piece passes through itself, as both
/// sides of a crease do, what faces the other way counts, too: of the piece, and of the crossing faces.
void MeasurePieces(const TwoShapes &shape, const std::vector<detail::Crossing> &pairs,
                   const std::vector<detail::Pinch> &pinches, std::vector<char> crosses, SurfaceContact &contact,
                   const Progress &progress) {
    for (const detail::Pinch &each : pinches)
        crosses[each.face[0]] = crosses[each.face[1]] = 1;
    const Pieces pieces(shape, crosses, pinches, progress.Slice(0, 0.3));
    Triangles crossing;
    std::vector<Triangles> cut; // the pieces that are cut off, in the order of their first faces
    std::map<Index, std::size_t> numberOf;
    std::set<Index> throughThemselves;
    for (const detail::Crossing &each : pairs)
        for (std::size_t k = 0; k < 3; ++k)
            for (std::size_t l = 0; l < 3; ++l) {
                const std::uint32_t a = shape.Corner(each.face[0], k), b = shape.Corner(each.face[1], l);
                if (pieces.IsCutOff(a) && pieces.Of(a) == pieces.Of(b))
                    throughThemselves.insert(pieces.Of(a));
            }
    std::vector<Eigen::Vector3d> normal(throughThemselves.empty() ? 0 : contact.depth.size(), Eigen::Vector3d::Zero());
    pieces.ForFaces(shape, [&](std::size_t f) {
        if (!normal.empty()) {
            const detail::Corners3 c = shape.CornersNow(f);
            for (std::size_t k = 0; k < 3; ++k)
                normal[shape.Corner(f, k)] += (c[1] - c[0]).cross(c[2] - c[0]);
        }
        if (crosses[f])
            crossing.Add(shape, pieces, f);
        else
            for (std::size_t k = 0; k < 3; ++k)
                if (pieces.IsCutOff(shape.Corner(f, k))) {
                    const auto [found, isNew] = numberOf.emplace(pieces.Of(shape.Corner(f, k)), cut.size());
                    if (isNew)
                        cut.emplace_back().own = found->first;
                    cut[found->second].Add(shape, pieces, f);
                    break;
                }
    });
    crossing.Sort(progress.Slice(0.3, 0.4));
    ParallelTasks(progress.Slice(0.4, 0.6), stage, cut.size(),
                  [&](std::size_t i, const Progress &own) { cut[i].Sort(own); });
    const auto boxOf = [&](std::size_t i) -> const Eigen::AlignedBox3d & { return cut[i].box; };
    const detail::BoxTree<decltype(boxOf)> boxes(cut.size(), boxOf);
    ParallelForEach(progress.Slice(0.6, 1), stage, contact.depth.size(), 1 << 8, [&](std::size_t i) {
        if (!pieces.IsCutOff(i))
            return;
        const Index own = pieces.Of(i);
        const Eigen::Vector3d p = shape.Now(i);
        double square = crossing.tree
                            ->Among(p,
                                    [&](Index t) {
                                        const auto &three = crossing.piece[t];
                                        return three[0] != own && three[1] != own && three[2] != own;
                                    })
                            .square;
        const Eigen::Vector3d reach = Eigen::Vector3d::Constant(std::sqrt(square));
        boxes.ForMeeting({p - reach, p + reach}, [&](std::size_t c) {
            if (cut[c].own != own && cut[c].box.squaredExteriorDistance(p) < square)
                square = std::min(square, (*cut[c].tree)(p, -1).square);
        });
        const auto takeOpposite = [&](const Triangles &among) {
            const auto facing = among.tree->Facing(p, -normal[i], std::sqrt(square));
            if (facing.triangle >= 0)
                square = std::min(square, facing.square);
        };
        if (throughThemselves.count(own) != 0) {
            takeOpposite(crossing);
            if (const auto number = numberOf.find(own); number != numberOf.end())
                takeOpposite(cut[number->second]);
        }
        if (square < std::numeric_limits<double>::max()) // else all crossing faces are at its own border
            contact.depth[i] = std::sqrt(square);
    });
}

} // namespace

SurfaceContact FindContact(const SurfaceView &mesh, const PositionsRef &position, const Eigen::Matrix3d &metric,
                           double apart, const Progress &progress) {
    SurfaceContact contact;
    const TwoShapes shape(mesh, position, metric);
    std::vector<detail::Pinch> pinches;
    const std::vector<detail::Crossing> crossing = detail::FindCrossings(shape, apart, pinches, progress.Slice(0, 0.8));
    contact.pairs = std::int64_t(crossing.size());
    if (crossing.empty())
        return contact;
    std::vector<char> crosses(mesh.faces, 0);
    for (const detail::Crossing &each : crossing)
        crosses[each.face[0]] = crosses[each.face[1]] = 1;
    for (std::size_t f = 0; f < mesh.faces; ++f)
        if (crosses[f])
            contact.face.push_back(std::uint32_t(f));
    contact.depth.assign(mesh.vertexSlots, 0);
    MeasurePieces(shape, crossing, pinches, crosses, contact, progress.Slice(0.8, 1));
    for (const detail::Crossing &each : crossing)
        for (std::uint32_t f : each.face)
            for (std::size_t k = 0; k < 3; ++k) {
                double &depth = contact.depth[shape.Corner(f, k)];
                depth = std::max(depth, each.through);
            }
    contact.largest = *std::max_element(contact.depth.begin(), contact.depth.end());
    return contact;
}

std::string SurfaceContact::Text() const {
    if (face.empty())
        return {};
    std::ostringstream line;
    line << face.size() << " triangles pass through others and did not at rest: the surface reaches up to " << largest
         << " into itself.";
    return line.str();
}

} // namespace vcg::fcd
