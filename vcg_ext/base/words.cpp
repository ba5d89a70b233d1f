// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h>

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace vcg::fcd::detail {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

bool LooksLikeNumber(const char *first, const char *last) {
    double number;
    return first < last &&
           (std::string_view("+-.0123456789").find(*first) != std::string_view::npos || ToNumber(first, last, number));
}

/// The number of bytes of the printable UTF-8 character at \p i; 0: there is none.
static std::size_t PrintableBytes(const std::string &text, std::size_t i) {
    const auto byte = [&](std::size_t at) { return at < text.size() ? unsigned(std::uint8_t(text[at])) : 0; };
    const unsigned first = byte(i), second = byte(i + 1);
    if (first < 0x80)
        return first >= ' ' && first <= '~';
    const std::size_t count = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
    for (std::size_t k = 1; k < count; ++k)
        if ((byte(i + k) & 0xC0) != 0x80)
            return 0;
    const bool isLonger = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90); // overlong
    const bool isNone = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90); // surrogate, too large
    const bool isControl = first == 0xC2 && second < 0xA0;
    return isLonger || isNone || isControl ? 0 : count;
}

std::string Printable(const std::string &text, std::size_t bytes) {
    std::string found;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t count = PrintableBytes(text, i), used = std::max<std::size_t>(count, 1);
        if (found.size() + used > bytes)
            break;
        found += count > 0 ? text.substr(i, count) : "?";
        i += used;
    }
    return found;
}

std::string Excerpt(const std::string &text, std::size_t begin, std::size_t end) {
    return "'" + Printable(text.substr(begin, end - begin), 40) + "'";
}

} // namespace vcg::fcd::detail
