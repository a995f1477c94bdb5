#!/usr/bin/env bash
# Installs Kerf as built, moves it, and uses it from outside: with find_package(kerf), and with pkg-config.
# shellcheck source=tests/package/common.sh
source "$(dirname "$0")/common.sh"

"$KERF_CMAKE" --install "$KERF_BUILD" --prefix "$work/first" >"$work/log" || { cat "$work/log" && fail "it cannot be installed"; }
mv "$work/first" "$work/moved"
no_path_of "$work/moved" "$work"
no_path_of "$work/moved" "$KERF_SOURCE"
no_path_of "$work/moved" "$KERF_BUILD"
make_outside "$work/moved"
build_outside "$work/moved"

if [ -e "$work/moved/bin/kerf" ]; then
  "$work/moved/bin/kerf" list >/dev/null || fail "the installed program does not run"
fi

command -v pkg-config >/dev/null || { echo "no pkg-config here: that way was not tried" && exit 0; }
pc=$(find "$work/moved" -name kerf.pc)
flags=$(PKG_CONFIG_PATH=$(dirname "$pc") pkg-config --static --cflags --libs kerf) || fail "pkg-config finds no kerf"
libraries=$(find "$work/moved" -name 'libkerf.*' -printf '%h\n' -quit)
# shellcheck disable=SC2086
"$KERF_CXX" -std=c++20 -Wall -Wextra -Werror $KERF_SANITIZE_FLAGS "$work/outside/outside.cpp" -o "$work/with_pc" $flags \
  -Wl,-rpath,"$libraries" || fail "the flags of pkg-config do not do: $flags"
check_program "$work/with_pc"
