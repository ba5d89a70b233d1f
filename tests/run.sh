#!/usr/bin/env bash
# Sets the machine up, builds, and runs every test. The last line is the sum: "N passed, N failed, N skipped".
# What cannot run counts as skipped, as failed where CI=true.
#
#   bash tests/run.sh
set -uo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root" || exit 1
build=$root/build
cache=${XDG_CACHE_HOME:-$HOME/.cache}/fcd
results=$build/results
rm -rf "$results"
mkdir -p "$results"
export FCD_MESSAGES=$results/messages.txt # what the tests are told, for tests/messages.py
passed=0 failed=0 skipped=0

# count FILE: adds up a JUnit file of ctest or pytest.
count() {
    local p f s
    read -r p f s < <("$build/venv/bin/python" - "$1" <<'PYTHON'
import sys
import xml.etree.ElementTree as tree
cases = list(tree.parse(sys.argv[1]).iter("testcase"))
failed = [c for c in cases if c.find("failure") is not None or c.find("error") is not None]
skipped = [c for c in cases if c not in failed and (c.find("skipped") is not None or c.get("status") in ("notrun", "disabled"))]
print(len(cases) - len(failed) - len(skipped), len(failed), len(skipped))
PYTHON
    )
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
}
fail() {
    echo "FAILED: $1" >&2
    failed=$((failed + 1))
}
finish() {
    echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" = 0 ]
    exit
}

if ! bash tests/setup.sh; then
    fail "setup"
    finish
fi

# suite NAME CMAKE-ARGUMENT...: tests that ctest runs, built one way in build/NAME.
suite() {
    local name=$1 directory=$build/$1
    shift
    echo "== $name"
    # CMake forgets its variables when the compiler changes.
    if [ "$(cat "$directory/arguments" 2>/dev/null)" != "$root $*" ]; then
        rm -rf "$directory"
        mkdir -p "$directory"
        echo "$root $*" >"$directory/arguments"
    fi
    if ! { cmake -G Ninja -S . -B "$directory" -DFCD_VCGLIB="$cache/meshlab-2025.07/src/vcglib" "$@" &&
        nice ninja -C "$directory"; } >"$results/$name.log" 2>&1; then
        grep -m 5 -E 'error|Error' "$results/$name.log" || tail -n 5 "$results/$name.log"
        fail "building $name, see $results/$name.log"
        return
    fi
    LOCPATH=$build/locale ctest --test-dir "$directory" --output-on-failure --output-junit "$results/$name.xml" -j 2 2>&1 |
        tee -a "$results/$name.log" | grep -vE '^ *[0-9]+/[0-9]+ Test .* Passed|^ +Start '
    if [ -s "$results/$name.xml" ]; then count "$results/$name.xml"; else fail "$name gave no result"; fi
}

# host NAME PYTHON FILE...: host tests with the Python of a pymeshlab.
host() {
    local name=$1 python=$2
    shift 2
    echo "== host tests ($name)"
    "$python" -m pytest -q -ra -p no:cacheprovider --junitxml="$results/host-$name.xml" "$@" 2>&1 |
        tee "$results/host-$name.log"
    if [ -s "$results/host-$name.xml" ]; then count "$results/host-$name.xml"; else fail "host tests ($name) ended early"; fi
}
# faults NAME: builds the host in which things go wrong.
faults() {
    nice ninja -C "$build/cmake/$1" host_faults >"$results/host_faults-$1.log" 2>&1 || fail "building host_faults for $1"
}
# without NAME REASON: what cannot run.
without() {
    if [ "${CI:-}" = true ]; then
        fail "$1: $2"
    else
        echo "SKIPPED: $1: $2" >&2
        skipped=$((skipped + 1))
    fi
}
# check NAME PROGRAM ARGUMENT...: passes when the program, which prints what it finds, does.
check() {
    local name=$1
    shift
    echo "== $name"
    if ! command -v "$1" >"$results/$name.log"; then
        without "$name" "there is no $1"
    elif nice "$@" >"$results/$name.log" 2>&1; then
        passed=$((passed + 1))
    else
        grep -m 20 -E '(error|warning|style|performance|portability):' "$results/$name.log" || tail -n 20 "$results/$name.log"
        fail "$name, see $results/$name.log"
    fi
}

tools=$build/venv-tools/bin
check clang-tidy "$tools/run-clang-tidy.py" -clang-tidy-binary "$tools/clang-tidy" -p "$build/cmake/pymeshlab-2025.7" -quiet \
    -j 2 '/filter_fcd/[a-z_]+\.cpp$'
check cppcheck cppcheck -q -j 2 --enable=warning,style,performance,portability --error-exitcode=1 --language=c++ \
    --std=c++17 --library=qt --suppressions-list=tests/cppcheck.txt vcg_ext/*.h filter_fcd/*.cpp

suite unit-release -DFCD_BUILD_TESTS=ON -DCMAKE_BUILD_TYPE=Release
LLVM_PROFILE_FILE=$results/%4m.profraw suite unit-sanitized -DFCD_BUILD_TESTS=ON -DCMAKE_CXX_COMPILER=clang++ \
    -DCMAKE_BUILD_TYPE=None "-DCMAKE_CXX_FLAGS=-O1 -g1 -fprofile-instr-generate -fcoverage-mapping" -DFCD_SANITIZE=ON
check coverage bash tests/coverage.sh "$build/unit-sanitized/tests/fcd_unit_tests" "$results"/*.profraw
tail -n 1 "$results/coverage.log"
suite unit-threads -DFCD_BUILD_TESTS=ON -DCMAKE_BUILD_TYPE=None -DCMAKE_CXX_FLAGS=-O1 -DFCD_SANITIZE_THREAD=ON
suite fuzz -DFCD_FUZZ=ON -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=None "-DCMAKE_CXX_FLAGS=-O1 -g1"

for version in 2025.7:venv 2022.2:venv-2022; do
    host=pymeshlab-${version%:*} python=$build/${version#*:}/bin/python
    export FCD_PLUGIN=$build/plugins/$host/libfilter_fcd.so
    if [ ! -e "$FCD_PLUGIN" ]; then
        without "host tests ($host)" "there is no $FCD_PLUGIN"
    elif ! "$python" -c 'import pymeshlab' 2>"$results/$host.log"; then
        without "host tests ($host)" "$(tail -n 1 "$results/$host.log")"
    else
        faults "$host"
        host "$host" "$python" tests/host_pymeshlab.py tests/host_process.py
    fi
done

export FCD_MESHLABSERVER=$build/meshlab-2020.09/meshlabserver
if [ ! -x "$FCD_MESHLABSERVER" ] || [ ! -e "$build/plugins/meshlab-2020.09/libfilter_fcd.so" ]; then
    without "host tests (meshlab-2020.09)" "there is no meshlabserver or no plugin for it"
elif ! xvfb-run -a true 2>"$results/xvfb.log"; then
    without "host tests (meshlab-2020.09)" "xvfb-run does not work: $(tail -n 1 "$results/xvfb.log")"
else
    faults meshlab-2020.09
    host meshlab-2020.09 "$build/venv/bin/python" tests/host_meshlabserver.py
fi

check messages python3 tests/messages.py "$FCD_MESSAGES"

finish
