// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HANDLE_FILE_H
#define VCG_FCD_HANDLE_FILE_H

#include "handles.h"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace vcg {
namespace fcd {
namespace detail {

inline bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

/// Reads [first, last) as a number, whatever the locale; a '+' may stand before it. \return false when it is none, or
/// one that Number cannot hold
template <class Number>
bool ToNumber(const char *first, const char *last, Number &value) {
    if (last - first > 1 && first[0] == '+' && first[1] != '-')
        ++first;
    const std::from_chars_result r = std::from_chars(first, last, value);
    return r.ec == std::errc() && r.ptr == last;
}

/// The whitespace-separated words of a text file, with comments ('#' to the end of the line) skipped, and where they
/// stand.
class WordReader {
  public:
    /// \param separators what stands between words besides white space
    explicit WordReader(const std::string &path, const std::string &separators = "")
        : path(path), separators(separators) {
        std::ifstream file(path, std::ios::binary);
        if (!file || std::filesystem::is_directory(path))
            throw Error("Cannot open '" + path + "'.");
        text.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
        if (file.bad())
            throw Error("Cannot read '" + path + "'.");
        if (text.compare(0, 3, "\xEF\xBB\xBF") == 0)
            at = 3;
    }

    /// \return false at the end of the file
    bool Next() {
        while (!NextInLine())
            if (!NextLine())
                return false;
        return true;
    }

    /// \return false at the end of the line
    bool NextInLine() {
        while (at < text.size() && text[at] != '\n' && IsSpace(text[at]))
            ++at;
        wordBegin = at;
        while (at < text.size() && !IsSpace(text[at]) && text[at] != '#')
            ++at;
        return wordBegin < at;
    }

    /// To the beginning of the next line. \return false at the end of the file
    bool NextLine() {
        at = text.find('\n', at);
        if (at == std::string::npos) {
            at = text.size();
            return false;
        }
        ++at;
        ++line;
        return true;
    }

    /// The current word as a number, whatever the locale. \return false when it is none
    template <class Number>
    bool Read(Number &value) const {
        return ToNumber(text.data() + wordBegin, text.data() + at, value);
    }

    /// The current word as a number. \throw Error naming file and line
    template <class Number>
    Number As(const char *expected) const {
        Number value{};
        if (!Read(value))
            Fail(std::string("expected ") + expected + ", found '" +
                 text.substr(wordBegin, std::min<std::size_t>(at - wordBegin, 40)) + "'");
        return value;
    }

    [[noreturn]] void Fail(const std::string &what) const {
        throw Error("'" + path + "', line " + std::to_string(line) + ": " + what + ".");
    }

  private:
    bool IsSpace(char c) const { return detail::IsSpace(c) || separators.find(c) != std::string::npos; }

