#!/usr/bin/env bash
# How many lines of a folder the tests run, file by file. Fails below so many percent of all.
#
#   bash tests/coverage.sh FOLDER PERCENT PROGRAM PROFILE...    (compiled with -fprofile-instr-generate -fcoverage-mapping; *.profraw)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=$1 least=$2 program=$3
shift 3
profile=$(mktemp)
trap 'rm -f "$profile"' EXIT
build=$(dirname "$program") # where it was compiled: sources are named from there
until [ -e "$build/build.ninja" ] || [ "$build" = / ]; do build=$(dirname "$build"); done
llvm=$(clang -dumpversion | cut -d. -f1)
"llvm-profdata-$llvm" merge -o "$profile" "$@"
"llvm-cov-$llvm" report "$program" -compilation-dir="$build" -instr-profile="$profile" -show-region-summary=false -show-branch-summary=false "$folder"
"llvm-cov-$llvm" export "$program" -compilation-dir="$build" -instr-profile="$profile" -summary-only "$folder" | python3 -c '
import json, sys
lines = json.load(sys.stdin)["data"][0]["totals"]["lines"]
print("{covered} of {count} lines, {percent:.2f} %".format(**lines))
sys.exit(not lines["percent"] >= float(sys.argv[1]))' "$least"
