// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h>
#include <vcg_ext/field/deformation_file.h>
#include <vcg_ext/handles/handle_file.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace vcg::fcd {

namespace {

#if defined(__BYTE_ORDER__) && defined(__ORDER_LITTLE_ENDIAN__) // MSVC does not tell: all that it compiles for is
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are copied as they are");
#endif

constexpr int deformationVersion = 2;
constexpr const char *deformationMark = "comment FCD deformation, version ";
constexpr std::size_t deformationVertexBytes = 6 * sizeof(double) + 9 * sizeof(float);
constexpr std::size_t deformationFaceBytes = 1 + 3 * sizeof(Index);

constexpr const char *differenceMark = "comment largest difference ",
                     *checksumMark = "comment CRC-32 without this line ";

/// The lines of the header; "*" stands for a count, "?" for a value of its own syntax.
std::vector<std::string> DeformationHeader(std::uint64_t version) {
    std::vector<std::string> lines{"ply", "format binary_little_endian 1.0", std::string(deformationMark) + "*"};
    if (version > 1)
        for (const char *mark : {differenceMark, checksumMark})
            lines.push_back(std::string(mark) + "?");
    lines.emplace_back("element vertex *");
    for (const char *name : {"x", "y", "z", "ux", "uy", "uz"})
        lines.push_back(std::string("property double ") + name);
    for (const char *name : {"uxx", "uxy", "uxz", "uyx", "uyy", "uyz", "uzx", "uzy", "uzz"})
        lines.push_back(std::string("property float ") + name);
    for (const char *line : {"element face *", "property list uchar int vertex_indices", "end_header"})
        lines.emplace_back(line);
    return lines;
}

/// CRC-32 of bytes that follow others. \param crc of the others, 0 if there are none
std::uint32_t Crc32(const char *bytes, std::size_t count, std::uint32_t crc) {
    static const auto table = [] {
        std::array<std::uint32_t, 256> of{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            of[i] = i;
            for (int bit = 0; bit < 8; ++bit)
                of[i] = of[i] >> 1 ^ (of[i] & 1 ? 0xEDB88320U : 0U);
        }
        return of;
    }();
    crc = ~crc;
    for (std::size_t i = 0; i < count; ++i)
        crc = crc >> 8 ^ table[(crc ^ static_cast<unsigned char>(bytes[i])) & 0xFF];
    return ~crc;
}

/// The checksum's line, of the first \p before bytes of \p text and those from \p next on.
std::string ChecksumLine(const std::string &text, std::size_t before, std::size_t next) {
    const std::uint32_t crc = Crc32(text.data() + next, text.size() - next, Crc32(text.data(), before, 0));
    std::string line = checksumMark;
    for (int shift = 28; shift >= 0; shift -= 4)
        line += "0123456789abcdef"[crc >> shift & 15];
    return line + "\n";
}

/// A number >= 0, to the bit; "unknown" for others and NaN.
std::string NumberText(double number) { return number >= 0 ? detail::ToText(number) : "unknown"; }

} // namespace

std::string DeformationText(const FieldSamples &samples) {
    const std::size_t number[] = {std::size_t(deformationVersion), std::size_t(samples.Size()),
                                  samples.triangle.size()};
    std::string text;
    int next = 0;
    std::size_t checksumAt = 0;
    for (std::string line : DeformationHeader(deformationVersion)) {
        if (line.back() == '*')
            line.replace(line.size() - 1, 1, std::to_string(number[next++]));
        if (line == std::string(differenceMark) + "?")
            line = differenceMark + NumberText(samples.largestDifference);
        if (line == std::string(checksumMark) + "?")
            checksumAt = text.size();
        else
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
                put(samples.gradient[i](r, c));
    }
    for (const auto &corners : samples.triangle) {
        put(std::uint8_t(3));
        for (Index i : corners)
            put(i);
    }
    text.insert(checksumAt, ChecksumLine(text, checksumAt, checksumAt));
    return text;
}

