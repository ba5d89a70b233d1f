#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# How near the shapes that this plugin makes are to CGAL's SR-ARAP (installed where it is missing), run to convergence, on
# cases that the constants are chosen on and on others, and what moves them (see tests/benchmark/quality_benchmark.cpp).
#
#   bash tests/quality.sh [OPTION ...] [STEM ...]        --help lists the options
#
# CGAL takes some minutes a case, once: its results are kept in ${XDG_CACHE_HOME:-~/.cache}/fcd/references.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source tests/peers_build.sh
build_peers quality_benchmark
build/cmake/peers/tests/quality_benchmark "$@"
