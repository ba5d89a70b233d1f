#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Builds deformation graphs over synthetic meshes of 35 thousand to 20 million vertices, and over the meshes given, and prints
# a CSV line for each (see tests/benchmark/graph_benchmark.cpp); then what posing some of them costs (see tests/poses.py).
#
#   bash tests/benchmark.sh [MESH.ply ...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bash tests/setup.sh >&2
cache=${XDG_CACHE_HOME:-$HOME/.cache}/fcd
cmake -G Ninja -S . -B build/benchmark -DCMAKE_BUILD_TYPE=Release -DFCD_BUILD_TESTS=ON \
    -DFCD_VCGLIB="$cache/vcglib" >build/benchmark.log
ninja -C build/benchmark graph_benchmark make_benchmark >>build/benchmark.log
meshes=()
for size in 35000 450000 1400000 3600000 20000000; do
    mesh=build/benchmark/cactus_$size.ply
    [ -e "$mesh" ] || build/benchmark/meshes/make_benchmark cactus "$mesh" -n "$size" >&2
    meshes+=("$mesh")
done
build/benchmark/tests/graph_benchmark "${meshes[@]}" "$@"
build/venv/bin/python tests/poses.py build/plugins/pymeshlab-2025.7/libfilter_fcd.so build/benchmark/cactus_{450000,1400000,3600000}.ply
