// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef VCG_FCD_TABLE_READER_H
#define VCG_FCD_TABLE_READER_H

#include <vcg_ext/base/words.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace vcg::fcd::detail {

/// Reads the rows of a table of separated values (RFC 4180), with comments from '#' at the begin of a line.
class TableReader : public TextReader {
  public:
    using TextReader::TextReader;

    /// Possible separators of cells; after the first one in the text, that one alone.
    std::string separators = ",;\t";

    /// Reads the next row that is not empty, without empty cells at its end. \return false at the end of the text
    bool Next() {
        do {
            cell.clear();
            if (at >= text.size())
                return false;
            line = next;
            if (text[at] == '#')
                SkipLine();
            else
                ReadRow();
            while (!cell.empty() && cell.back().empty()) // spreadsheets make all rows equally long
                cell.pop_back();
        } while (cell.empty());
        return true;
    }

    std::vector<std::string> cell;

    /// Cell \p i as a number. \param what what messages expect \throw BadInput it is none, or not finite
    double Number(std::size_t i, const std::string &what) const {
        double value = 0;
        if (!ToNumber(cell[i].data(), cell[i].data() + cell[i].size(), value) || !std::isfinite(value))
            Fail("expected " + what + ", found " + Excerpt(cell[i], 0, cell[i].size()));
        return value;
    }

  private:
    void SkipLine() {
        at = std::min(text.find_first_of("\r\n", at), text.size());
        EndLine();
    }

    void EndLine() {
        if (at < text.size())
            at += text.compare(at, 2, "\r\n") == 0 ? 2 : 1;
        ++next;
    }

    void ReadRow() {
        for (bool more = true; more;) {
            cell.push_back(ReadCell());
            more = at < text.size() && separators.find(text[at]) != std::string::npos;
            if (more)
                separators = text[at++];
        }
        EndLine();
    }

    std::string ReadCell() {
        const auto skip = [this] {
            while (at < text.size() && text[at] == ' ')
                ++at;
        };
        skip();
        std::string found;
        if (at < text.size() && text[at] == '"') {
            for (++at;; ++at) {
                if (at >= text.size())
                    Fail("a quotation mark has no end");
                if (text[at] == '"' && text.compare(at, 2, "\"\"") != 0)
                    break;
                at += text[at] == '"';
                next += text[at] == '\n';
                found += text[at];
            }
            ++at;
            skip();
            if (at < text.size() && !IsEnd(text[at]))
                Fail("expected the end of a cell after its quotation marks");
        } else {
            while (at < text.size() && !IsEnd(text[at]))
                found += text[at++];
            found.erase(found.find_last_not_of(' ') + 1);
        }
        return found;
    }

    bool IsEnd(char c) const { return c == '\n' || c == '\r' || separators.find(c) != std::string::npos; }

    std::size_t next = 1; // number of the line after the row
};

} // namespace vcg::fcd::detail

#endif
