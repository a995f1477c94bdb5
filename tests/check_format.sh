#!/usr/bin/env bash
# Is every tracked C++ file as clang-format would have it? Exit status 77: cannot be told here.
cd "$(dirname "$0")/.." || exit 1
command -v clang-format >/dev/null || { echo "skipped: there is no clang-format" && exit 77; }
# Other versions format some things otherwise; this is the one of Debian 12.
[[ $(clang-format --version) == *"version 14."* ]] || { echo "skipped: clang-format is not of version 14" && exit 77; }
mapfile -t files < <(git ls-files -- '*.h' '*.cpp' 2>/dev/null)
[ ${#files[@]} -gt 0 ] || { echo "skipped: this is no git checkout" && exit 77; }
clang-format --dry-run -Werror "${files[@]}" && echo "${#files[@]} files are all right"
