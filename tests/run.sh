#!/usr/bin/env bash
# Sets the machine up, builds, and runs tests: as many suites at a time as there are cores, beside them those that wait most of the
# time, and what each one says when it ends. The last line is the sum: "N passed, N failed, N skipped". What cannot run counts as
# skipped, as failed where CI=true.
#
#   bash tests/run.sh        whether it works here
#   bash tests/run.sh all    and what protects a release
#
# What each suite has, the longest first; each tells its seconds as it ends.
#
#   in both      tools-2020.09       FCD: Bend and FCD: Fit by a scripted mouse in MeshLab's window, several windows at a time
#                unit                the unit tests, on the method as the plugin has it (with "all" faults and meshes/, too)
#                unit-build          ... are compiled (with "all" the method as sanitizers want it, too)
#                python-package      the wheel: with numpy alone, and with pymeshlab and what examples/ need; types
#                pymeshlab-2025.7    the filters in the newest pymeshlab, fits
#                hosts               the rest of the set-up (with "all" all hosts, and by GCC that of the window)
#                meshlab-2020.09     meshlabserver
#                window-2020.09      the filters' dialogs
#                rooms               who includes whom
#   with "all"   python-release      the source distribution; the package's tests with UndefinedBehaviorSanitizer and assertions
#                unit-addresses      AddressSanitizer, UndefinedBehaviorSanitizer, coverage
#                unit-threads        ThreadSanitizer
#                sanitized-plugins   what is between MeshLab and the method, for:
#                sanitized-host      ... pymeshlab, with coverage
#                sanitized-window    ... and the window
#                meshlab-faults      valgrind, and faults at each report and step of memory in meshlabserver
#                pymeshlab-faults    the same faults in pymeshlab
#                fuzz                the readers
#                pymeshlab-2022.2    the older pymeshlab
#                clang-tidy-*        of the method, layer_fcd, filter_fcd and edit_fcd
#                cppcheck            of all
#                package             the library as others take it, by GCC
#                manual, messages    links of the manual; that a test has seen each message
set -uo pipefail
shopt -s nullglob
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root" || exit 1
case ${1:-} in
"") all= ;;
all) all=all ;;
*)
    echo "tests/run.sh: '$1' is not 'all': bash tests/run.sh [all]" >&2
    exit 2
    ;;
esac
build=$root/build
cache=${XDG_CACHE_HOME:-$HOME/.cache}/fcd
results=$build/results
rm -rf "$results"
mkdir -p "$results"
export CCACHE_BASEDIR=$root CCACHE_NOHASHDIR=1 # a clone elsewhere takes what another has compiled
export FCD_MESSAGES=$results/messages.txt # what the tests are told, for tests/messages.py
name=setup # of the suite; each is a process of its own
suites=()

# add PASSED FAILED SKIPPED
add() { echo "$*" >>"$results/$name.count"; }
fail() {
    echo "FAILED: $1"
    add 0 1 0
}
# without REASON: the suite cannot run.
without() {
    if [ "${CI:-}" = true ]; then
        fail "$name: $1"
    else
        echo "SKIPPED: $name: $1"
        add 0 0 1
    fi
}

waiting=() # the processes of the suites that wait for a window or a scripted mouse most of the time
# begin NAME COMMAND...: a suite beside the others.
begin() {
    name=$1
    suites+=("$name")
    shift
    (
        SECONDS=0
        "$@" >"$results/$name.out" 2>&1 9>&-
        times >"$results/$name.times"
        flock 9
        echo "== $name: $SECONDS s, of cores $(awk -F '[ms ]' '{ for (i = 1; i < NF; i += 3) sum += 60 * $i + $(i + 1) } END { printf "%d", sum }' "$results/$name.times") s"
        cat "$results/$name.out"
    ) 9>"$results/lock" &
}
# wait_beside NAME COMMAND...: a suite that waits. A window does not wait for those that compute.
wait_beside() {
    begin "$@"
    waiting+=($!)
}
# start NAME COMMAND...: a suite that computes, when a core is free.
start() {
    while [ "$(jobs -rp | grep -vcxFf <(printf '%s\n' "${waiting[@]}"))" -ge "$(nproc)" ]; do wait -n; done
    begin "$1" nice_suite "${@:2}"
}
nice_suite() {
    renice -n 5 -p $BASHPID >/dev/null
    "$@"
}

