#!/usr/bin/env bash
# page_test.sh OSTEON CONSOLE PICTURES STEPS: runs page_test.mjs, which tests the console's page in Debian's Chromium. CONSOLE
# is the folder of the built page. Skips (exit status 77) where a part is missing.
set -euo pipefail
for part in node chromium; do
  command -v "$part" >/dev/null || { echo "skipped: no $part here (packages.txt, sections console and optional)"; exit 77; }
done
[[ -s $2/web/index.html && -d $2/npm/node_modules/puppeteer-core ]] ||
  { echo "skipped: the console's page is not built: console/web/build.sh $2/web $2/npm"; exit 77; }
exec node "$(dirname "$0")/page_test.mjs" "$1" "$2/npm/node_modules" "$3" "$4"