    std::string path, separators, text;
    std::size_t at = 0, wordBegin = 0, line = 1;
};

/// The shortest text that reads back as the same number.
template <class Number>
std::string ToText(Number value) {
    char buffer[40];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

template <class Write>
void WriteFile(const std::string &path, const Write &write) {
    std::ofstream file(path, std::ios::binary);
    if (file)
        write(file);
    file.close();
    if (!file)
        throw Error("Cannot write '" + path + "'.");
}

} // namespace detail

/// Reads a `.sel` file: one tag per vertex in vertex order (0 fixed, 1 free, >= 2 handle, negative = outside),
/// whitespace or line breaks between them, comments from '#' to the end of the line. \throw Error file not readable, or
/// not a whole number, with file and line
inline std::vector<int> ReadTagFile(const std::string &path) {
    detail::WordReader reader(path);
    std::vector<int> tag;
    while (reader.Next())
        tag.push_back(reader.As<int>("a tag (a whole number)"));
    if (tag.empty())
        throw Error("'" + path + "' holds no tags; expected one whole number per vertex.");
    return tag;
}

/// Reads a `.def` file: 4 x 4 matrices, row by row, column vectors to their right; the first belongs to tag 2, the
/// second to tag 3 and so on. Comments from '#' to the end of the line. \throw Error file not readable, not a number,
/// or an incomplete matrix, with file and line
inline std::vector<Eigen::Matrix4d> ReadTransformFile(const std::string &path) {
    detail::WordReader reader(path);
    std::vector<double> number;
    while (reader.Next())
        number.push_back(reader.As<double>("a number"));
    if (number.empty() || number.size() % 16)
        reader.Fail("the file ends after " + std::to_string(number.size()) +
                    " numbers; expected 16 for each 4 x 4 matrix");
    std::vector<Eigen::Matrix4d> matrix;
    for (std::size_t i = 0; i < number.size(); i += 16)
        matrix.emplace_back(Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(&number[i]));
    return matrix;
}

/// A point that goes somewhere.
struct PointPair {
    std::int64_t vertex = -1; ///< number of the vertex, from 0; -1 where start is given instead
    Eigen::Vector3d start = Eigen::Vector3d::Zero(), target = Eigen::Vector3d::Zero();
};

/// Reads a list of correspondences: a line for each point with the number of a vertex (from 0) or the x, y and z of the
/// start, and the x, y and z of the target. Between the numbers commas, semicolons or white space; comments from '#' to
/// the end of the line, and a first line that is no number names the columns.
/// \throw Error file not readable, or a line that is not of this kind, with file and line
inline std::vector<PointPair> ReadPointHandleFile(const std::string &path) {
    detail::WordReader reader(path, ",;");
    std::vector<PointPair> pairs;
    bool first = true;
    do {
        PointPair pair;
        double number[6];
        int count = 0;
        bool title = false;
        for (; reader.NextInLine(); ++count) {
            if (count == 0) {
                title = first && !reader.Read(number[0]);
                first = false;
                reader.Read(pair.vertex);
            }
            if (!title && count < 6) {
                number[count] = reader.As<double>("a number");
                if (!std::isfinite(number[count]))
                    reader.Fail("expected a finite number");
            }
        }
        if (count == 0 || title)
            continue;
        if (count != 4 && count != 6)
            reader.Fail("found " + std::to_string(count) +
                        " numbers; expected 4 (vertex and target) or 6 (start and target), with a point for decimals");
        if (count == 4) {
            if (pair.vertex < 0 || double(pair.vertex) != number[0])
                reader.Fail("expected the number of a vertex (0 or more) as the first of 4 numbers");
        } else {
            pair.vertex = -1;
            pair.start << number[0], number[1], number[2];
        }
        pair.target << number[count - 3], number[count - 2], number[count - 1];
        pairs.push_back(pair);
    } while (reader.NextLine());
    if (pairs.empty())
        throw Error("'" + path + "' holds no points; expected a line with start and target for each.");
    return pairs;
}

/// Writes what ReadTagFile reads. \throw Error
inline void WriteTagFile(const std::string &path, const std::vector<int> &tag) {
    detail::WriteFile(path, [&](std::ostream &out) {
        out << "# one tag per vertex: 0 fixed, 1 free, 2 and up handles, negative outside the region of influence\n";
        for (int t : tag)
            out << detail::ToText(t) << '\n';
    });
}

/// Writes what ReadTransformFile reads, to the bit. \throw Error
inline void WriteTransformFile(const std::string &path, const std::vector<Eigen::Matrix4d> &matrix) {
    detail::WriteFile(path, [&](std::ostream &out) {
        out << "# a 4 x 4 matrix per handle, for tags 2, 3, ... in order\n";
        for (const Eigen::Matrix4d &m : matrix)
            for (int r = 0; r < 4; ++r)
                for (int c = 0; c < 4; ++c)
                    out << detail::ToText(m(r, c)) << (c < 3 ? ' ' : '\n');
    });
}

} // namespace fcd
} // namespace vcg

#endif
