# SPDX-License-Identifier: GPL-3.0-or-later
# For the scripts that compare with CGAL. Builds what they name into build/cmake/peers; installs CGAL where it is missing.
# shellcheck shell=bash
build_peers() {
    FCD_PACKAGES="libcgal-dev ${FCD_PEERS:+libusb-1.0-0}" bash tests/setup.sh >&2 # the latter is Open3D's
    cmake -G Ninja -S . -B build/cmake/peers -DCMAKE_BUILD_TYPE=Release -DFCD_BUILD_TESTS=ON -DFCD_PEERS=ON \
        -DFCD_VCGLIB="${XDG_CACHE_HOME:-$HOME/.cache}/fcd/vcglib" >build/peers.log
    ninja -C build/cmake/peers "$@" >>build/peers.log
}