# first COMMAND...: in both tiers. more COMMAND...: in the second.
first() { "$@"; }
more() { [ -z "$all" ] || "$@"; }

# finish: waits for the suites, and sums up.
finish() {
    local passed failed skipped
    wait
    for name in "${suites[@]}"; do
        [ -s "$results/$name.count" ] || fail "$name ended early, see $results/$name.out"
    done
    echo "== the slowest tests (of $SECONDS s in all)"
    python3 tests/junit.py slowest "$results"/*.xml "$results"/*/*.xml
    [ -n "$all" ] || echo "This was the first tier. Sanitizers, faults, fuzzing, the other hosts and checks of the sources: bash tests/run.sh all"
    read -r passed failed skipped < <(cat "$results"/*.count | awk '{ p += $1; f += $2; s += $3 } END { print p, f, s }')
    echo "$passed passed, $failed failed, $skipped skipped"
    [ "$failed" = 0 ]
    exit
}

# count: adds up the JUnit files of ctest, GoogleTest or pytest.
count() {
    if [ -s "$results/$name.xml" ]; then
        python3 tests/junit.py count "$results/$name.xml" "$results/$name"/*.xml >>"$results/$name.count"
    else
        fail "$name gave no result"
    fi
}

# build_tests FOLDER TARGETS CMAKE-ARGUMENT...: tests that ctest runs, in build/FOLDER.
build_tests() {
    local directory=$build/$1 targets arguments
    read -ra targets <<<"$2"
    shift 2
    arguments="$root $*"
    # CMake forgets its variables when the compiler changes.
    if [ "$(cat "$directory/arguments" 2>/dev/null)" != "$arguments" ]; then
        rm -rf "$directory"
        mkdir -p "$directory"
        echo "$arguments" >"$directory/arguments"
    fi
    if ! { cmake -G Ninja -S . -B "$directory" -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER=clang++ "$@" &&
        nice ninja -C "$directory" -j "${jobs:-1}" "${targets[@]}"; } >"$results/$name.log" 2>&1; then
        grep -m 5 -E 'error|Error' "$results/$name.log" || tail -n 5 "$results/$name.log"
        fail "building $name, see $results/$name.log"
        return 1
    fi
    add 0 0 0
}
# What else is compiled by clang takes the method from there, and not that of the window, which is by GCC: two compilers lay out a
# lambda differently, and the linker takes one of two functions that are called with it.
method=$build/cmake/pymeshlab-2025.7
# unit_build TARGETS: the tests once, with the method as it is in the plugin, and as sanitizers want it.
unit_build() {
    jobs=2 build_tests unit "$1" -DFCD_BUILD_TESTS=ON -DFCD_SANITIZE=ON -DCMAKE_BUILD_TYPE=Release "-DFCD_METHOD=$method" \
        "-DFCD_VCGLIB=$cache/vcglib"
}
# unit FOLDER TESTS: those that ctest runs there, by a regular expression, and each test of the programs among them.
unit() {
    LOCPATH=$build/locale GTEST_OUTPUT=xml:$results/$name/ ctest --test-dir "$build/$1" --output-on-failure -R "$2" \
        --output-junit "$results/$name.xml" 2>&1 | tee "$results/$name.log" | grep -vE '^ *[0-9]+/[0-9]+ Test .* Passed|^ +Start '
    count
}
# On one core: threads that count lines are slow side by side, and lose counts.
unit_addresses() {
    taskset -pc "$(taskset -pc $BASHPID | grep -oE '[0-9]+$')" $BASHPID >"$results/core.log"
    LLVM_PROFILE_FILE=$results/%4m.profraw unit unit _tests_addresses
    check coverage bash tests/coverage.sh vcg_ext 95 "$build/unit/tests/fcd_unit_tests_addresses" "$results"/*.profraw
    tail -n 1 "$results/coverage.log"
}
fuzz() {
    build_tests fuzz all -DFCD_FUZZ=ON -DCMAKE_BUILD_TYPE=None "-DCMAKE_CXX_FLAGS=-O1 -g1" "-DFCD_VCGLIB=$cache/vcglib" &&
        unit fuzz Fuzz
}

# host COMMAND... tests/FILE...: host tests with a command that is the Python of a pymeshlab.
host() {
    local python=()
    while [[ $1 != tests/* ]]; do
        python+=("$1")
        shift
    done
    "${python[@]}" -m pytest -q -ra -p no:cacheprovider --junitxml="$results/$name.xml" "$@" 2>&1 | tee "$results/$name.log"
    count
}
# faults HOST: builds the host in which things go wrong.
faults() {
    nice ninja -C "$build/cmake/$1" -j 1 host_faults >"$results/host_faults-$1.log" 2>&1 || fail "building host_faults for $1"
}
# pymeshlab VERSION PYTHON ARGUMENT...: and more tests, or pytest's arguments
pymeshlab() {
    export FCD_PLUGIN=$build/plugins/pymeshlab-$1/libfilter_fcd.so
    if [ ! -e "$FCD_PLUGIN" ]; then
        without "there is no $FCD_PLUGIN"
    elif ! "$2" -c 'import pymeshlab' 2>"$results/$name.log"; then
        without "$(tail -n 1 "$results/$name.log")"
    else
        host "$2" tests/host_pymeshlab.py tests/host_pose.py tests/host_copy.py tests/host_tags.py tests/host_session.py tests/host_straighten.py tests/host_symmetrize.py tests/host_compensate.py tests/host_sequence.py tests/host_process.py "${@:3}" -k "not little_memory"
    fi
}
# The newest one, and what asks the method more than the host: the fits.
newest() {
    pymeshlab 2025.7 "$build/venv/bin/python" tests/host_fit.py tests/host_fit_pairs.py tests/host_results.py
}
newest_faults() {
    faults pymeshlab-2025.7
    FCD_PLUGIN=$build/plugins/pymeshlab-2025.7/libfilter_fcd.so host "$build/venv/bin/python" tests/host_process.py -k little_memory
}
# sanitized_plugin HOST TARGET...: what is between MeshLab and the method, with sanitizers, in build/sanitized/HOST.
sanitized_plugin() {
    local host=$1 directory=$build/sanitized/$1 arguments
    local taken=() # of that host alone: the method brings the VCG that it was compiled with
    [ "$build/cmake/$host" != "$method" ] || taken=("-DFCD_METHOD=$method")
    shift
    mapfile -t arguments < <(tail -n +2 "$build/cmake/$host/arguments" | grep -v -e FCD_OUTPUT_DIR -e CMAKE_CXX_COMPILER=)
    if cmake -G Ninja -S . -B "$directory" "${arguments[@]}" -DCMAKE_CXX_COMPILER=clang++ -DFCD_OUTPUT_DIR="$directory/plugins" \
        -DFCD_SANITIZE_PLUGINS=ON "${taken[@]}" >"$results/$name-$host.log" 2>&1 && nice ninja -C "$directory" -j 1 "$@" >>"$results/$name-$host.log" 2>&1; then
        add 0 0 0
    else
        grep -m 5 -E 'error|Error' "$results/$name-$host.log"
        rm -rf "$directory/plugins"
        fail "building $name for $host, see $results/$name-$host.log"
    fi
}
sanitized_plugins() {
    sanitized_plugin meshlab-2020.09 filter_fcd edit_fcd
    sanitized_plugin pymeshlab-2025.7 filter_fcd
}
# The sanitizers' runtime, which has to be loaded first.
runtime() {
    clang -print-file-name="libclang_rt.asan-$(uname -m).so"
}
sanitized_host() {
    local plugin=$build/sanitized/pymeshlab-2025.7/plugins/libfilter_fcd.so
    FCD_PLUGIN=$plugin LLVM_PROFILE_FILE=$results/%4m.hostraw ASAN_OPTIONS=detect_leaks=0 \
        host env LD_PRELOAD="$(runtime)" "$build/venv/bin/python" tests/host_pose.py tests/host_copy.py tests/host_tags.py tests/host_session.py tests/host_fit.py tests/host_results.py tests/host_straighten.py tests/host_symmetrize.py tests/host_compensate.py tests/host_sequence.py
    check coverage-host bash tests/coverage.sh layer_fcd 80 "$plugin" "$results"/*.hostraw
    tail -n 1 "$results/coverage-host.log"
}
# The tool in a window of its own, for tests that use all of it.
sanitized_window() {
    local directory=$build/sanitized/meshlab-2020.09 system
    system=$(readlink -f "$build/meshlab-2020.09/plugins/libedit_align.so")
    system=${system%/plugins/*}
    ln -sf "$system"/plugins/*.so "$directory/plugins/"
    cp "$build/meshlab-2020.09/meshlab.bin" "$directory/"
    sed "s|^LD_LIBRARY_PATH|LD_PRELOAD=$(runtime) &|" "$build/meshlab-2020.09/meshlab" >"$directory/meshlab"
    chmod +x "$directory/meshlab"
    # What is freed stays resident while the sanitizer keeps it aside: 256 MB by default, which would hide what grows.
    FCD_MESHLAB=$directory/meshlab ASAN_OPTIONS=detect_leaks=0:quarantine_size_mb=16 with_meshlabserver tests/host_edit.py \
        -k "monkey or leaves_nothing or tags_of_the_filter"
}
# The Python package, from its wheel.
python_package() {
    bash tests/python_package.sh test "$results/$name.xml" 2>&1 | tee "$results/$name.log"
    count
}
# with_meshlabserver TEST...
with_meshlabserver() {
    export FCD_MESHLABSERVER=$build/meshlab-2020.09/meshlabserver
    if [ ! -x "$FCD_MESHLABSERVER" ] || [ ! -e "$build/plugins/meshlab-2020.09/libfilter_fcd.so" ]; then
        without "there is no meshlabserver or no plugin for it"
    elif ! xvfb-run -a true 2>"$results/xvfb.log"; then
        without "xvfb-run does not work: $(tail -n 1 "$results/xvfb.log")"
    else
        host "$build/venv/bin/python" "$@"
    fi
}
meshlabserver() {
    # shellcheck disable=SC2046
    with_meshlabserver tests/host_meshlabserver.py $([ -z "$all" ] || echo tests/host_readme.py) -k "not valgrind and not little_memory"
}
# Under valgrind, and with faults at each report and each step of memory.
meshlabserver_faults() {
    [ ! -d "$build/cmake/meshlab-2020.09" ] || faults meshlab-2020.09
    with_meshlabserver tests/host_meshlabserver.py -k "valgrind or little_memory"
}
window() {
    export FCD_MESHLAB=$build/meshlab-2020.09/meshlab FCD_PLUGIN=$build/plugins/pymeshlab-2025.7/libfilter_fcd.so
    if [ ! -x "$FCD_MESHLAB" ] || [ ! -e "$build/plugins/meshlab-2020.09/libfilter_fcd.so" ]; then
        without "there is no MeshLab 2020.09 or no plugin for it"
    elif ! xvfb-run -a true 2>"$results/xvfb.log"; then
        without "xvfb-run does not work: $(tail -n 1 "$results/xvfb.log")"
    else
        host xvfb-run -a -s "-screen 0 1366x768x24" "$build/venv/bin/python" tests/host_window.py
    fi
}
# check LOG PROGRAM ARGUMENT...: passes when the program, which prints what it finds, does.
check() {
    local log=$results/$1.log
    shift
    if ! command -v "$1" >"$log"; then
        without "there is no $1"
    elif nice "$@" >"$log" 2>&1; then
        add 1 0 0
        return
    else
        grep -m 20 -E '(error|warning|style|performance|portability):' "$log" || tail -n 20 "$log"
        fail "$(basename "$log" .log), see $log"
    fi
    return 1
}
# once CHECK...: a check of sources, which need not run again when it has passed on the same, listed in NAME.input.
once() {
    local input=$results/$name.input passed=$build/$name.passed
    echo "$*" >>"$input"
    if cmp -s "$input" "$passed"; then
        echo "nothing has changed since it passed"
        add 1 0 0
    else
        rm -f "$passed"
        "$@" && cp "$input" "$passed"
    fi
}

# tidy FOLDER HOST: of the sources as they are compiled, several as one. Ninja knows what they include.
tidy() {
    local directory=$build/cmake/$2 included source sources=("$build/cmake/$2/$1/CMakeFiles/$1.dir/Unity/unity_0_cxx.cxx")
    [ "$1" != vcg_ext ] || sources=("$root"/vcg_ext/unity/*.cpp)
    for source in "${sources[@]}"; do
        mapfile -t included < <(ninja -C "$directory" -t deps |
            awk -v object="/${source##*/}.o:" 'index($1, object) { is = 1; next } /^[^ ]/ { is = 0 } is && NF { print $1 }')
        [ ${#included[@]} -gt 0 ] || fail "ninja does not know what $source includes"
        (cd "$directory" && sha256sum "$root"/{.clang-tidy,CMakeLists.txt,"$1/CMakeLists.txt",layer_fcd/fcd_plugin.cmake} arguments \
            "$build/venv-tools/requirements" "${included[@]}") >>"$results/$name.input"
    done
    once check "$name" "$build/venv-tools/bin/clang-tidy" --checks=-bugprone-suspicious-include -quiet -p "$directory" "${sources[@]}"
}

hosts() {
    if bash tests/setup.sh "${all:-tests}"; then
        add 0 0 0
    else
        fail "setup"
    fi
}

if ! FCD_WINDOW_COMPILER=${all:+g++} bash tests/setup.sh window; then
    fail "setup"
    finish
fi

# The suites, each once, in the order in which they begin: what takes longest begins first.
first wait_beside tools-2020.09 with_meshlabserver tests/host_edit*.py -n 5 --maxschedchunk=1
first start hosts hosts
wait $!
first wait_beside window-2020.09 window
first start unit-build unit_build "${all:-fcd_unit_tests}"
unit=$!
first start pymeshlab-2025.7 newest
first start python-package python_package
python=$!
first start meshlab-2020.09 meshlabserver
more start sanitized-plugins sanitized_plugins
plugins=$!
wait "$unit"
more start unit-addresses unit_addresses
more start unit-threads unit unit _tests_threads
first start unit unit unit "^fcd_unit_tests\$${all:+|^fcd_fault_tests\$|^make_benchmark}"
first start rooms check rooms python3 tests/rooms.py
more start fuzz fuzz
more start pymeshlab-2022.2 pymeshlab 2022.2 "$build/venv-2022/bin/python"
more start pymeshlab-faults newest_faults
more start meshlab-faults meshlabserver_faults
[ -z "$all" ] || wait "$plugins"
more wait_beside sanitized-window sanitized_window
more start sanitized-host sanitized_host
more start package check package bash tests/package.sh
wait "$python"
more start python-release check python-release bash tests/python_package.sh release
more start clang-tidy-method tidy vcg_ext pymeshlab-2025.7
for folder in layer_fcd filter_fcd edit_fcd; do find "$folder" -name '*.cpp' -printf '#include "%p"\n' | sort >"$results/$folder.cpp"; done # as they are compiled
[ -z "$all" ] || (cppcheck --version && find vcg_ext {layer,filter,edit}_fcd tests/cppcheck.txt -type f | sort | xargs sha256sum) >"$results/cppcheck.input"
more start cppcheck once check cppcheck cppcheck -q --enable=warning,style,performance,portability --error-exitcode=1 --language=c++ \
    --std=c++17 --library=qt --suppressions-list=tests/cppcheck.txt -I . vcg_ext/unity/*.cpp "$results"/{layer,filter,edit}_fcd.cpp
more start clang-tidy-layer tidy layer_fcd pymeshlab-2025.7
more start clang-tidy-filter tidy filter_fcd pymeshlab-2025.7
more start clang-tidy-edit tidy edit_fcd meshlab-2025.07
more start manual check manual "$build/venv-tools/bin/mkdocs" build --strict --quiet
wait
more start messages check messages python3 tests/messages.py "$FCD_MESSAGES" # after all that it hears

finish
