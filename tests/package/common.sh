# shellcheck shell=bash
# Sourced by the tests of the installed package. CMake, the compiler, the build tool and the flags that go with its
# sanitizers come from the build that is tested, through the environment; see checks.cmake.

set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
expected="kerf $KERF_VERSION: triangle 1 at 5"

fail() {
  echo "FAILED: $*"
  exit 1
}

# make_outside PREFIX: copies the outside project to $work/outside, with a list of all headers under PREFIX that are of
# libkerf.
make_outside() {
  cp -r "$here/outside" "$work/outside"
  (cd "$1/include" && find kerf -name '*.h' ! -path 'kerf/io/*' ! -path 'kerf/render/*' | LC_ALL=C sort) |
    sed 's/.*/#include <&>/' >"$work/outside/all_headers.h"
  [ "$(wc -l <"$work/outside/all_headers.h")" -gt 20 ] || fail "hardly any headers were installed"
}

# no_path_of PREFIX FOLDER: nothing that was installed for CMake and pkg-config names the folder.
no_path_of() {
  ! grep -r -F "$2" "$1"/lib*/cmake "$1"/lib*/pkgconfig || fail "the installed package names $2"
}

# check_program PROGRAM
check_program() {
  local said
  said=$("$1") || fail "$1 does not run"
  [ "$said" = "$expected" ] || fail "$1 said '$said', not '$expected'"
}

# build_outside PREFIX
build_outside() {
  "$KERF_CMAKE" -S "$work/outside" -B "$work/outside-build" -G "$KERF_GENERATOR" -DCMAKE_PREFIX_PATH="$1" \
    -DCMAKE_MAKE_PROGRAM="$KERF_MAKE" -DCMAKE_CXX_COMPILER="$KERF_CXX" -DCMAKE_CXX_FLAGS="$KERF_SANITIZE_FLAGS" \
    -DWITH_RENDER="$(find "$1" -name kerf-render-targets.cmake)" ||
    fail "the outside project cannot be configured"
  "$KERF_CMAKE" --build "$work/outside-build" || fail "the outside project cannot be built"
  check_program "$work/outside-build/outside"
}
