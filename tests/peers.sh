#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The plugin beside CGAL, Open3D and libigl, and its fits beside trimesh and pycpd, which are installed where they are missing; an hour
# on two cores. Everything goes to build/peers:
#   peers.csv, scans.md, scans.png   seconds and memory on scans of growing size    (see tests/peers.py)
#   dirty.md, dirty_*.png            what becomes of dirty scans
#   shapes.csv, SHAPE.png            the shapes of the benchmark of Botsch and Sorkine, with CGAL's ARAP and SR-ARAP: time to
#                                    convergence, and to our distance from it         (see tests/benchmark/deformation_benchmark.cpp);
#                                    docs/pictures/peers.png is those of meshes/cactus and meshes/cylinder
#   SHAPE_error.csv, errors.png      how near each is to SR-ARAP's limit after how many seconds
#   fits.csv, fits.md, fit_failures.md, fit_PAIR.png    fits whose truth is known, what fails, and both in pictures
#                                    (see tests/fit_peers.py; what fits.csv has is not measured again)
#
#   bash tests/peers.sh [fits [PAIR ...] | STEM ...]
#
# With STEM.off or STEM.ply, STEM.sel and STEM.def, only these, as shapes; with "fits", only these, of all pairs or of some.
set -euo pipefail
shopt -s nullglob
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/peers_build.sh
export FCD_PEERS=1
build_peers cgal_peer deformation_benchmark make_benchmark # of these, the pairs of the fits take the first
mkdir -p build/peers
fits() {
    local ours result mode panels stem
    build/venv-peers/bin/python tests/fit_peers.py build/peers "$@"
    for ours in build/peers/fit_*__fcd.ply; do # all in the colours of one scale: percent of the diagonal from the truth
        stem=${ours%__fcd.ply}
        panels=()
        for result in "$stem"__{source,target,fcd,amberg,sumner,pycpd}.ply; do
            case $result in *__source.ply | *__target.ply) mode=plain ;; *) mode=quality ;; esac
            [ ! -e "$result" ] || panels+=("$result:$mode@$(basename "${result#"$stem"__}" .ply)")
        done
        build/venv/bin/python tests/render.py "$stem.png" --view 0.5,0.4,2 --up 0,1,0 --limit 2 --size 400x320 "${panels[@]}" >&2
    done
}
if [ "${1:-}" = fits ]; then
    fits "${@:2}"
    exit
fi
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
    fits
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
