#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Deforms the benchmark shapes by this plugin's method and by CGAL's ARAP and SR-ARAP (installed where it is missing), prints
# a CSV line for each (see tests/benchmark/deformation_benchmark.cpp), and draws them side by side: build/peers/NAME.png.
#
#   bash tests/peers.sh [STEM ...]
#
# STEM.off or STEM.ply, STEM.sel and STEM.def; by default the shapes of meshes/ at the size that the benchmark of Botsch and
# Sorkine has, of which the plane takes CGAL a long time.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/peers_build.sh
build_peers deformation_benchmark make_benchmark
mkdir -p build/peers
if [ $# = 0 ]; then
    for shape in bar:6084 cactus:5261 cylinder:4802 plane:40401; do
        build/cmake/peers/meshes/make_benchmark "${shape%:*}" "build/peers/${shape%:*}.ply" -n "${shape#*:}" >&2
        set -- "$@" "build/peers/${shape%:*}"
    done
fi
build/cmake/peers/tests/deformation_benchmark build/peers "$@"
for stem in "$@"; do
    rest=$stem.off
    [ -e "$rest" ] || rest=$stem.ply
    to=build/peers/$(basename "$stem")
    build/venv/bin/python tests/render.py "$to.png" --view 1,-2,0.5 "$rest:tags=$stem.sel@input" "${to}_arap.off@ARAP" \
        "${to}_sr_arap_as_near.off@SR-ARAP" "${to}_fcd.off@FCD" >&2
done
