#!/usr/bin/env bash
# symbols_test.sh LIBRARY LIST: the library exports the functions of LIST, and no other name.
set -euo pipefail
diff <(nm -D --defined-only "$1" | awk '{print $3}' | sort) "$2" || {
  echo "the library's names (<) differ from $2 (>): a name that went is a new ABI (OSTEON_ABI)" >&2
  exit 1
}
