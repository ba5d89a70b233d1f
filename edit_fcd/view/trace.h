// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TRACE_H
#define FCD_TRACE_H

#ifdef __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
/// Tells whoever drives a tool by a script what it does: a line on the standard error, as std::printf makes it, where the
/// environment has FCD_TRACE.
void trace(const char *format, ...);

#endif
