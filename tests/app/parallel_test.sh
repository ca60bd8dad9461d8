#!/usr/bin/env bash
# parallel_test.sh OSTEON SOURCES: a sweep in shards by GNU parallel, as docs/sharding.md has it, merged and compared with
# one run. Exit code 77, with the reason: there is no GNU parallel here.
set -euo pipefail
osteon=$(realpath "$1") sources=$(realpath "$2")
export OSTEON_ROOT=$sources
if ! parallel --version 2>/dev/null | grep -q '^GNU parallel'; then
  echo "skipped: no GNU parallel (package parallel)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >sweep.yaml <<'YAML'
shows: a trembling hand
scenario: tremor
seed_count: 4
parameters:
  - {key: operator.tremor_N, takes: uniform 0 to 4}
  - {key: operator.tremor_seed, takes: seed}
YAML
"$osteon" regress --sweep sweep.yaml --out out --json one.json
# ":" is this machine; another one is named beside it
parallel --will-cite --sshlogin 2/: "$osteon" regress --sweep sweep.yaml --shard {}/3 --json part_{}.json ::: 1 2 3
"$osteon" merge part_*.json --out merged --json merged.json
cmp one.json merged.json
cmp out/sweep.csv merged/sweep.csv
echo "3 shards by GNU parallel, merged: the bytes of one run"
