#!/usr/bin/env bash
# The unit tests where MeshLab is built, too: by MinGW-w64 for Windows, run by Wine, and by clang with libc++, as on macOS. Installs what
# it lacks; takes ten minutes. What is about memory that runs out is left out: it replaces malloc.
#
#   bash tests/portable.sh [windows|libc++]
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
FCD_PACKAGES="g++-mingw-w64-x86-64-posix wine wine64 libc++-14-dev libc++abi-14-dev" bash "$root/tests/setup.sh" sources
gtest=/usr/src/googletest/googletest

# build COMMAND... -- LINK-OPTION...: the tests, in the current folder.
build() {
    local compiler=()
    while [ "$1" != -- ]; do
        compiler+=("$1")
        shift
    done
    shift
    printf '#include "%s"\n' "$root"/tests/unit/*_test.cpp | grep -v faults_test >tests.cpp
    mkdir -p include && ln -sfn /usr/include/eigen3 include/eigen3 # and nothing else of this system
    local source objects=()
    for source in tests.cpp "$root/tests/unit/sanitizers.cpp" "$root"/vcg_ext/unity/*.cpp; do
        objects+=("$(basename "$source" .cpp).o")
        "${compiler[@]}" -std=c++17 -O1 -ffp-contract=off -Wall -Wextra -Werror -I"$root" -isystem include/eigen3 \
            -isystem "$gtest/include" -isystem "${XDG_CACHE_HOME:-$HOME/.cache}/fcd/vcglib" -c "$source" -o "${objects[-1]}"
    done
    for source in gtest-all gtest_main; do
        "${compiler[@]}" -std=c++17 -O1 -isystem "$gtest/include" -isystem "$gtest" -c "$gtest/src/$source.cc" -o "$source.o"
    done
    "${compiler[@]}" "${objects[@]}" gtest-all.o gtest_main.o "$@"
}

for system in ${1:-windows libc++}; do
    mkdir -p "$root/build/portable/$system"
    cd "$root/build/portable/$system"
    echo "== $system"
    case $system in
    windows)
        build ccache x86_64-w64-mingw32-g++-posix -Wa,-mbig-obj -- -static -o tests.exe
        WINEPREFIX=$PWD/wine WINEDEBUG=-all xvfb-run -a wine tests.exe --gtest_brief=1
        ;;
    libc++)
        build ccache clang++ -stdlib=libc++ -- -pthread -o tests
        ./tests --gtest_brief=1
        ;;
    *)
        echo "there is no test for $system: windows or libc++" >&2
        exit 1
        ;;
    esac
done
