// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef FCD_TRACE_H
#define FCD_TRACE_H

#ifdef __GNUC__
__attribute__((format(printf, 1, 2)))
#endif
/// Writes a line to the standard error, formatted as by std::printf, if FCD_TRACE is set in the environment. For tests
/// that drive a tool by a script.
void trace(const char *format, ...);

#endif
