// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_WORDS_H
#define VCG_FCD_WORDS_H

#include <vcg_ext/base/error.h>

#include <charconv>
#include <cmath>
#include <string>
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

/// \file
/// Reads numbers and words of texts, whatever the locale.

namespace vcg::fcd::detail {

bool IsSpace(char c);

/// Reads [first, last) as a number, which may begin with '+'. \return false: it is none, or one that Number cannot hold
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

/// Whether [first, last) is a number, or begins like one.
bool LooksLikeNumber(const char *first, const char *last);

/// \p text for messages, with '?' for control characters and bytes that are not UTF-8, cut to \p bytes bytes.
std::string Printable(const std::string &text, std::size_t bytes);

/// text[begin, end) for messages: in quotes, printable, and cut short.
std::string Excerpt(const std::string &text, std::size_t begin, std::size_t end);

/// Reads a text line by line. A line ends with LF, CR LF or CR.
class TextReader {
  public:
    /// \param text must outlive the reader \param name of the text, for messages \throw BadInput it is no plain text
    TextReader(const std::string &text, const std::string &name) : text(text), name(name) {
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

    /// Goes to the beginning of the next line. \return false at the end of the text
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

    [[noreturn]] void Fail(const std::string &what) const { Fail(what, line); }
    [[noreturn]] void Fail(const std::string &what, std::size_t inLine) const {
        throw BadInput("'" + name + "', line " + std::to_string(inLine) + ": " + what + ".");
    }
    std::size_t Line() const { return line; } ///< from 1

  protected:
    bool StartsWith(const std::string &mark) const { return text.compare(0, mark.size(), mark) == 0; }

    const std::string &text;
    const std::string name;
    std::size_t at = 0, line = 1;
};

/// Reads the words of a text, separated by white space; skips comments ('#' to the end of the line).
class WordReader : public TextReader {
  public:
    /// \param separators further characters that separate words
    WordReader(const std::string &text, const std::string &name, const std::string &separators = "")
        : TextReader(text, name), separators(separators) {}

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

    /// Reads the numbers of the next line that has some, with at most one separator between them. A first line that
    /// does not begin like a number is skipped, as the columns' names. \return false at the end of the text \throw
    /// BadInput a word that is no finite number, or a missing number
    bool NextRow(std::vector<double> &number) {
        for (number.clear(); number.empty(); isInRow = true) {
            if (isInRow && !NextLine())
                return false;
            bool isTitle = false;
            for (std::size_t count = 0; NextInLine(); ++count) {
                isTitle = isTitle || (!hasBegun && !LooksLikeNumber());
                hasBegun = true;
                if (isTitle)
                    continue;
                if (skipped > (count == 0 ? 0u : 1u))
                    Fail("expected a number between the separators; one is missing");
                number.push_back(As<double>("a number"));
                if (count == 0)
                    isIndex = Read(index) && index >= 0;
            }
        }
        return true;
    }
    /// The first number of the row, if it is a whole number >= 0; else -1.
    std::int64_t IndexOfRow() const { return isIndex ? index : -1; }

    /// Reads the current word as a number. \return false: it is none
    template <class Number>
    bool Read(Number &value) const {
        return ToNumber(text.data() + wordBegin, text.data() + at, value);
    }

    /// The current word as a number. \throw BadInput it is none, or not finite; names text and line
    template <class Number>
    Number As(const char *expected) const {
        Number value{};
        if (!Read(value))
            Fail(std::string("expected ") + expected + ", found " + Excerpt(text, wordBegin, at));
        if (!std::isfinite(double(value)))
            Fail("expected a finite number, found " + Excerpt(text, wordBegin, at));
        return value;
    }

  private:
    bool IsSpace(char c) const { return detail::IsSpace(c) || separators.find(c) != std::string::npos; }
    bool LooksLikeNumber() const { return detail::LooksLikeNumber(text.data() + wordBegin, text.data() + at); }

    const std::string separators;
    std::size_t wordBegin = 0;
    std::size_t skipped = 0; ///< separators before the current word
    std::int64_t index = -1; ///< of the row
    bool isIndex = false, isInRow = false, hasBegun = false;
};

/// The shortest text that reads back as the same number.
template <class Number>
std::string ToText(Number value) {
    char buffer[40];
    return std::string(buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr);
}

} // namespace vcg::fcd::detail

#endif
