#!/usr/bin/env bash
# build.sh FOLDER WORK: bundles the console's page into FOLDER, with npm's libraries in WORK. Does nothing if FOLDER was
# made from the same sources. Needs npm, and a network to install its libraries. Called by ./osteon and by packaging.
set -euo pipefail

web=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")
mkdir -p "$1" "$2"
page=$(readlink -f "$1") work=$(readlink -f "$2")
sources=$(cd "$web" && find . -type f -print0 | sort -z | xargs -0 sha256sum | sha256sum | cut -d' ' -f1)
[[ $(cat "$page/.sources" 2>/dev/null) != "$sources" ]] || exit 0

# the libraries are installed again only if package-lock.json has changed
cp -r "$web/." "$work"
cd "$work"
if [[ ! -d node_modules || $(cat node_modules/.lock 2>/dev/null) != $(sha256sum <package-lock.json) ]]; then
  npm ci --ignore-scripts --no-audit --no-fund --no-update-notifier --prefer-offline --fetch-retries=1 --fetch-timeout=60000
  sha256sum <package-lock.json >node_modules/.lock
fi
npm run --silent build
cp index.html compare.html dist/main.js dist/main.css dist/compare.js dist/compare.css "$page"
cp node_modules/three/LICENSE "$page/LICENSE.three"
cp node_modules/uplot/LICENSE "$page/LICENSE.uplot"
echo "$sources" >"$page/.sources"
