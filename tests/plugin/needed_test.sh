#!/usr/bin/env bash
# needed_test.sh LIBRARY LIST: the library needs the shared libraries of LIST at run time, and no other. The C and C++
# runtime's own libraries differ between machines and compilers, and are not listed.
set -euo pipefail
diff <(objdump -p "$1" | awk '$1 == "NEEDED" {print $2}' | grep -Ev '^(lib(c|m|gcc_s|stdc\+\+|pthread|dl)|ld-linux.*|lib(a|t|ub)san)\.so' | sort) "$2" || {
  echo "the library's needs (<) differ from $2 (>): each is a package that everybody must install who loads it" >&2
  exit 1
}
