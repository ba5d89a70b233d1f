// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_HANDLE_FILE_H
#define VCG_FCD_HANDLE_FILE_H

#include "handles.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>
#ifndef __cpp_lib_to_chars
#include <cerrno>
#include <clocale>
#include <cstdlib>
#include <cstring>
#ifdef __APPLE__
#include <xlocale.h>
#endif
#endif

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
#ifndef __cpp_lib_to_chars // libc++ has it for whole numbers only
    if constexpr (!std::is_integral_v<Number>) {
        static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
        const std::string word(first, last);
        if (word.empty() || std::strchr("-.0123456789inIN", word[0]) == nullptr ||
            word.find_first_of("xX") != std::string::npos)
            return false;
        char *end = nullptr;
        errno = 0;
        value = Number(strtod_l(word.c_str(), &end, plain));
        const bool isInRange = errno != ERANGE || (std::isfinite(value) && value != 0);
        return isInRange && end == word.c_str() + word.size();
    } else
#endif
    {
        const std::from_chars_result r = std::from_chars(first, last, value);
        return r.ec == std::errc() && r.ptr == last;
    }
}

/// Whether [first, last) is a number or, by how it begins, is meant as one.
inline bool LooksLikeNumber(const char *first, const char *last) {
    double number;
    return first < last &&
           (std::string_view("+-.0123456789").find(*first) != std::string_view::npos || ToNumber(first, last, number));
}

/// What stands in text[begin, end), for messages: cut short, and '?' for all but printable ASCII.
inline std::string Excerpt(const std::string &text, std::size_t begin, std::size_t end) {
    std::string found = text.substr(begin, std::min<std::size_t>(end - begin, 40));
    for (char &c : found)
        if (c < ' ' || c > '~')
            c = '?';
    return "'" + found + "'";
}

} // namespace detail

/// The bytes of a file. \param most how many there may be; of a larger file no more are read \throw Error naming it
inline std::string ReadFile(const std::string &path, std::size_t most = std::string::npos) {
    std::error_code ignored;
    if (std::filesystem::is_directory(path, ignored))
        throw Error("Cannot read '" + path + "'.");
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error("Cannot open '" + path + "'.");
    std::string text;
    std::vector<char> buffer(1 << 16);
    while (file.read(buffer.data(), std::streamsize(buffer.size())) || file.gcount() > 0) {
        text.append(buffer.data(), std::size_t(file.gcount()));
        if (text.size() > most)
            throw Error("'" + path + "' is larger than " + std::to_string(most / 1000000) +
                        " MB, which is more than this mesh can need. Give the file that belongs to it.");
    }
    if (file.bad())
        throw Error("Cannot read '" + path + "'.");
    return text;
}

namespace detail {

/// The whitespace-separated words of a text, with comments ('#' to the end of the line) skipped, and where they stand.
/// A line ends with LF, CR LF or CR.
class WordReader {
  public:
    /// \param text must outlive the reader \param name what messages call it \param separators what stands between
    /// words besides white space \throw Error when it is no plain text
    WordReader(const std::string &text, const std::string &name, const std::string &separators = "")
        : text(text), name(name), separators(separators) {
        if (StartsWith("\xFF\xFE") || StartsWith("\xFE\xFF"))
            Fail("expected plain text (ASCII or UTF-8), found UTF-16");
        if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
            while (text.find_first_of("\r\n", at) < zero)
                NextLine();
            Fail("expected plain text (ASCII or UTF-8), found a zero byte, as in UTF-16 or binary files");
        }
        if (StartsWith("\xEF\xBB\xBF"))
            at = 3;
    }

    /// \return false at the end of the text
    bool Next() {
        while (!NextInLine())
            if (!NextLine())
                return false;
        return true;
    }

    /// \return false at the end of the line
    bool NextInLine() {
        for (skipped = 0; at < text.size() && text[at] != '\n' && text[at] != '\r' && IsSpace(text[at]); ++at)
            skipped += !detail::IsSpace(text[at]);
        wordBegin = at;
        while (at < text.size() && !IsSpace(text[at]) && text[at] != '#')
            ++at;
        return wordBegin < at;
    }

    /// To the beginning of the next line. \return false at the end of the text
    bool NextLine() {
        at = text.find_first_of("\r\n", at);
        if (at == std::string::npos) {
            at = text.size();
            return false;
        }
        at += text.compare(at, 2, "\r\n") == 0 ? 2 : 1;
        ++line;
        return true;
    }

    /// The current word as a number, whatever the locale. \return false when it is none
    template <class Number>
    bool Read(Number &value) const {
        return ToNumber(text.data() + wordBegin, text.data() + at, value);
    }

    /// How many separators stand before the current word.
    std::size_t Separators() const { return skipped; }

    bool LooksLikeNumber() const { return detail::LooksLikeNumber(text.data() + wordBegin, text.data() + at); }

    /// The current word as a number. \throw Error naming text and line when it is none, or not finite
    template <class Number>
    Number As(const char *expected) const {
        Number value{};
        if (!Read(value))
            Fail(std::string("expected ") + expected + ", found " + Excerpt(text, wordBegin, at));
        if (!std::isfinite(double(value)))
            Fail("expected a finite number, found " + Excerpt(text, wordBegin, at));
        return value;
    }

    [[noreturn]] void Fail(const std::string &what) const {
        throw Error("'" + name + "', line " + std::to_string(line) + ": " + what + ".");
    }

