// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_UNKNOWNS_H
#define VCG_FCD_GRAPH_UNKNOWNS_H

#include <vcg_ext/base/graph.h>

#include <vector>

namespace vcg {
namespace fcd {
namespace detail {

/// Which positions and rotations of a graph's k nodes are unknown. A component without a constrained node has none.
struct GraphUnknowns {
    std::vector<char> constrained;  ///< k flags: the position is given
    std::vector<char> turns;        ///< k flags: of constrained nodes whose rotation is not
    std::vector<Index> componentOf; ///< k
    std::vector<char> held;         ///< flags of the components: there is a constrained node in it
    std::vector<Index> position;    ///< nodes whose position is unknown
    std::vector<Index> numberOf;    ///< k, which of these a node is, -1 for none of them
    std::vector<Index> rotation;    ///< nodes whose rotation is unknown: the same, and constrained ones that turn

    /// \param turns may be empty: none
    GraphUnknowns(const Csr &graph, const std::vector<bool> &constrained, const std::vector<bool> &turns)
        : constrained(constrained.begin(), constrained.end()), turns(turns.begin(), turns.end()) {
        const Index k = graph.Size();
        this->turns.resize(k, false);
        held.assign(ConnectedComponents(graph, componentOf), false);
        for (Index i = 0; i < k; ++i)
            if (constrained[i])
                held[componentOf[i]] = true;
        numberOf.assign(k, -1);
        for (Index i = 0; i < k; ++i)
            if (!constrained[i] && IsHeld(i)) {
                numberOf[i] = Index(position.size());
                position.push_back(i);
            }
        rotation = position;
        for (Index i = 0; i < k; ++i)
            if (constrained[i] && this->turns[i])
                rotation.push_back(i);
    }

    /// Whether node \p i is in a component with a constrained node.
    bool IsHeld(Index i) const { return held[componentOf[i]]; }
    /// Whether the rotation of node \p i is given.
    bool IsTurned(Index i) const { return constrained[i] && !turns[i]; }
};

} // namespace detail
} // namespace fcd
} // namespace vcg

#endif
