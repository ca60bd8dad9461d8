#!/usr/bin/env bash
# Shows that each check of tree_check.sh finds a violation in a made-up tree and names the place.
set -euo pipefail
here=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

# expect EXIT PATTERN CHECK: compares tree_check's exit code and output on the made-up tree.
expect() {
  local rc=0 output
  output=$("$here/tree_check.sh" "$3" "$tree" "$tree/build" 2>&1) || rc=$?
  if [[ $rc -eq 77 ]]; then echo "$3: $output"; return; fi
  if [[ $rc -ne $1 ]] || ! grep -qE -- "$2" <<<"$output"; then
    printf '%s: expected exit %s and /%s/, found exit %s:\n%s\n' "$3" "$1" "$2" "$rc" "$output"
    failures=1
  fi
}

cp "$here/../../.clang-format" "$tree/"
mkdir "$tree/control"
printf 'int a;\n' >"$tree/control/good.cpp"
# shellcheck disable=SC2016  # the script's own text
printf '#!/bin/sh\necho "$1"\n' >"$tree/good"
expect 0 '' format
expect 0 '' shell
expect 0 '' paths

printf 'int    a ;\n' >"$tree/control/ill_formed.cpp"
expect 1 'control/ill_formed\.cpp:1:' format

# shellcheck disable=SC2016
printf '#!/usr/bin/env bash\nrm -r $1/*\n' >"$tree/unquoted"
expect 1 'In unquoted line 2' shell

printf 'fine\nopen("/%s/someone/mesh.obj")\n' tmp >"$tree/control/reader.txt"
expect 1 'control/reader\.txt:2:' paths

# A header that needs another one before it, and a header that no library lists, in a tree like ours. compiled COUNT says
# how many files of headers the next check compiles; the others have passed already.
list() { printf 'control/%s\n' "$@" >"$tree/build/listed_headers.txt"; }
compiled() { compiles="in [0-9]+ files, $1 compiled"; }
mkdir "$tree/build"
list law.h
echo 'inline int Law() { return 1; }' >"$tree/control/law.h"
compiled 1
expect 0 "$compiles" headers
compiled 0
expect 0 "$compiles" headers
echo 'inline std::vector<int> Law() { return {}; }' >"$tree/control/law.h"
expect 1 'law\.h:1:.*std' headers
expect 1 'law\.h:1:.*std' headers # what has failed is compiled again
# A template that the header's own functions use is checked with its arguments, although no code is written.
printf '#include <memory>\nstruct Arm;\ninline void Law() { std::unique_ptr<Arm> arm; }\n' >"$tree/control/law.h"
expect 1 'law\.h:3:' headers
echo 'inline int Law() { return 1; }' >"$tree/control/law.h"
expect 0 '' headers
echo 'inline int Gain() { return 1; }' >"$tree/control/gain.h"
expect 1 'control/gain\.h:1: in neither HEADERS' headers
list law.h gain.h
expect 0 '' headers
echo 'inline std::vector<int> Gain() { return {}; }' >"$tree/control/gain.h"
expect 1 'gain\.h:1:.*std' headers
# What another header includes does not help; a header compiled behind one that it includes is fine.
printf '#pragma once\n#include <vector>\n' >"$tree/control/law.h"
expect 1 'gain\.h:1:.*std' headers
printf '#include "control/law.h"\ninline std::vector<int> Gain() { return {}; }\n' >"$tree/control/gain.h"
compiled 1
expect 0 "2 headers $compiles" headers
# A change of a header is noticed in all that include it.
printf '#pragma once\ninline std::vector<int> Law() { return {}; }\n' >"$tree/control/law.h"
expect 1 'law\.h:2:.*std' headers
printf '#pragma once\n#include <span>\n' >"$tree/control/law.h"
expect 1 'gain\.h:2:.*vector' headers
# A header that finds a set of headers parsed still lacks what it does not include.
printf '#pragma once\n#include <string>\ninline std::vector<std::string> Law() { return {}; }\n' >"$tree/control/law.h"
expect 1 'law\.h:3:.*vector' headers
printf '#pragma once\ninline int Law() { return 1; }\n#include <vector>\n' >"$tree/control/law.h"
expect 1 'control/law\.h:3: an #include behind code' headers

exit "$failures"
