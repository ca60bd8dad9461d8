#!/usr/bin/env bash
# expect_output.sh EXIT_CODE REGEX COMMAND …: passes if the command ends with this exit code and its output matches the
# regular expression (POSIX extended; a dot also matches a line end). ctest's own PASS_REGULAR_EXPRESSION ignores the
# exit code, so a command that prints the right words and then crashes would pass.
set -u
if [[ $# -lt 3 ]]; then echo "expect_output.sh: found $# arguments, accepted EXIT_CODE REGEX COMMAND …" >&2; exit 2; fi
code=$1 regex=$2
shift 2
output=$("$@" 2>&1)
found=$?
printf '%s\n' "$output"
if [[ $found -ne $code ]]; then echo "exit code $found, expected $code"; exit 1; fi
if [[ ! $output =~ $regex ]]; then echo "the output has no match of: $regex"; exit 1; fi
