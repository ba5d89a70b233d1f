// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TEST_SUPPORT_H
#define FCD_TEST_SUPPORT_H

#include <vcg_ext/graph/deformation_graph.h>
#include <vcg_ext/handles/handles.h>
#include <vcg_ext/surface/read_surface.h>
#include <vcg_ext/surface/surface_graph.h>
#include "sanitizers.h"
#include "test_mesh.h"

#include <clocale>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <string>
#include <thread>

namespace fcd_test {

/// The cases of a test. With sanitizers, only the first: they run the same code.
template <class T>
std::vector<T> Rounds(std::initializer_list<T> all) {
    return std::vector<T>(all.begin(), sanitized ? all.begin() + 1 : all.end());
}

/// The arrays of a mesh.
struct Arrays : vcg::fcd::SurfaceArrays {
    explicit Arrays(vcg::fcd::SurfaceArrays arrays) : vcg::fcd::SurfaceArrays(std::move(arrays)) {}
    operator vcg::fcd::SurfaceView() const { return View(); }
};
template <class MeshType>
Arrays Read(const MeshType &mesh) {
    return Arrays(vcg::tri::ReadSurface(mesh));
}

using vcg::fcd::Csr;
using vcg::fcd::Graph;
using vcg::fcd::Index;

using EdgeSet = std::set<std::pair<Index, Index>>; ///< each edge once, the smaller end first

inline void Insert(EdgeSet &edges, Index a, Index b) {
    if (a != b)
        edges.insert(std::minmax(a, b));
}

inline Csr CsrOf(Index n, const EdgeSet &edges) {
    std::vector<std::set<Index>> row(n);
    for (const auto &e : edges) {
        row[e.first].insert(e.second);
        row[e.second].insert(e.first);
    }
    Csr csr;
    for (const std::set<Index> &r : row) {
        csr.item.insert(csr.item.end(), r.begin(), r.end());
        csr.begin.push_back(std::uint32_t(csr.item.size()));
    }
    return csr;
}

inline EdgeSet EdgesOf(const Csr &csr) {
    EdgeSet edges;
    for (Index u = 0; u < csr.Size(); ++u)
        for (Index v : csr[u])
            Insert(edges, u, v);
    return edges;
}

inline Csr RandomGraph(Index n, int edges, unsigned seed) {
    std::mt19937 random(seed);
    EdgeSet set;
    for (int e = 0; e < edges; ++e)
        Insert(set, Index(random() % n), Index(random() % n));
    return CsrOf(n, set);
}

inline std::vector<Index> RandomGroups(Index n, Index groups, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<Index> groupOf(n);
    for (Index &g : groupOf)
        g = Index(random() % groups);
    return groupOf;
}

/// From 0 to 1, a fifth of them 0.
inline std::vector<float> RandomMasses(Index n, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<float> mass(n);
    for (float &m : mass)
        m = random() % 5 ? float(random() % 1000) * 1e-3f : 0;
    return mass;
}

/// Symmetric, ascending rows without a repetition or the node itself.
inline void ExpectAdjacencyInOrder(const Csr &csr) {
    for (Index u = 0; u < csr.Size(); ++u)
        for (std::size_t i = 0; i < csr[u].size(); ++i) {
            const Index v = csr[u][i];
            ASSERT_NE(u, v);
            ASSERT_TRUE(i == 0 || csr[u][i - 1] < v) << "row " << u;
            ASSERT_TRUE(std::binary_search(csr[v].begin(), csr[v].end(), u)) << u << " - " << v;
        }
}

/// The items of each group, ascending: the inverse of \p groupOf (n values in [0, groups), or -1 for none).
inline Csr GroupMembers(const std::vector<Index> &groupOf, Index groups) {
    Csr members;
    members.begin.assign(std::size_t(groups) + 1, 0);
    for (Index g : groupOf)
        if (g >= 0)
            ++members.begin[g + 1];
    for (Index g = 0; g < groups; ++g)
        members.begin[g + 1] += members.begin[g];
    members.item.resize(members.begin.back());
    std::vector<std::uint32_t> end(members.begin.begin(), members.begin.end() - 1);
    for (std::size_t i = 0; i < groupOf.size(); ++i)
        if (groupOf[i] >= 0)
            members.item[end[groupOf[i]]++] = Index(i);
    return members;
}

/// Root of each item, by union-find; the oracle for components.
class UnionFind {
  public:
    explicit UnionFind(Index n) : parent(n) {
        for (Index i = 0; i < n; ++i)
            parent[i] = i;
    }
    Index Root(Index i) {
        while (parent[i] != i)
            i = parent[i] = parent[parent[i]];
        return i;
    }
    void Join(Index a, Index b) { parent[Root(a)] = Root(b); }
    Index Count() {
        Index roots = 0;
        for (Index i = 0; i < Index(parent.size()); ++i)
            roots += Root(i) == i;
        return roots;
    }

