// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h>
#include <vcg_ext/field/deformation_file.h>
#include <vcg_ext/handles/handle_file.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace vcg {
namespace fcd {

namespace {

#if defined(__BYTE_ORDER__) && defined(__ORDER_LITTLE_ENDIAN__) // MSVC does not tell: all that it compiles for is
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are copied as they are");
#endif

constexpr int deformationVersion = 1;
constexpr const char *deformationMark = "comment FCD deformation, version ";
constexpr std::size_t deformationVertexBytes = 6 * sizeof(double) + 9 * sizeof(float);
constexpr std::size_t deformationFaceBytes = 1 + 3 * sizeof(Index);

/// The lines of the header, "*" for a number that the reader is told.
std::vector<std::string> DeformationHeader() {
    std::vector<std::string> lines{"ply", "format binary_little_endian 1.0", std::string(deformationMark) + "*",
                                   "element vertex *"};
    for (const char *name : {"x", "y", "z", "ux", "uy", "uz"})
        lines.push_back(std::string("property double ") + name);
    for (const char *name : {"uxx", "uxy", "uxz", "uyx", "uyy", "uyz", "uzx", "uzy", "uzz"})
        lines.push_back(std::string("property float ") + name);
    for (const char *line : {"element face *", "property list uchar int vertex_indices", "end_header"})
        lines.emplace_back(line);
    return lines;
}

} // namespace

std::string DeformationText(const FieldSamples &samples) {
    const std::size_t number[] = {std::size_t(deformationVersion), std::size_t(samples.Size()),
                                  samples.triangle.size()};
    std::string text;
    int next = 0;
    for (std::string line : DeformationHeader()) {
        if (line.back() == '*')
            line.replace(line.size() - 1, 1, std::to_string(number[next++]));
        text += line + "\n";
    }
    text.reserve(text.size() + number[1] * deformationVertexBytes + number[2] * deformationFaceBytes);
    const auto put = [&text](auto value) {
        char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        text.append(bytes, sizeof value);
    };
    for (Index i = 0; i < samples.Size(); ++i) {
        for (int d = 0; d < 3; ++d)
            put(samples.position(d, i));
        for (int d = 0; d < 3; ++d)
            put(samples.displacement(d, i));
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                put(samples.gradient[std::size_t(i)](r, c));
    }
    for (const auto &corners : samples.triangle) {
        put(std::uint8_t(3));
        for (Index i : corners)
            put(i);
    }
    return text;
}

FieldSamples ReadDeformationText(const std::string &text, const std::string &name) {
    const auto Fail = [&name](const std::string &what) { throw BadInput("'" + name + "' " + what); };
    const std::string origin = "Give a file that 'FCD: Save Deformation' (save_fcd_deformation) has written, as it "
                               "was written.";
    std::vector<std::uint64_t> number;
    std::size_t at = 0, line = 0;
    for (const std::string &expected : DeformationHeader()) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const bool isNumber = expected.back() == '*';
        const std::size_t fixed = expected.size() - isNumber;
        bool isAsExpected = text.compare(at, fixed, expected, 0, fixed) == 0 && end < text.size();
        if (isNumber && isAsExpected) {
            number.emplace_back();
            isAsExpected = detail::ToNumber(text.data() + at + fixed, text.data() + end, number.back()) &&
                           text.compare(at + fixed, end - at - fixed, std::to_string(number.back())) == 0; // no 007
            if (number.size() == 1 && isAsExpected && number[0] != std::uint64_t(deformationVersion))
                Fail("is a deformation of version " + std::to_string(number[0]) + "; only version " +
                     std::to_string(deformationVersion) + " is known here. Update the program that reads it.");
        }
        isAsExpected &= isNumber || end - at == fixed;
        if (!isAsExpected && line <= 2)
            Fail("is no saved deformation. " + origin);
        if (!isAsExpected)
            Fail("has another header than a saved deformation, line " + std::to_string(line + 1) + ": expected '" +
                 expected + "', found " + detail::Excerpt(text, at, end) + ". " + origin);
        at = end + 1;
        ++line;
    }

    const std::uint64_t vertices = number[1], faces = number[2], most = std::numeric_limits<Index>::max();
    if (vertices < 1 || vertices > most || faces > most)
        Fail("has " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
             " faces, by its header; expected 1 to 2147483647 vertices. " + origin);
    const std::uint64_t bytes = at + vertices * deformationVertexBytes + faces * deformationFaceBytes; // far below 2^64
    if (text.size() != bytes)
        Fail("has " + std::to_string(text.size()) + " bytes, and needs " + std::to_string(bytes) +
             " by its header: it is incomplete, or was changed. Copy or save it again.");

    const auto take = [&text, &at](auto &value) {
        std::memcpy(&value, text.data() + at, sizeof value);
        at += sizeof value;
    };
    FieldSamples samples;
    samples.position.resize(3, Eigen::Index(vertices));
    samples.displacement.resize(3, Eigen::Index(vertices));
    samples.gradient.resize(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
        for (int d = 0; d < 3; ++d)
            take(samples.position(d, Eigen::Index(i)));
        for (int d = 0; d < 3; ++d)
            take(samples.displacement(d, Eigen::Index(i)));
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c)
                take(samples.gradient[i](r, c));
        const double largest = 1e100; // so that no product of two, nor of one with a gradient, is infinite
        if (!(samples.position.col(Eigen::Index(i)).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= largest) ||
            !(samples.displacement.col(Eigen::Index(i)).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= largest) ||
            !samples.gradient[i].allFinite())
            Fail("has a number that is not finite, or beyond 1e100, at vertex " + std::to_string(i) +
                 ": it was changed. Copy or save it again.");
    }
    samples.triangle.resize(faces);
    for (std::size_t f = 0; f < faces; ++f) {
        std::uint8_t corners;
        take(corners);
        bool isValid = corners == 3;
        for (Index &i : samples.triangle[f]) {
            take(i);
            isValid &= i >= 0 && i < Index(vertices);
        }
        if (!isValid)
            Fail("has a face that is no triangle of its vertices, face " + std::to_string(f) +
                 ": it was changed. Copy or save it again.");
    }
    return samples;
}

FieldSamples ReadDeformationFile(const std::string &path) { return ReadDeformationText(ReadFile(path), path); }

} // namespace fcd
} // namespace vcg
