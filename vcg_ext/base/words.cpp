// SPDX-License-Identifier: GPL-3.0-or-later
#include <vcg_ext/base/words.h>

#include <algorithm>
#include <string_view>

namespace vcg::fcd::detail {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }

bool LooksLikeNumber(const char *first, const char *last) {
    double number;
    return first < last &&
           (std::string_view("+-.0123456789").find(*first) != std::string_view::npos || ToNumber(first, last, number));
}

std::string Excerpt(const std::string &text, std::size_t begin, std::size_t end) {
    std::string found = text.substr(begin, std::min<std::size_t>(end - begin, 40));
    for (char &c : found)
        if (c < ' ' || c > '~')
            c = '?';
    return "'" + found + "'";
}

} // namespace vcg::fcd::detail
