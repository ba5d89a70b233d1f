// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_MAPPING_KERNEL_H
#define VCG_FCD_MAPPING_KERNEL_H

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace vcg::fcd {

namespace detail {

constexpr int lanes = 16; ///< vertices that are mapped at a time
constexpr int terms = 16; ///< numbers of a candidate that are blended

/// Weight of a node: u^3 with u = 1 - (distance / radius)^2. Like Eq. 8 of the paper, it falls from 1 at the node to 0
/// at the radius. But (1 - r)^2 has a cone's tip at the node and a jump of curvature at its end, and both show as
/// ripples.
struct Ball {
    float center[3];
    float inverse; ///< 1 / radius^2
    int node;      ///< at the centre
};

/// Linear combinations of the candidates' terms, one for each vertex, by weights that fall with the distance. Frame
/// units.
struct Blending {
    const Ball *ball;           ///< n, of the candidates' weights
    const float (*term)[terms]; ///< n
    std::size_t n;              ///< candidates
    std::size_t whole;          ///< the first so many candidates have their whole weight; others have a share of it
    const Ball *shareBall;      ///< m, of the weights by which shares are blended
    const float *share;         ///< (n - whole) x m: the share of each other candidate at the centre of each of these
    std::size_t m;
    alignas(64) float x[3][lanes]; ///< the vertices
    /// Room for n rows, out: the weights of candidates active[0] ... active[used - 1], ascending. All others have
    /// weight 0 at each of the vertices.
    float (*weight)[lanes];
    std::uint32_t *active;
    std::size_t used;
    float (*shareWeight)[lanes];         ///< m, scratch
    std::uint32_t *shareActive;          ///< m, scratch
    alignas(64) float sum[terms][lanes]; ///< out: sums of terms times weights
};

/// The motion of a patch's node: displaces x by shift + turn (x - center).
struct PatchMotion {
    double center[3], shift[3], turn[9]; ///< mesh units; columns of the linear map minus the identity
};

/// From mesh to frame units, which the blended terms have, and back. All matrices by columns.
struct Space {
    double toFrame[9], fromFrame[9];    ///< of vectors
    bool isSame;                        ///< the metric is the identity
    double metric[9], inverseMetric[9]; ///< as in Frame
};

/// Vertices of one patch that are mapped together, mesh units.
struct Vertices {
    alignas(64) double rest[3][lanes];  ///< in
    alignas(64) double moved[3][lanes]; ///< out
    alignas(64) float linear[9][lanes]; ///< out: linear map of the surface at each; columns
    alignas(64) float normal[3][lanes]; ///< in: at rest; out: turned
    float turns[lanes];                 ///< out: 0 if the normal keeps its bits

    Eigen::Vector3d Rest(int l) const { return {rest[0][l], rest[1][l], rest[2][l]}; }
    Eigen::Vector3d Moved(int l) const { return {moved[0][l], moved[1][l], moved[2][l]}; }
    Eigen::Matrix3f Linear(int l) const {
        Eigen::Matrix3f map;
        for (int d = 0; d < 9; ++d)
            map.data()[d] = linear[d][l];
        return map;
    }
    Eigen::Vector3d Normal(int l) const { return {normal[0][l], normal[1][l], normal[2][l]}; }
    void SetNormal(int l, const Eigen::Vector3d &n) {
        for (int d = 0; d < 3; ++d)
            normal[d][l] = float(n[d]);
    }
    void SetRest(int l, const Eigen::Vector3d &p) {
        for (int d = 0; d < 3; ++d)
            rest[d][l] = p[d];
    }
    void SetMoved(int l, const Eigen::Vector3d &p) {
        for (int d = 0; d < 3; ++d)
            moved[d][l] = p[d];
    }
    void SetLinear(int l, const Eigen::Matrix3f &map) {
        for (int d = 0; d < 9; ++d)
            linear[d][l] = map.data()[d];
    }
    /// Sets lanes from \p count on to the first.
    void Fill(int count) {
        for (int l = count; l < lanes; ++l)
            SetRest(l, Rest(0));
    }
    /// Maps each by the identity.
    void Stay() {
        std::memcpy(moved, rest, sizeof moved);
        for (int d = 0; d < 9; ++d)
            for (float &entry : linear[d])
                entry = d % 4 == 0 ? 1 : 0;
    }
};

/// Sets weight and sum.
void Blend(Blending &b);

/// Sums other terms of the same candidates by the weights of Blend. \param sum out: terms x lanes
void SumTerms(const Blending &b, const float (*term)[terms], float (*sum)[lanes]);

/// Moves vertices by the blend of their patch's candidates. \param linear whether to set their linear maps, too
void Carry(const Blending &b, const PatchMotion &own, const Space &space, bool linear, Vertices &v);

/// Turns the normals by the linear maps; each keeps its length.
void TurnNormals(Vertices &v);

} // namespace detail
} // namespace vcg::fcd

#endif
