#!/usr/bin/env bash
# parallel_test.sh OSTEON SOURCES: runs a sweep in shards by GNU parallel, as docs/sharding.md shows, merges
# them and compares with one run. Exit code 77: GNU parallel is not installed.
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
# "2/:" means two jobs at a time on this machine; other machines would follow after a comma
parallel --will-cite --sshlogin 2/: "$osteon" regress --sweep sweep.yaml --shard {}/3 --json part_{}.json ::: 1 2 3
"$osteon" merge part_*.json --out merged --json merged.json
cmp one.json merged.json
cmp out/sweep.csv merged/sweep.csv
echo "3 shards by GNU parallel, merged: the bytes of one run"
