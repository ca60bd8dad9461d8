#!/usr/bin/env bash
# slurm_test.sh OSTEON SOURCES: a study as a Slurm job array, on a Slurm of one node that is made for this test: munge,
# controller and node run in a temporary folder, and end with the test. The array's parts, merged, are compared with one
# run. Exit code 77, with the reason: there is no Slurm here, or it cannot be started.
set -euo pipefail
osteon=$(realpath "$1") sources=$(realpath "$2")
export OSTEON_ROOT=$sources
skip() { echo "skipped: $*"; exit 77; }
for program in munged slurmctld slurmd sbatch squeue scontrol; do
  command -v "$program" >/dev/null || skip "no $program (packages slurm-wlm and munge)"
done
[[ $(id -u) -eq 0 ]] || skip "slurmd has to be started by root"

folder=$(mktemp -d)
pids=()
finish() {
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${pids[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$folder"
}
trap finish EXIT
chmod 755 "$folder"
mkdir -p "$folder"/{munge,state,spool,run}
chmod 700 "$folder/munge"
free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'; }
controller_port=$(free_port) node_port=$(free_port)
host=$(hostname -s)

dd if=/dev/urandom of="$folder/munge/key" bs=128 count=1 status=none
chmod 600 "$folder/munge/key"
munged --foreground --force --socket="$folder/run/munge.socket" --key-file="$folder/munge/key" --num-threads=2 \
  --log-file="$folder/munge/log" --pid-file="$folder/munge/pid" --seed-file="$folder/munge/seed" >"$folder/munge/out" 2>&1 &
pids+=($!)

export SLURM_CONF=$folder/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=osteon_test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$controller_port
SlurmdPort=$node_port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$folder/run/munge.socket
CryptoType=crypto/munge
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/run/slurmctld.pid
SlurmdPidFile=$folder/run/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ReturnToService=2
MailProg=/bin/true
MpiDefault=none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=100 State=UNKNOWN
PartitionName=main Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF

for _ in $(seq 50); do [[ -S $folder/run/munge.socket ]] && break; sleep 0.1; done
[[ -S $folder/run/munge.socket ]] || skip "munged does not start: $(cat "$folder/munge/out")"
slurmctld -D >"$folder/slurmctld.out" 2>&1 & pids+=($!)
slurmd -D >"$folder/slurmd.out" 2>&1 & pids+=($!)
ready=no
for _ in $(seq 150); do
  if [[ $(sinfo --noheader --format=%T 2>/dev/null) == idle ]]; then ready=yes; break; fi
  sleep 0.2
done
if [[ $ready == no ]]; then
  tail -n 3 "$folder"/slurm*.log
  skip "Slurm's node does not become idle"
fi

cd "$folder"
study=(regress wall_reamer wall_kr pause)
"$osteon" "${study[@]}" --out out --json one.json
mkdir parts
# 3 shards and the job that merges them, which waits for all
OSTEON="$osteon" "$sources/docs/slurm/osteon_array.sh" 3 parts merged.json "${study[@]}" --out out
for _ in $(seq 600); do
  [[ -z $(squeue --noheader) ]] && break
  sleep 0.2
done
if [[ ! -f merged.json ]]; then
  cat parts/*.log; squeue; tail -n 5 slurm*.log
  echo "no merged.json: the array or the job that merges it did not end well"
  exit 1
fi
python3 - one.json merged.json <<'PY'
import json, sys
times = {"seconds_wall", "seconds_cpu", "seconds_set_up", "times_real_time"}
def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(inner) for key, inner in value.items() if key not in times}
    return [without_times(inner) for inner in value] if isinstance(value, list) else value
one, merged = (without_times(json.load(open(file))) for file in sys.argv[1:])
assert one == merged, "the merged figures are not those of one run"
assert len(one["scenarios"]) == 3
PY
echo "3 shards by a Slurm job array, merged: the figures of one run"