FieldSamples ReadDeformationText(const std::string &text, const std::string &name) {
    const auto Fail = [&name](const std::string &what) { throw BadInput("'" + name + "' " + what); };
    const std::string origin = "Give an unchanged file of 'FCD: Save Deformation' (save_fcd_deformation), or of "
                               "Deformation.save in Python.";
    std::vector<std::uint64_t> number;
    FieldSamples samples;
    std::size_t at = 0, line = 0, checksumAt = 0, checksumEnd = 0;
    std::vector<std::string> header = DeformationHeader(deformationVersion);
    for (; line < header.size(); ++line) {
        const std::string expected = header[line];
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const bool isNumber = expected.back() == '*', isApart = expected.back() == '?';
        const std::size_t fixed = expected.size() - (isNumber || isApart);
        bool isAsExpected = text.compare(at, fixed, expected, 0, fixed) == 0 && end < text.size();
        if (isNumber && isAsExpected) {
            number.emplace_back();
            isAsExpected = detail::ToNumber(text.data() + at + fixed, text.data() + end, number.back()) &&
                           text.compare(at + fixed, end - at - fixed, std::to_string(number.back())) == 0; // no 007
            if (number.size() == 1 && isAsExpected) {
                if (number[0] < 1 || number[0] > std::uint64_t(deformationVersion))
                    Fail("is a deformation of version " + std::to_string(number[0]) + "; only versions 1 to " +
                         std::to_string(deformationVersion) + " are known here. Update the program that reads it.");
                header = DeformationHeader(number[0]);
            }
        }
        isAsExpected &= isNumber || isApart || end - at == fixed;
        if (!isAsExpected && line <= 2)
            Fail("is no saved deformation. " + origin);
        if (!isAsExpected)
            Fail("has another header than a saved deformation, line " + std::to_string(line + 1) + ": expected '" +
                 expected + "', found " + detail::Excerpt(text, at, end) + ". " + origin);
        if (expected.compare(0, fixed, differenceMark) == 0) {
            double &largest = samples.largestDifference;
            const bool isKnown = detail::ToNumber(text.data() + at + fixed, text.data() + end, largest);
            if (!isKnown)
                largest = std::numeric_limits<double>::quiet_NaN();
            if (text.compare(at + fixed, end - at - fixed, NumberText(largest)) != 0)
                Fail("was changed: its largest difference is " + detail::Excerpt(text, at + fixed, end) +
                     ". Copy or save it again.");
        }
        if (expected.compare(0, fixed, checksumMark) == 0) {
            checksumAt = at;
            checksumEnd = end + 1;
        }
        at = end + 1;
    }

    const std::uint64_t vertices = number[1], faces = number[2], most = std::numeric_limits<Index>::max();
    if (vertices < 1 || vertices > most || faces > most)
        Fail("has " + std::to_string(vertices) + " vertices and " + std::to_string(faces) +
             " faces, by its header; expected 1 to 2147483647 vertices. " + origin);
    const std::uint64_t bytes = at + vertices * deformationVertexBytes + faces * deformationFaceBytes; // far below 2^64
    if (text.size() != bytes)
        Fail("has " + std::to_string(text.size()) + " bytes, and needs " + std::to_string(bytes) +
             " by its header: it is incomplete, or was changed. Copy or save it again.");

    if (checksumEnd > 0 &&
        text.compare(checksumAt, checksumEnd - checksumAt, ChecksumLine(text, checksumAt, checksumEnd)) != 0)
        Fail("was changed since it was written: its checksum does not fit. Copy or save it again.");

    const auto take = [&text, &at](auto &value) {
        std::memcpy(&value, text.data() + at, sizeof value);
        at += sizeof value;
    };
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
        const double largest = 1e100; // products of two, and with a gradient, stay finite
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

} // namespace vcg::fcd
