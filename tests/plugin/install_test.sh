#!/usr/bin/env bash
# install_test.sh CMAKE BUILD TESTS PLUGIN: installs the library in a folder of its own, and uses it from there as other
# projects do: by find_package, by pkg-config, and from Python. Exit code 77: numpy is not installed.
set -euo pipefail
cmake=$1 build=$2 tests=$3 plugin=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
for component in library development; do
  "$cmake" --install "$build" --prefix "$prefix" --component "$component" >"$work/log"
done
mkdir -p "$prefix/share/osteon"
cp -r "$plugin/../config" "$prefix/share/osteon/config" # the component that installs it needs all programs built
unset OSTEON_ROOT

echo "== find_package"
if ! { "$cmake" -S "$tests/consumer" -B "$work/consumer" -DCMAKE_PREFIX_PATH="$prefix" -DEXAMPLES="$plugin/examples" &&
  "$cmake" --build "$work/consumer"; } >"$work/log" 2>&1; then
  cat "$work/log"
  exit 1
fi
"$work/consumer/ream_cup" | tail -1 | grep -E "force +[1-9][0-9.]+ N"
"$work/consumer/ream_cup_eigen" | tail -1 | grep -E "force +[1-9][0-9.]+ N  removed +[1-9][0-9]"

echo "== find_package: an installed version serves requests of its own major version that are not newer than itself"
accepts() { # VERSION REQUEST: whether an installed VERSION serves find_package(osteon REQUEST)
  sed -E "s/\"[0-9]+\.[0-9]+\.[0-9]+\"/\"$1\"/g" "$version_file" >"$work/version.cmake"
  cat >"$work/ask.cmake" <<EOF
set(PACKAGE_FIND_VERSION $2)
string(REGEX MATCH "^[0-9]+" PACKAGE_FIND_VERSION_MAJOR $2)
include($work/version.cmake)
if(NOT PACKAGE_VERSION_COMPATIBLE)
  message(FATAL_ERROR "refused")
endif()
EOF
  "$cmake" -P "$work/ask.cmake" >"$work/log" 2>&1
}
version_file=$(find "$prefix" -name osteon-config-version.cmake)
accepts 1.7.2 1.0 || { echo "an installed 1.7.2 does not serve find_package(osteon 1.0)"; exit 1; }
! accepts 1.0.0 1.7 || { echo "an installed 1.0.0 serves find_package(osteon 1.7)"; exit 1; }
! accepts 2.0.0 1.0 || { echo "an installed 2.0.0 serves find_package(osteon 1.0)"; exit 1; }

echo "== pkg-config"
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name osteon.pc)")
export PKG_CONFIG_PATH
# shellcheck disable=SC2046  # not quoted: the output is several flags
cc -std=c11 -Wall -Werror "$plugin/examples/c/ream_cup.c" $(pkg-config --cflags --libs osteon) -lm \
  -Wl,-rpath,"$(pkg-config --variable=libdir osteon)" -o "$work/ream_cup"
"$work/ream_cup" "$work/bone.ply" | tail -1 | grep triangles
[[ $(pkg-config --modversion osteon) == "$(sed -n 's/^CMAKE_PROJECT_VERSION:[^=]*=//p' "$build/CMakeCache.txt")" ]]

echo "== Python"
python=/usr/bin/python3
"$python" -c 'import numpy' 2>/dev/null || { echo "python3-numpy is not installed"; exit 77; }
PYTHONPATH=$prefix/lib/python3/dist-packages "$python" "$plugin/examples/python/four_reamers.py" "$work/bone.stl" | tee "$work/reamers"
[[ $(grep -cE "mm: up to +[1-9]" "$work/reamers") -eq 4 ]]
PYTHONPATH=$prefix/lib/python3/dist-packages "$python" "$tests/python_test.py"
PYTHONPATH=$prefix/lib/python3/dist-packages "$python" "$tests/notebook_test.py" "$plugin/examples/python/ream_cup.ipynb"
