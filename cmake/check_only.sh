#!/bin/sh
# check_only.sh COMPILER … -o OBJECT -c SOURCE: runs the compiler, which is told to check only (-fsyntax-only), and
# leaves an empty OBJECT, by which the build knows that the source was checked.
"$@" || exit
while [ "$1" != -o ]; do shift; done
: >"$2"
