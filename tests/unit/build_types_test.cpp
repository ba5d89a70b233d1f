// SPDX-License-Identifier: GPL-3.0-or-later
#include "build_types.h"
#include "test_support.h"

#if !defined NDEBUG || !defined __OPTIMIZE__
#error "This is the build with optimisation."
#endif

TEST(BuildTypes, ReleaseAgreesWithDebug) {
    const std::vector<double> release = fcd_test::build_types::Deformed();
    std::vector<double> debug(release.size() + 1);
    std::ifstream file("debug.bin", std::ios::binary); // which build_types_debug writes
    file.read(reinterpret_cast<char *>(debug.data()), std::streamsize(debug.size() * sizeof debug[0]));
    ASSERT_EQ(file.gcount(), std::streamsize(release.size() * sizeof release[0]));
    for (std::size_t i = 0; i < release.size(); ++i)
        ASSERT_NEAR(release[i], debug[i], 1e-9) << "coordinate " << i; // which a number that is not finite is not
}
