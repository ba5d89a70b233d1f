// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TRACE_H
#define FCD_TRACE_H

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string>

#ifdef __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
/// Writes a line to the standard error, as std::printf, if FCD_TRACE is set, for tests that drive a tool by a script.
inline void
trace(const char *format, ...) {
    if (!std::getenv("FCD_TRACE"))
        return;
    va_list values;
    va_start(values, format);
    std::vfprintf(stderr, (std::string("FCD trace: ") + format + "\n").c_str(), values);
    va_end(values);
}

#endif
