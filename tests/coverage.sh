#!/usr/bin/env bash
# How many lines of vcg_ext the unit tests run, file by file. Fails below 95 % of all.
#
#   bash tests/coverage.sh PROGRAM PROFILE...    (compiled with -fprofile-instr-generate -fcoverage-mapping; *.profraw)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=$1
shift
profile=$(mktemp)
trap 'rm -f "$profile"' EXIT
llvm=$(clang -dumpversion | cut -d. -f1)
"llvm-profdata-$llvm" merge -o "$profile" "$@"
"llvm-cov-$llvm" report "$program" -instr-profile="$profile" -show-region-summary=false -show-branch-summary=false vcg_ext
"llvm-cov-$llvm" export "$program" -instr-profile="$profile" -summary-only vcg_ext | python3 -c '
import json, sys
lines = json.load(sys.stdin)["data"][0]["totals"]["lines"]
print("{covered} of {count} lines of vcg_ext, {percent:.2f} %".format(**lines))
sys.exit(not lines["percent"] >= 95)'
