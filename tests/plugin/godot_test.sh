#!/usr/bin/env bash
# godot_test.sh CMAKE BUILD TESTS [TIMES]: installs the add-on into a project and drives it by the real engine, without a
# window, TIMES times (1). Each run reams for five seconds, twice in one process. Exit code 77: Godot 3 is not installed.
set -euo pipefail
cmake=$1 build=$2 tests=$3 times=${4:-1}
command -v godot3-server >/dev/null || { echo "godot3-server is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$cmake" --install "$build" --prefix "$work" --component godot >"$work/log"
cp "$tests"/godot/* "$work/"
export HOME=$work LANG=en_US.UTF-8 # without a home folder and a locale that it knows, Godot reports errors
unset LC_ALL XDG_DATA_HOME XDG_CONFIG_HOME XDG_CACHE_HOME
mkdir -p "$work/.local/share/godot/app_userdata/Osteon add-on test" "$work/.config" "$work/.cache"
unset OSTEON_ROOT
for ((run = 1; run <= times; ++run)); do
  code=0
  timeout 280 godot3-server --path "$work" --script test.gd >"$work/out" 2>&1 || code=$?
  grep -E "^(round|failed|all checks)" "$work/out" || true
  # the engine prints a script's error and goes on: look for the text
  if ((code != 0)) || grep -E "SCRIPT ERROR|^ERROR|Leaked|leaked|ObjectDB" "$work/out" || ! grep -q "all checks hold" "$work/out"; then
    echo "run $run of $times: exit code $code"
    cat "$work/out"
    exit 1
  fi
done
