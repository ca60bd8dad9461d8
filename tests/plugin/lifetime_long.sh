#!/usr/bin/env bash
# lifetime_long.sh ROOT BUILDS [asan tsan]: makes and ends a session 1000 times, with threads and in any order, under
# AddressSanitizer and under ThreadSanitizer. Builds the library and its tests below BUILDS for each; an hour on two cores.
# Exit code 1: a sanitizer found something.
set -euo pipefail
root=$(realpath "$1") builds=$2
shift 2
[[ $# -gt 0 ]] || set -- asan tsan
export LSAN_OPTIONS="suppressions=$root/tests/lsan.supp:print_suppressions=0"
export TSAN_OPTIONS="suppressions=$root/tests/tsan.supp:print_suppressions=0"
for sanitizer in "$@"; do
  case $sanitizer in
    asan) option=OSTEON_SANITIZE_ADDRESS ;;
    tsan) option=OSTEON_SANITIZE_THREAD ;;
    *) echo "lifetime_long.sh: found '$sanitizer', accepted asan or tsan" >&2; exit 2 ;;
  esac
  build=$builds/$sanitizer
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DOSTEON_PRECOMPILE=OFF "-D$option=ON" >/dev/null
  ninja -C "$build" osteon_test_plugin >"$builds/$sanitizer.log" || { tail -30 "$builds/$sanitizer.log"; exit 1; }
  # 200 sessions a run
  "$build/tests/plugin/osteon_test_plugin" --gtest_filter='*BeginAndEndManyTimesInAnyOrder' --gtest_repeat=5 \
    >"$builds/$sanitizer.txt" 2>&1 || { tail -60 "$builds/$sanitizer.txt"; exit 1; }
  echo "$sanitizer: $((200 * $(grep -c '^\[       OK' "$builds/$sanitizer.txt"))) sessions made and ended, nothing found"
done
