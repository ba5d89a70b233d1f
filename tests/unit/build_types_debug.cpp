// SPDX-License-Identifier: GPL-3.0-or-later
//
// Writes to a file where the vertices of some meshes go, for build_types_test.cpp:
//   build_types_debug FILE
#include "build_types.h"

#include <fstream>

#if defined NDEBUG || defined __OPTIMIZE__
#error "This is the build without optimisation."
#endif

int main(int argc, char **argv) {
    if (argc != 2)
        return 2;
    const std::vector<double> position = fcd_test::build_types::Deformed();
    std::ofstream file(argv[1], std::ios::binary);
    file.write(reinterpret_cast<const char *>(position.data()), std::streamsize(position.size() * sizeof position[0]));
    file.close();
    return file.good() ? 0 : 1;
}
