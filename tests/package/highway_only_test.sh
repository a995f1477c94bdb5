#!/usr/bin/env bash
# Builds libkerf, as a shared library, where there is nothing but Highway, and uses it from outside.
# shellcheck source=tests/package/common.sh
source "$(dirname "$0")/common.sh"

# Everything that our CMake files look for, without the two that libkerf cannot do without.
switch_off=""
for package in $(find "$KERF_SOURCE" \( -name build -o -name '.*' \) -prune -o \( -name CMakeLists.txt -o -name '*.cmake' \) \
  -exec sed -nE 's/^[^#]*(find_package|kerf_optional)\(([A-Za-z0-9_-]+).*/\2/p' {} + | sort -u); do
  case $package in
    hwy | Threads | kerf) ;;
    *) switch_off="$switch_off -DCMAKE_DISABLE_FIND_PACKAGE_$package=ON" ;;
  esac
done

# shellcheck disable=SC2086
"$KERF_CMAKE" --no-warn-unused-cli -S "$KERF_SOURCE" -B "$work/build" -G "$KERF_GENERATOR" -DCMAKE_MAKE_PROGRAM="$KERF_MAKE" \
  -DCMAKE_CXX_COMPILER="$KERF_CXX" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=ON -DKERF_STB_INCLUDE=OFF $switch_off \
  >"$work/log" 2>&1 || { cat "$work/log" && fail "it cannot be configured"; }
cat "$work/log"
for said in "oneTBB not used, tasks run on std::thread" "GTest not found: no tests" \
  "the command line are not built" "no Python module" "embree not found"; do
  grep -q "^-- kerf: .*$said" "$work/log" || fail "CMake does not say: $said"
done
! grep -q "CMake Warning" "$work/log" || fail "CMake warns"
"$KERF_CMAKE" --build "$work/build" -j 2 >"$work/log" 2>&1 || { cat "$work/log" && fail "it cannot be built"; }
"$KERF_CMAKE" --install "$work/build" --prefix "$work/installed" >"$work/log" || { cat "$work/log" && fail "it cannot be installed"; }
! grep -r "TBB" "$work/installed"/lib*/cmake || fail "the installed package wants TBB"
KERF_SANITIZE_FLAGS=""  # this build has none
make_outside "$work/installed"
build_outside "$work/installed"
