// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_GRAPH_UNKNOWNS_H
#define VCG_FCD_GRAPH_UNKNOWNS_H

#include <vcg_ext/base/graph.h>

#include <cstddef>
#include <vector>

namespace vcg::fcd::detail {

/// Which positions and rotations of a graph's k nodes are unknown. A component without a constrained node has none.
struct GraphUnknowns {
    std::vector<char> constrained;   ///< k flags: the position is given
    std::vector<char> compliant;     ///< k flags: constrained, but the rotation is free
    std::vector<Index> componentOf;  ///< k
    std::vector<char> hasConstraint; ///< of each component: whether it has a constrained node
    std::vector<Index> position;     ///< nodes with an unknown position
    std::vector<Index> numberOf;     ///< k, a node's index in position, or -1
    std::vector<Index> rotation;     ///< nodes with an unknown rotation: the same, then the compliant ones
    std::vector<Index> turnOf;       ///< k, a node's index in rotation, or -1

    /// \param compliant may be empty: none
    GraphUnknowns(const Csr &graph, const std::vector<bool> &constrained, const std::vector<bool> &compliant)
        : constrained(constrained.begin(), constrained.end()), compliant(compliant.begin(), compliant.end()) {
        const Index k = graph.Size();
        this->compliant.resize(k, false);
        hasConstraint.assign(ConnectedComponents(graph, componentOf), false);
        for (Index i = 0; i < k; ++i)
            if (constrained[i])
                hasConstraint[componentOf[i]] = true;
        numberOf.assign(k, -1);
        for (Index i = 0; i < k; ++i)
            if (!constrained[i] && HasConstraint(i)) {
                numberOf[i] = Index(position.size());
                position.push_back(i);
            }
        rotation = position;
        for (Index i = 0; i < k; ++i)
            if (constrained[i] && this->compliant[i])
                rotation.push_back(i);
        turnOf.assign(k, -1);
        for (std::size_t b = 0; b < rotation.size(); ++b)
            turnOf[rotation[b]] = Index(b);
    }

    /// Whether node \p i is in a component with a constrained node.
    bool HasConstraint(Index i) const { return hasConstraint[componentOf[i]]; }
    /// Whether the rotation of node \p i is given.
    bool IsRotationGiven(Index i) const { return constrained[i] && !compliant[i]; }
};

} // namespace vcg::fcd::detail

#endif
