#!/usr/bin/env bash
# unity_test.sh LIBRARY PACKAGE TESTS CONFIG: compiles the Unity package with mono, its components against stubs of the
# few Unity types that they use, and drives its binding. 77: no mono here.
set -euo pipefail
library=$1 package=$2 tests=$3 config=$4
if ! command -v mcs >/dev/null || ! command -v mono >/dev/null; then
  echo "mono-mcs and mono-runtime are not installed"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mcs -warnaserror -target:library -out:"$work/components.dll" "$package"/Runtime/*.cs "$package"/Samples~/*/*.cs \
  "$tests/UnityStubs.cs" -nowarn:0649,0169
mcs -warnaserror -out:"$work/test.exe" "$package"/Runtime/{Native,Axes,Session}.cs "$tests/BindingTest.cs"
cp "$library" "$work/libosteon.so.0"
LD_LIBRARY_PATH=$work mono "$work/test.exe" "$config"
