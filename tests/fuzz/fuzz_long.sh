#!/usr/bin/env bash
# tests/fuzz/fuzz_long.sh [SECONDS] [TARGET …]: runs libFuzzer targets for SECONDS each (default 60), as many in parallel
# as there are cores, and prints a table of results. Without TARGET it runs all targets of seeds.txt. New inputs and
# findings are kept in OSTEON_FUZZ_OUT (default build/fuzz/found). Exits with 1 if something was found or a target did
# not run.
#
# OSTEON_FUZZ_BIN: the folder of the executables (build/fuzz/tests/fuzz); OSTEON_ROOT: the repository.
set -euo pipefail

root=${OSTEON_ROOT:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)}
export OSTEON_ROOT=$root
bin=${OSTEON_FUZZ_BIN:-$root/build/fuzz/tests/fuzz}
out=${OSTEON_FUZZ_OUT:-$root/build/fuzz/found}
seconds=${1:-60}
[ $# -gt 0 ] && shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(awk '!/^#/ && NF {print $1}' "$root/tests/fuzz/seeds.txt")

# Runs one target with its seeds from seeds.txt; writes log, new inputs and findings below $out/TARGET.
run_one() {
  local target=$1 kept=$out/$1
  mkdir -p "$kept/new" "$kept/findings"
  local seeds=()
  mapfile -t seeds < <(awk -v t="$target" -v root="$root" '$1 == t {for (i = 2; i <= NF; ++i) print root "/" $i}' \
    "$root/tests/fuzz/seeds.txt")
  [ ${#seeds[@]} -gt 0 ] || { echo "no target $target in tests/fuzz/seeds.txt" >"$kept/log"; return; }
  # 16 kB is more than any shipped file; no input of that size should take two minutes
  LSAN_OPTIONS=suppressions=$root/tests/lsan.supp:print_suppressions=0 \
    ASAN_OPTIONS=allocator_may_return_null=0 "$bin/osteon_fuzz_$target" -max_total_time="$seconds" -max_len=16384 \
    -timeout=120 -report_slow_units=120 -rss_limit_mb=2048 -malloc_limit_mb=1024 -print_final_stats=1 \
    -artifact_prefix="$kept/findings/" "$kept/new" "${seeds[@]}" >"$kept/log" 2>&1 || true
}

for target in "${targets[@]}"; do
  while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n || true; done
  run_one "$target" &
done
wait

found=0
printf '%-20s %12s %8s %9s %6s %9s\n' target executions cov: features new findings
for target in "${targets[@]}"; do
  log=$out/$target/log
  last=$(grep -E '^#[0-9]+.* cov: ' "$log" | tail -n 1 || true)
  field() { sed -n "s/.* $1: \([0-9]*\).*/\1/p" <<<"$last"; }
  executions=$(sed -n 's/^stat::number_of_executed_units: //p' "$log")
  [ -n "$executions" ] || executions=$(sed -n 's/^#\([0-9]*\).*/\1/p' <<<"$last")
  findings=$(find "$out/$target/findings" -type f | wc -l)
  [ -n "$last" ] && [ "$findings" -eq 0 ] || found=1
  printf '%-20s %12s %8s %9s %6s %9s\n' "$target" "${executions:--}" "$(field cov)" "$(field ft)" \
    "$(find "$out/$target/new" -type f | wc -l)" "$findings"
done
exit "$found"
