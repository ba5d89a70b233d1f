#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The plugin beside CGAL, Open3D and libigl, which are installed where they are missing; half an hour on two cores. Everything goes to
# build/peers:
#   peers.csv, scans.md, scans.png   seconds and memory on scans of growing size    (see tests/peers.py)
#   dirty.md, dirty_*.png            what becomes of dirty scans
#   shapes.csv, SHAPE.png            the shapes of the benchmark of Botsch and Sorkine, with CGAL's ARAP and SR-ARAP: time to
#                                    convergence, and to our distance from it         (see tests/benchmark/deformation_benchmark.cpp)
#   SHAPE_error.csv, errors.png      how near each is to SR-ARAP's limit after how many seconds
#
#   bash tests/peers.sh [STEM ...]
#
# With STEM.off or STEM.ply, STEM.sel and STEM.def, only these, as shapes.
set -euo pipefail
shopt -s nullglob
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/peers_build.sh
export FCD_PEERS=1
build_peers cgal_peer deformation_benchmark make_benchmark
mkdir -p build/peers
make() { [ -e "$2.ply" ] || build/cmake/peers/meshes/make_benchmark "$1" "$2.ply" -n "$3" >&2; }
if [ $# = 0 ]; then
    scans=()
    for size in 5000 35000 150000 450000 1400000 3600000; do
        scans+=("build/peers/cactus_$size")
        make cactus "${scans[-1]}" "$size"
    done
    rm -f build/peers/dirty_* # results of an earlier run are not drawn again
    build/venv-peers/bin/python tests/peers.py build/peers --cgal build/cmake/peers/tests/cgal_peer \
        --plugin build/plugins/pymeshlab-2025.7/libfilter_fcd.so --scans "${scans[@]}"
    for rest in build/peers/dirty_*.sel; do
        stem=${rest%.sel}
        panels=()
        for result in "$stem"__*.ply; do panels+=("$result@$(basename "${result#"$stem"__}" .ply)"); done
        [ ${#panels[@]} = 0 ] || build/venv/bin/python tests/render.py "$stem.png" --view 1,-2,0.5 "${panels[@]}" >&2
    done
    for shape in bar:6084 cactus:5261 cylinder:4802 plane:40401; do # on the plane, CGAL takes long
        make "${shape%:*}" "build/peers/${shape%:*}" "${shape#*:}"
        set -- "$@" "build/peers/${shape%:*}"
    done
fi
build/cmake/peers/tests/deformation_benchmark build/peers "$@" | tee build/peers/shapes.csv
errors=()
for stem in "$@"; do
    rest=$stem.off
    [ -e "$rest" ] || rest=$stem.ply
    to=build/peers/$(basename "$stem")
    errors+=("${to}_error.csv")
    build/venv/bin/python tests/render.py "$to.png" --view 1,-2,0.5 "$rest:tags=$stem.sel@input" "${to}_arap.off@ARAP" \
        "${to}_sr_arap_as_near.off@SR-ARAP" "${to}_fcd.off@FCD" >&2
done
build/venv-peers/bin/python tests/peers.py build/peers --errors "${errors[@]}"
