#!/usr/bin/env bash
# Compiles libkerf and the tests of its kernels for 64-bit ARM and runs them under qemu-user. Fixed rays must hit the
# same there, to the bit, as on each instruction set of this machine, and through every structure.
# Arguments: kerf_hit_hashes of this machine, the folder of Highway's headers, that of GoogleTest's sources.
set -u
native=$1 highway=$2 googletest=$3
root=/usr/aarch64-linux-gnu
build=$KERF_BUILD/neon
packages=$KERF_SOURCE/tests/neon/packages

skip() {
  echo "skipped: $*"
  exit 77
}
fail() {
  echo "FAILED: $*"
  exit 1
}
command -v aarch64-linux-gnu-g++ >/dev/null || skip "there is no aarch64-linux-gnu-g++"
qemu=$(command -v qemu-aarch64 || command -v qemu-aarch64-static) || skip "there is no qemu-aarch64"
[ -e "$root/lib/ld-linux-aarch64.so.1" ] || skip "there is no C library for aarch64 in $root"
[ -e "$highway/hwy/highway.h" ] || skip "Highway's headers were not found"
[ -e "$googletest/src/gtest-all.cc" ] || skip "GoogleTest's sources were not found"

# Programs, and what of them is about kernels and does not take long where a processor is emulated. Property tests are
# left out: there is no RapidCheck for that processor.
tests="base_test *
trace_test *
instruction_set_test *
layouts_test *
wide_collapse_test *
wide_bvh_test *
scene_test *FloatingPointMode*
batch_test Batch.*:*bvh4*:*bvh8*:*packets*-*GoesThroughBoxesThatOverlap*
structures_test *sah_bvh4:*sah_bvh8:*sah_quantised_bvh8:*sah_packets-*AnyNumberOfThreads*"
programs=$(awk '{ print $1 }' <<<"$tests")

# Assertions are on.
"$KERF_CMAKE" --no-warn-unused-cli -S "$KERF_SOURCE" -B "$build" -G "$KERF_GENERATOR" -DCMAKE_MAKE_PROGRAM="$KERF_MAKE" \
  --toolchain "$KERF_SOURCE/cmake/aarch64-linux-gnu.cmake" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O2 \
  -DKERF_TASKS=std -DKERF_PYTHON=OFF -DKERF_INSTALL=OFF -Dhwy_DIR="$packages" -DGTest_DIR="$packages" \
  -DKERF_HIGHWAY_HEADERS="$highway" -DKERF_GTEST_SOURCES="$googletest" >"$build.log" 2>&1 ||
  { cat "$build.log" && fail "it cannot be configured"; }
# shellcheck disable=SC2086
"$KERF_CMAKE" --build "$build" -j 2 --target kerf_hit_hashes $programs >"$build.log" 2>&1 ||
  { cat "$build.log" && fail "it cannot be built"; }
echo "built in $SECONDS s"

# ---- The tests, two at a time
"$qemu" -L "$root" "$build/bin/kerf_hit_hashes" >"$build/hits.neon" &
hashes=$!
export qemu root build
# shellcheck disable=SC2016
run='"$qemu" -L "$root" "$build/bin/$0" --gtest_filter="$1" >"$build/$0.log" 2>&1'
# shellcheck disable=SC2016
xargs -P 2 -n 2 bash -c "$run"' || echo "$0" >>"$build/failed"' < <(rm -f "$build/failed" && echo "$tests")
while read -r program _; do
  printf '%s: %s\n' "$program" "$(grep -E '^\[  (PASSED|FAILED)  \] [0-9]+ tests?' "$build/$program.log" || echo "no result")"
done <<<"$tests"
if [ -e "$build/failed" ]; then
  while read -r program; do cat "$build/$program.log"; done <"$build/failed"
  fail "$(tr '\n' ' ' <"$build/failed")fails on NEON"
fi

# ---- The same bits
sets=$("$qemu" -L "$root" "$build/bin/kerf_hit_hashes" --sets)
[ "$sets" = neon ] || fail "the instruction sets there are '$sets', not NEON"
wait $hashes || fail "kerf_hit_hashes fails on NEON"
[ "$(wc -l <"$build/hits.neon")" -gt 500 ] || fail "hardly any hits were hashed"
differ=$(awk -F '\t' '$3 != "tree" { key = $1 ", " $2 ", " $3; if (key in hash && hash[key] != $6) print key ": " $4; hash[key] = $6 }' "$build/hits.neon")
[ -z "$differ" ] || fail "structures differ on NEON: $differ"
for set in $("$native" --sets); do
  KERF_ISA=$set "$native" >"$build/hits.$set" || fail "kerf_hit_hashes fails on $set"
  diff "$build/hits.$set" "$build/hits.neon" || fail "trees or hits on NEON are not those on $set"
  echo "trees and hits are those on $set"
done
echo "done in $SECONDS s"
