#!/usr/bin/env bash
# expect_output.sh EXIT_CODE REGEX COMMAND …: passes where the command ends with that code and prints what the regex finds
# (POSIX extended; a dot is a line's end, too). ctest's PASS_REGULAR_EXPRESSION looks at no exit code: a command that
# prints the right words and crashes would pass.
set -u
if [[ $# -lt 3 ]]; then echo "expect_output.sh: found $# arguments, accepted EXIT_CODE REGEX COMMAND …" >&2; exit 2; fi
code=$1 regex=$2
shift 2
output=$("$@" 2>&1)
found=$?
printf '%s\n' "$output"
if [[ $found -ne $code ]]; then echo "exit code $found, expected $code"; exit 1; fi
if [[ ! $output =~ $regex ]]; then echo "the output has no match of: $regex"; exit 1; fi
