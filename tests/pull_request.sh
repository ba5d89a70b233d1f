#!/usr/bin/env bash
# Adds to a MeshLab checkout (2022.02 or newer, with submodules) what a pull request to MeshLab would add, and builds it there, in
# build/pull_request-COMPILER: the plugins by MeshLab's own CMake, with clang and with GCC, or with FCD_COMPILERS (none: they are not
# built). Installs what it lacks; MeshLab's library takes minutes the first time. A second run leaves the same checkout.
# Where the checkout is a git repository, the branch "fcd" of it, and that of its vcglib, has what is added as one commit; the text of the
# requests, tests/pull_request.md, is its message.
#
#   bash tests/pull_request.sh CHECKOUT [CMAKE-ARGUMENT...]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
fail() {
    echo "$1" >&2
    exit 1
}
[ $# -gt 0 ] || fail "usage: bash tests/pull_request.sh CHECKOUT [CMAKE-ARGUMENT...]"
[ -d "$1" ] || fail "there is no folder $1"
checkout=$(cd "$1" && pwd)
shift
src=$checkout/src
[ -e "$checkout/ML_VERSION" ] || fail "$checkout is not a MeshLab checkout: it has no file ML_VERSION"
[ -e "$src/common/plugins/interfaces/filter_plugin.h" ] ||
    fail "$checkout is MeshLab $(cat "$checkout/ML_VERSION"); 2022.02 or newer is needed"
[ -e "$src/vcglib/vcg/complex/complex.h" ] || fail "$checkout has no vcglib: run git submodule update --init there"
[ "$checkout" != "$root" ] || fail "$checkout is this repository"
[ "${FCD_COMPILERS:-}" = none ] || bash "$root/tests/setup.sh" sources

# branch REPOSITORY: the one that the requests are made of, begun where the repository is.
text=$root/tests/pull_request.md
branch() {
    [ -e "$1/.git" ] || return 0
    [ -z "$(git -C "$1" status --porcelain --untracked-files=no --ignore-submodules)" ] || fail "$1 has changes that are not committed: commit them, or put them away"
    [ "$(git -C "$1" branch --show-current)" = fcd ] || git -C "$1" checkout --quiet -b fcd || fail "$1 has a branch fcd already, on which it is not"
}
branch "$src/vcglib"
branch "$checkout"

# add FOLDER TO: as it is; times stay, so that only what has changed is built again.
add() {
    rm -rf "${2:?}/$1"
    cp -Rp "$root/$1" "$2/$1"
    echo "added ${2#"$checkout/"}/$1"
}
# In vcglib beside vcg and wrap, which every plugin has among its include directories: <vcg_ext/...> is found, and nothing is rewritten.
# (vcglib is a repository of its own, so this is a pull request there.) Plugins are beside each other, as here.
add vcg_ext "$src/vcglib"
add layer_fcd "$src/meshlabplugins" # which the plugins bring, so that the list has plugins only
add filter_fcd "$src/meshlabplugins"
add edit_fcd "$src/meshlabplugins"

# list PLUGIN NEXT: in the list of plugins, before the next one of the alphabet.
list() {
    local line='^\([[:space:]]*meshlabplugins/\)'
    if ! grep -q "$line$1[[:space:]]*\$" "$src/CMakeLists.txt"; then
        sed -i "s|$line$2\([[:space:]]*\)\$|\1$1\2\n&|" "$src/CMakeLists.txt"
        grep -q "$line$1[[:space:]]*\$" "$src/CMakeLists.txt" || fail "$src/CMakeLists.txt does not list $2, before which $1 belongs"
        echo "listed $1 in src/CMakeLists.txt"
    fi
}
list filter_fcd filter_fractal
list edit_fcd edit_manipulators

# commit REPOSITORY TITLE PATH...: what is added there, as one commit.
commit() {
    local repository=$1 title=$2
    shift 2
    [ -e "$repository/.git" ] || return 0
    git -C "$repository" add --force -- "$@"
    if git -C "$repository" diff --cached --quiet; then
        echo "$repository: the branch fcd has it already"
        return 0
    fi
    { echo "$title"; tail -n +2 "$text"; } | git -C "$repository" commit --quiet --file=- || fail "$repository: git commits nothing (user.name, user.email?)"
    echo "$repository: committed to the branch fcd"
}
commit "$src/vcglib" "Add vcg_ext, a library that deforms large meshes (FCD)" vcg_ext
commit "$checkout" "$(sed -n '1s/^# //p' "$text")" src/CMakeLists.txt src/meshlabplugins/{layer,filter,edit}_fcd

# MeshLab 2022.02 has no CMakeLists.txt at its top, and other names for the options. No other plugin is built, and no optional library needed.
top=$checkout
[ -e "$top/CMakeLists.txt" ] || top=$src
for compiler in ${FCD_COMPILERS:-clang++ g++}; do
    [ "$compiler" != none ] || break
    build=$root/build/pull_request-$compiler
    mkdir -p "$build"
    rm -f "$build/CMakeCache.txt" # it may be of another checkout
    cmake -G Ninja -S "$top" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache \
        -DMESHLAB_BUILD_ONLY_LIBRARIES=ON -DBUILD_ONLY_MESHLAB_LIBRARIES=ON -DMESHLAB_ALLOW_OPTIONAL_EXTERNAL_LIBRARIES=OFF \
        -DALLOW_OPTIONAL_EXTERNAL_MESHLAB_LIBRARIES=OFF "$@" >"$build/configure.log" 2>&1 ||
        fail "MeshLab is not configured: $(grep -m 1 -A 2 'CMake Error' "$build/configure.log" | tr '\n' ' ') (log: $build/configure.log)"
    nice ninja -C "$build" -j "${FCD_JOBS:-$(nproc)}" filter_fcd edit_fcd

    # Nothing but Qt's two entry points is visible, and all that they need is found.
    for plugin in filter_fcd edit_fcd; do
        library=$(find "$build" -name "lib$plugin.so")
        visible=$(nm -D --defined-only --extern-only "$library" | awk '{ print $3 }' | sort | paste -sd ' ')
        [ "$visible" = "qt_plugin_instance qt_plugin_query_metadata" ] || fail "$library shows $visible"
        missing=$(ldd -r "$library" 2>&1 | grep -m 1 -E 'not found|undefined symbol' || true)
        [ -z "$missing" ] || fail "$library lacks: $missing"
        echo "built $library"
    done
done
[ -e "$checkout/.git" ] || exit 0
cat <<EOT

What a person has to do:
1. Fork cnr-isti-vclab/vcglib and cnr-isti-vclab/meshlab on GitHub.
2. git -C $src/vcglib push FORK fcd, and git -C $checkout push FORK fcd
3. Open both branches on GitHub and press "Create pull request". The text is tests/pull_request.md, which the
   commits have as their message. That to vcglib comes first; MeshLab's then needs its commit as the submodule.
EOT
