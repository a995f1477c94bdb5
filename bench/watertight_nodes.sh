#!/usr/bin/env bash
# Counts with callgrind how many instructions a node takes with and without what makes the walk watertight.
# Example: bench/watertight_nodes.sh build/release/bin/kerf_bench_watertight_nodes
set -u
for command in valgrind callgrind_annotate; do
  command -v $command >/dev/null || { echo "skipped: there is no $command" && exit 77; }
done
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
valgrind --tool=callgrind --callgrind-out-file="$work/out" "$1" >"$work/said" 2>"$work/log" ||
  { cat "$work/log" && exit 1; }
callgrind_annotate --inclusive=yes --threshold=100 "$work/out" >"$work/functions" || exit 1

# said NAME, counted FUNCTION
said() { awk -F '\t' -v name="$1" '$1 == name { print $2 }' "$work/said"; }
counted() { grep -F "::$1(" "$work/functions" | head -n 1 | awk '{ gsub(",", "", $1); print $1 }'; }

printf '%-12s %10s %12s %20s\n' "" nodes "nodes a ray" "instructions a node"
for kind in watertight plain; do
  awk -v kind=$kind -v rays="$(said rays)" -v nodes="$(said nodes_$kind)" -v all="$(counted walk_$kind)" \
    -v start="$(counted start_$kind)" 'BEGIN {
      printf "%-12s %10d %12.1f %20.2f\n", kind, nodes, nodes / rays, (all - start) / (nodes - rays) }'
done | tee "$work/table"
# Not more than a hundredth apart, and both counted at all.
awk '{ node[$1] = $4 } END { exit !(node["plain"] > 10 && node["watertight"] <= 1.01 * node["plain"]) }' "$work/table" ||
  { echo "FAILED: a watertight node takes more instructions" && exit 1; }
