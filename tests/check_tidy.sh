#!/usr/bin/env bash
# clang-tidy over what a build folder compiles, without the tests, which would take as long again:
# check_tidy.sh [--fifths] BUILD [FILE-PATTERN]. Exit status 77: it cannot be told here.
# --fifths: one fifth of the files, another one with each commit, and those that the last commit touched.
fifths=
[ "${1:-}" != --fifths ] || { fifths=1 && shift; }
build=${1:?a build folder is needed}
pattern=${2:-}
command -v clang-tidy >/dev/null || { echo "skipped: there is no clang-tidy" && exit 77; }
[[ $(clang-tidy --version) == *"version 14."* ]] || { echo "skipped: clang-tidy is not of version 14" && exit 77; }
cd "$(dirname "$0")/.." || exit 1
mapfile -t files < <(sed -n 's/^ *"file": "\(.*\)".*/\1/p' "$build/compile_commands.json" | grep -v "^$PWD/tests/" |
  grep -v "/bench/slab_tests.cpp$" | grep -e "$pattern" | sort -u)
if [ -n "$fifths" ] && commits=$(git rev-list --count HEAD 2>/dev/null); then
  touched=" $(git diff-tree -r --name-only --no-commit-id HEAD | tr '\n' ' ') "
  all=("${files[@]}") files=()
  for i in "${!all[@]}"; do
    if [ $((i % 5)) = $((commits % 5)) ] || [[ $touched == *" ${all[i]#"$PWD/"} "* ]]; then files+=("${all[i]}"); fi
  done
fi
[ ${#files[@]} -gt 0 ] || { echo "FAILED: $build compiles nothing" && exit 1; }
# bench/slab_tests.cpp is left out for what is found in the header of Google Benchmark. g++ knows warnings that clang
# does not.
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P 2 clang-tidy -p "$build" --quiet \
  --extra-arg=-Wno-unknown-warning-option 2>/dev/null && echo "${#files[@]} files are all right"
