#!/usr/bin/env bash
# java_syntax_test.sh FILE: the file parses as Java. Exit 0 yes, 1 no, 77 no compiler here.
# Its libraries are not here, so the compiler goes on to miss their names; errors of any other kind are the file's own.
set -euo pipefail
command -v javac >/dev/null || { echo "skipped: no javac here"; exit 77; }
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
javac -proc:none -Xmaxerrs 1000 -d "$out" "$1" >"$out/log" 2>&1 || true
missing='package [A-Za-z.]+ does not exist|cannot find symbol|static import only from classes and interfaces'
missing+='|method does not override or implement a method from a supertype'
if grep -E ' error: ' "$out/log" | grep -vE "error: ($missing)$"; then exit 1; fi
# Nothing missed would mean that nothing was compiled.
grep -qE ' error: cannot find symbol$' "$out/log" || { cat "$out/log"; exit 1; }