  private:
    std::vector<Index> parent;
};

/// Components of the nodes, by the edges with joined(u, v).
template <class Joined>
UnionFind ComponentsWhere(const Csr &csr, const Joined &joined) {
    UnionFind sets(csr.Size());
    for (Index u = 0; u < csr.Size(); ++u)
        for (Index v : csr[u])
            if (joined(u, v))
                sets.Join(u, v);
    return sets;
}

template <class Matrix>
bool SameBits(const Matrix &a, const Matrix &b) {
    return a.rows() == b.rows() && a.cols() == b.cols() &&
           (a.size() == 0 || std::memcmp(a.data(), b.data(), a.size() * sizeof *a.data()) == 0);
}

/// Calls \p run, which must throw an Exception. \return its message, which is also left for tests/messages.py
template <class Exception, class Run>
std::string MessageOf(const Run &run) {
    try {
        run();
    } catch (const Exception &e) {
        if (const char *file = std::getenv("FCD_MESSAGES"))
            std::ofstream(file, std::ios::app) << std::string(e.what()) + "\n";
        return e.what();
    }
    ADD_FAILURE() << "no exception";
    return {};
}

/// A decimal comma for the C library, as long as it lives. tests/setup.sh makes the locale; LOCPATH names its folder.
class CommaLocale {
  public:
    const std::string before = std::setlocale(LC_ALL, nullptr);
    const bool set = std::setlocale(LC_ALL, "de_DE.UTF-8") && std::localeconv()->decimal_point == std::string(",");
    static constexpr const char *missing = "there is no locale de_DE.UTF-8 (LOCPATH=build/locale after tests/setup.sh)";

    ~CommaLocale() { std::setlocale(LC_ALL, before.c_str()); }
};

/// Records the calls of a progress callback. Only one at a time.
class CallbackLog {
  public:
    std::vector<int> percent;
    std::vector<std::thread::id> thread;
    std::size_t cancelAt; ///< the call with this number (from 0) returns false

    explicit CallbackLog(std::size_t cancelAt = std::size_t(-1)) : cancelAt(cancelAt) { active = this; }
    ~CallbackLog() { active = nullptr; }

    static bool Callback(const int percent, const char *) {
        active->percent.push_back(percent);
        active->thread.push_back(std::this_thread::get_id());
        return active->percent.size() != active->cancelAt + 1;
    }
    vcg::fcd::Progress Progress(unsigned threads = 0) const {
        vcg::fcd::Progress progress(&CallbackLog::Callback);
        progress.threads = threads;
        return progress;
    }

