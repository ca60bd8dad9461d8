#!/usr/bin/env bash
# unity_test.sh LIBRARY PACKAGE TESTS CONFIG: compiles the Unity package with mono, each folder as its asmdef says, against
# stubs of the few Unity types that it uses; runs its EditMode tests and BindingTest.cs. Exit code 77: mono is not installed.
set -euo pipefail
library=$1 package=$2 tests=$3 config=$4
if ! command -v mcs >/dev/null || ! command -v mono >/dev/null; then
  echo "mono-mcs and mono-runtime are not installed"
  exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
compile() { mcs -warnaserror -nowarn:0649,0169 -lib:"$work" "$@"; }
compile -target:library -out:"$work/components.dll" "$package"/Runtime/*.cs "$tests/UnityStubs.cs"
compile -target:library -out:"$work/sample.dll" -r:components.dll "$package"/Samples~/*/*.cs
# stubs and inspectors in one executable, where the tests find both
compile -out:"$work/edit_mode.exe" -r:components.dll "$package"/Editor/*.cs "$package"/Tests/Editor/*.cs "$tests/EditorStubs.cs"
compile -out:"$work/test.exe" "$package"/Runtime/{Native,NativeStructs,Axes,Session,Surface,Plan}.cs "$tests/BindingTest.cs"
for file in "$package"/package.json "$package"/*/*.asmdef "$package"/Tests/*/*.asmdef; do
  python3 -m json.tool "$file" >/dev/null || { echo "not JSON: $file"; exit 1; }
done
cp "$library" "$work/libosteon.so.0"
export LD_LIBRARY_PATH=$work
OSTEON_ROOT=$(dirname "$config") mono "$work/edit_mode.exe"
mono "$work/test.exe" "$config" "$tests/../struct_sizes.txt" "$work"
