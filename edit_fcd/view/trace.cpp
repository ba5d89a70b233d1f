// SPDX-License-Identifier: GPL-3.0-or-later
#include "edit_fcd/view/trace.h"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string>

void trace(const char *format, ...) {
    if (!std::getenv("FCD_TRACE"))
        return;
    va_list values;
    va_start(values, format);
    std::vfprintf(stderr, (std::string("FCD trace: ") + format + "\n").c_str(), values);
    va_end(values);
}