  private:
    inline static CallbackLog *active = nullptr;
};

inline vcg::fcd::Progress Threads(unsigned threads) {
    vcg::fcd::Progress progress;
    progress.threads = threads;
    return progress;
}

inline Eigen::Matrix3d RandomRotation(std::mt19937 &random) {
    std::normal_distribution<double> normal;
    const double w = normal(random), x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

inline Eigen::Vector3d RandomVector(std::mt19937 &random) {
    std::normal_distribution<double> normal;
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(x, y, z);
}

inline Eigen::Affine3d RandomRigid(unsigned seed) {
    std::mt19937 random(seed);
    Eigen::Affine3d motion = Eigen::Affine3d::Identity();
    motion.linear() = RandomRotation(random);
    motion.translation() = RandomVector(random);
    return motion;
}

/// tag(position) of each vertex.
template <class Tag>
std::vector<int> TagsOf(const Shape &shape, const Tag &tag) {
    std::vector<int> result;
    for (const Eigen::Vector3d &p : shape.position)
        result.push_back(tag(p));
    return result;
}

/// tag(position) of each node.
template <class Tag>
std::vector<Index> TagNodes(const vcg::fcd::SurfaceGraph &s, const Tag &tag) {
    std::vector<Index> result;
    for (Index u = 0; u < s.graph.Size(); ++u)
        result.push_back(tag(s.frame.FromFrame(s.graph.position.col(u).cast<double>())));
    return result;
}

/// A surface with its tags, patches (held ones beside the free ones) and deformation graph.
struct Rig {
    vcg::fcd::SurfaceGraph surface;
    std::vector<Index> tag;
    vcg::fcd::PatchParam param;
    vcg::fcd::Patches patches;
    vcg::fcd::DeformationGraph graph;
    std::vector<bool> constrained; ///< of each node of the graph

    /// \param radius D, mesh units
    template <class Tag>
    Rig(const Shape &shape, double radius, const Tag &tagAt) {
        const MeshD mesh(shape);
        surface = vcg::fcd::BuildSurfaceGraph(Read(mesh));
        tag = TagNodes(surface, tagAt);
        param.targetRadius = radius / surface.frame.scale;
        param.initialPatches = 10;
        patches = vcg::fcd::SamplePatches(surface.graph, tag, surface.nodeArea, param);
        vcg::fcd::AddHeldPatches(surface.graph, tag, patches);
        graph = vcg::fcd::MakeDeformationGraph(surface.graph, tag, surface.nodeArea, patches,
                                               vcg::fcd::GraphWeights::Border);
        for (Index c : patches.center)
            constrained.push_back(tag[c] != 1);
    }

    /// The motion of each node of the graph, frame units. \param motion motion(tag), mesh units
    template <class MotionOf>
    std::vector<Eigen::Affine3d> NodeMotion(const MotionOf &motion) const {
        std::vector<Eigen::Affine3d> result;
        for (Index c : patches.center)
            result.push_back(surface.frame.ToFrame(Eigen::Affine3d(motion(tag[c])).matrix()));
        return result;
    }
};

/// Tags of a Tube of the given length: its first sixth fixed, its last a handle.
inline int TubeTag(const Eigen::Vector3d &p, double length = 6) {
    return p[2] < length / 6 ? 0 : p[2] > length * 5 / 6 ? 2 : 1;
}

/// A motion that turns and shifts.
inline const Eigen::Affine3d bend =
    Eigen::Translation3d(1.5, 0.5, -0.5) * Eigen::AngleAxisd(1, Eigen::Vector3d(1, 0.3, 0.2).normalized());

/// A shape with tags and motions.
struct Case {
    Shape shape;
    vcg::fcd::Handles handles;
};

/// \param tagAt tag of a position \param motion of handle 2
template <class Tag>
Case CaseOf(const Shape &shape, const Tag &tagAt, const Eigen::Affine3d &motion = bend) {
    Case c{shape, {}};
    for (const Eigen::Vector3d &p : shape.position)
        c.handles.tag.push_back(tagAt(p));
    c.handles.motion[2] = vcg::fcd::Motion(motion.matrix());
    return c;
}

template <class Mesh>
Eigen::Matrix3Xd PositionsOf(const Mesh &mesh) {
    Eigen::Matrix3Xd x(3, mesh.vert.size());
    for (int i = 0; i < int(mesh.vert.size()); ++i)
        x.col(i) = mesh.At(i);
    return x;
}

/// Expects that fixed, outside and deleted vertices keep their bits, that handles are exactly where their motions put
/// them at 100 percent, and that all live ones are finite.
template <class Mesh>
void ExpectHeldExact(const Mesh &mesh, const vcg::fcd::Handles &handles, const Eigen::Matrix3Xd &result) {
    const Eigen::Matrix3Xd rest = PositionsOf(mesh);
    ASSERT_EQ(result.cols(), rest.cols());
    double size = 0;
    for (int i = 0; i < int(rest.cols()); ++i)
        if (!mesh.vert[i].IsD())
            size = std::max(size, rest.col(i).cwiseAbs().maxCoeff());
    int wrong = 0;
    for (int i = 0; i < int(rest.cols()) && wrong < 5; ++i) {
        const Eigen::Vector3d before = rest.col(i), after = result.col(i);
        const int tag = handles.tag[i];
        bool right = after.allFinite();
        if (tag <= 0 || mesh.vert[i].IsD()) {
            right = SameBits(after, before);
        } else if (tag >= 2) {
            const auto m = handles.motion.find(tag);
            const Eigen::Affine3d motion(m == handles.motion.end() ? Eigen::Matrix4d::Identity() : m->second.matrix);
            right = (after - motion * before).norm() <= 1e-12 * (size + motion.translation().norm());
        }
        wrong += !right;
        EXPECT_TRUE(right) << "vertex " << i << " with tag " << tag << " goes from " << before.transpose() << " to "
                           << after.transpose();
    }
}

} // namespace fcd_test

#endif
