// SPDX-License-Identifier: GPL-3.0-or-later
#include "sanitizers.h"

#ifdef __has_feature
const bool fcd_test::sanitized = __has_feature(thread_sanitizer) || __has_feature(address_sanitizer);
#else // GCC, by which the method is tested without
const bool fcd_test::sanitized = false;
#endif
