#!/usr/bin/env bash
# clang-tidy over what a build folder compiles, without the tests, which would take as long again:
# check_tidy.sh BUILD [FILE-PATTERN]. Exit status 77: it cannot be told here.
build=${1:?a build folder is needed}
pattern=${2:-}
command -v clang-tidy >/dev/null || { echo "skipped: there is no clang-tidy" && exit 77; }
[[ $(clang-tidy --version) == *"version 14."* ]] || { echo "skipped: clang-tidy is not of version 14" && exit 77; }
cd "$(dirname "$0")/.." || exit 1
mapfile -t files < <(sed -n 's/^ *"file": "\(.*\)".*/\1/p' "$build/compile_commands.json" | grep -v "^$PWD/tests/" |
  grep -v "/bench/slab_tests.cpp$" | grep -e "$pattern" | sort -u)
[ ${#files[@]} -gt 0 ] || { echo "FAILED: $build compiles nothing" && exit 1; }
# bench/slab_tests.cpp is left out for what is found in the header of Google Benchmark. g++ knows warnings that clang
# does not.
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P 2 clang-tidy -p "$build" --quiet \
  --extra-arg=-Wno-unknown-warning-option 2>/dev/null && echo "${#files[@]} files are all right"