  private:
    bool StartsWith(const std::string &mark) const { return text.compare(0, mark.size(), mark) == 0; }
    bool IsSpace(char c) const { return detail::IsSpace(c) || separators.find(c) != std::string::npos; }

    const std::string &text;
    const std::string name, separators;
    std::size_t at = 0, wordBegin = 0, line = 1;
    std::size_t skipped = 0; ///< separators before the current word
};

/// The shortest text that reads back as the same number.
template <class Number>
std::string ToText(Number value) {
    char buffer[40];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

/// Writes \p text to a file, over what is there. \throw Error naming it
inline void WriteFile(const std::string &path, const std::string &text) {
    std::ofstream file(path, std::ios::binary);
    file.write(text.data(), std::streamsize(text.size()));
    file.close();
    if (!file)
        throw Error("Cannot write '" + path + "'.");
}

} // namespace detail

/// Reads the text of a `.sel` file: one tag per vertex in vertex order (0 fixed, 1 free, >= 2 handle, negative =
/// outside), whitespace or line breaks between them, comments from '#' to the end of the line. \param name what
/// messages call the text \throw Error not a whole number, or none at all, with name and line
inline std::vector<int> ReadTagText(const std::string &text, const std::string &name) {
    detail::WordReader reader(text, name);
    std::vector<int> tag;
    while (reader.Next())
        tag.push_back(reader.As<int>("a tag (a whole number)"));
    if (tag.empty())
        reader.Fail("the file holds no tags; expected one whole number per vertex");
    return tag;
}

/// ReadTagText of a file. \param most bytes \throw Error also when it is not readable, or larger
inline std::vector<int> ReadTagFile(const std::string &path, std::size_t most = std::string::npos) {
    return ReadTagText(ReadFile(path, most), path);
}

/// Reads the text of a `.def` file: 4 x 4 matrices, row by row, column vectors to their right; the first belongs to
/// tag 2, the second to tag 3 and so on. Comments from '#' to the end of the line. \param name what messages call the
/// text \throw Error not a finite number, or an incomplete matrix, with name and line
inline std::vector<Eigen::Matrix4d> ReadTransformText(const std::string &text, const std::string &name) {
    detail::WordReader reader(text, name);
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

/// ReadTransformText of a file. \param most bytes \throw Error also when it is not readable, or larger
inline std::vector<Eigen::Matrix4d> ReadTransformFile(const std::string &path, std::size_t most = std::string::npos) {
    return ReadTransformText(ReadFile(path, most), path);
}

/// A point that goes somewhere.
struct PointPair {
    std::int64_t vertex = -1; ///< number of the vertex, from 0; -1 where start is given instead
    Eigen::Vector3d start = Eigen::Vector3d::Zero(), target = Eigen::Vector3d::Zero();
};

/// Reads a list of correspondences: a line for each point with the number of a vertex (from 0) or the x, y and z of the
/// start, and the x, y and z of the target. Between the numbers a comma, a semicolon or white space; comments from '#'
/// to the end of the line, and a first line that does not begin like a number names the columns. \param name what
/// messages call the text \throw Error a line that is not of this kind, or none at all, with name and line
inline std::vector<PointPair> ReadPointHandleText(const std::string &text, const std::string &name) {
    detail::WordReader reader(text, name, ",;");
    std::vector<PointPair> pairs;
    bool first = true;
    do {
        PointPair pair;
        double number[6];
        int count = 0;
        bool title = false;
        for (; reader.NextInLine(); ++count) {
            if (count == 0) {
                title = first && !reader.LooksLikeNumber();
                first = false;
                reader.Read(pair.vertex);
            }
            if (!title && reader.Separators() > (count == 0 ? 0u : 1u))
                reader.Fail("expected a number between the separators; one is missing");
            if (!title && count < 6)
                number[count] = reader.As<double>("a number");
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
        reader.Fail("the file holds no points; expected a line with start and target for each");
    return pairs;
}

/// ReadPointHandleText of a file. \param most bytes \throw Error also when it is not readable, or larger
inline std::vector<PointPair> ReadPointHandleFile(const std::string &path, std::size_t most = std::string::npos) {
    return ReadPointHandleText(ReadFile(path, most), path);
}

/// What ReadTagText reads.
inline std::string TagText(const std::vector<int> &tag) {
    std::string text =
        "# one tag per vertex: 0 fixed, 1 free, 2 and up handles, negative outside the region of influence\n";
    for (int t : tag)
        text.append(detail::ToText(t)).push_back('\n');
    return text;
}

/// What ReadTransformText reads, to the bit.
inline std::string TransformText(const std::vector<Eigen::Matrix4d> &matrix) {
    std::string text = "# a 4 x 4 matrix per handle, for tags 2, 3, ... in order\n";
    for (const Eigen::Matrix4d &m : matrix)
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c)
                text.append(detail::ToText(m(r, c))).push_back(c < 3 ? ' ' : '\n');
    return text;
}

/// Writes what ReadTagFile reads. \throw Error
inline void WriteTagFile(const std::string &path, const std::vector<int> &tag) {
    detail::WriteFile(path, TagText(tag));
}

/// Writes what ReadTransformFile reads, to the bit. \throw Error
inline void WriteTransformFile(const std::string &path, const std::vector<Eigen::Matrix4d> &matrix) {
    detail::WriteFile(path, TransformText(matrix));
}

} // namespace fcd
} // namespace vcg

#endif
