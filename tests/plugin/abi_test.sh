#!/usr/bin/env bash
# abi_test.sh LIBRARY PLUGIN TESTS: tests that the library serves or refuses programs compiled with other headers, as their
# ABI says, and that all structs have their recorded sizes (struct_sizes.txt).
set -euo pipefail
library=$1 plugin=$2 tests=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export OSTEON_ROOT=$plugin/..
cp "$library" "$work/libosteon.so.0"
compile() { cc -std=c11 -Wall -Werror -I"$1" "$2" "$work/libosteon.so.0" -lm -Wl,-rpath,"$work" -o "$3"; }
abi_of() { sed -n 's/^#define OSTEON_ABI \([0-9]*\)u$/\1/p' "$1"; }
now=$(abi_of "$plugin/include/osteon.h")

echo "== sizes of all structs"
mapfile -t structs < <(sed -n 's/^} \(Osteon[A-Za-z]*\);$/\1/p' "$plugin/include/osteon.h" | sort)
{
  printf '#include <osteon.h>\n#include <stdio.h>\nint main(void) {\n'
  for name in "${structs[@]}"; do printf '  printf("%%s %%zu\\n", "%s", sizeof(%s));\n' "$name" "$name"; done
  printf '  return 0;\n}\n'
} >"$work/sizes.c"
compile "$plugin/include" "$work/sizes.c" "$work/sizes"
"$work/sizes" | diff - "$tests/struct_sizes.txt" || {
  echo "the structs' sizes (<) differ from struct_sizes.txt (>): another size is a new OSTEON_ABI" >&2
  exit 1
}

echo "== programs of earlier headers"
for header in "$tests"/abi_*/osteon.h; do
  abi=$(abi_of "$header")
  compile "$(dirname "$header")" "$plugin/examples/c/ream_cup.c" "$work/earlier"
  if ((abi == now)); then
    "$work/earlier" | tail -1 | grep -E "removed +[1-9][0-9]+"
  elif "$work/earlier" 2>"$work/text"; then
    echo "a program of ABI $abi was not refused by a library of ABI $now" >&2
    exit 1
  else
    grep "ABI $abi" "$work/text" | grep "ABI $now"
  fi
done

# osteon_*_default writes no byte behind the structs of the earliest header, whatever the library's version.
echo "== defaults of ABI 1"
cat >"$work/defaults.c" <<'PROGRAM'
#include <osteon.h>
#include <stdio.h>
#include <string.h>
#define CHECK(TYPE, FILL)                                        \
  do {                                                           \
    struct {                                                     \
      TYPE params;                                               \
      unsigned char behind[256];                                 \
    } each;                                                      \
    memset(&each, 0x5a, sizeof each);                            \
    FILL(&each.params);                                          \
    for (size_t i = 0; i < sizeof each.behind; ++i)              \
      if (each.behind[i] != 0x5a) return printf("%s\n", #FILL), 1; \
  } while (0)
int main(void) {
  CHECK(OsteonBoneParams, osteon_bone_params_default);
  CHECK(OsteonToolParams, osteon_tool_params_default);
  CHECK(OsteonSettings, osteon_settings_default);
  return 0;
}
PROGRAM
compile "$tests/abi_1" "$work/defaults.c" "$work/defaults"
"$work/defaults"

# A program compiled with another ABI number and longer structs is refused before a struct is read.
for other in $((now - 1)) $((now + 1)); do
  echo "== a header of ABI $other"
  mkdir "$work/$other"
  sed -e "s/^#define OSTEON_ABI .*/#define OSTEON_ABI ${other}u/" -e 's/^} \(Osteon[A-Za-z]*\(Params\|Settings\)\);/  double later[4];\n&/' \
    "$plugin/include/osteon.h" >"$work/$other/osteon.h"
  [[ $(grep -c "double later\\[" "$work/$other/osteon.h") -eq 6 ]]
  compile "$work/$other" "$plugin/examples/c/ream_cup.c" "$work/$other/ream_cup"
  code=0
  "$work/$other/ream_cup" 2>"$work/text" || code=$?
  cat "$work/text"
  ((code == 1))
  grep "header of ABI $other" "$work/text" | grep -q "has ABI $now"
done
