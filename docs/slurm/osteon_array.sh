#!/usr/bin/env bash
# osteon_array.sh SHARDS FOLDER RESULT.json COMMAND …: runs a study as a Slurm job array with one task a shard, and then a
# job that merges the parts. FOLDER, which all nodes see, gets the parts and the tasks' output.
#
#     docs/slurm/osteon_array.sh 32 parts sweep.json regress --sweep trembling_hand
#
# OSTEON names the command (default: ./osteon), SBATCH_OPTIONS what every job needs besides, as --partition=long.
set -euo pipefail
if [[ $# -lt 4 ]]; then
  echo "osteon_array.sh: found $# arguments, accepted SHARDS FOLDER RESULT.json COMMAND …" >&2
  exit 2
fi
shards=$1 folder=$2 result=$3
shift 3
osteon=${OSTEON:-./osteon}
read -ra options <<<"${SBATCH_OPTIONS:-}"
mkdir -p "$folder"

array=$(sbatch --parsable "${options[@]}" --job-name=osteon --array="1-$shards" --output="$folder/part_%a.log" \
  --wrap="$(printf '%q ' "$osteon" "$@")--shard \$SLURM_ARRAY_TASK_ID/$shards --json $(printf '%q' "$folder")/part_\$SLURM_ARRAY_TASK_ID.json")
# afterany, not afterok: a shard with a failed item ends with 1, but has written its part, which is merged as well
merge=$(sbatch --parsable "${options[@]}" --job-name=osteon-merge --dependency="afterany:$array" \
  --output="$folder/merge.log" \
  --wrap="$(printf '%q ' "$osteon") merge $(printf '%q' "$folder")/part_*.json --json $(printf '%q' "$result")")
echo "array $array, then merge $merge: $result; output in $folder/"
