#!/usr/bin/env bash
# service_long.sh ROOT: tests the unit osteon@CELL under a running systemd. ROOT is a Debian's root folder with the packages
# osteon, systemd, dbus and iproute2 installed. systemd boots there as the first process of namespaces of its own, like in a
# container: its network is its own loopback, and the machine's systemd, if there is one, is not touched. A simulated
# cell runs beside the unit. Needs root; takes two minutes. Exit code 1: something does not hold.
set -euo pipefail
root=$(realpath "$1")
[[ $EUID -eq 0 ]] || { echo "service_long.sh: found user $EUID, accepted root: a systemd is booted" >&2; exit 2; }
[[ -x $root/lib/systemd/systemd && -x $root/usr/bin/osteon && -x $root/usr/bin/dbus-daemon && -x $root/bin/ss ]] ||
  { echo "service_long.sh: $root lacks systemd, dbus, iproute2 or osteon" >&2; exit 2; }
readonly kMaxBootSeconds=60
work=$(mktemp -d)
cleanup() {
  # the end of the first process ends all of its namespaces
  [[ -z ${pid:-} ]] || kill -KILL "$pid" 2>/dev/null || true
  [[ -z ${boot:-} ]] || wait "$boot" 2>/dev/null || true
  [[ -z ${group:-} ]] || find "$group" -depth -type d -exec rmdir {} + 2>/dev/null || true
  umount "$work/cgroup" 2>/dev/null || true
  rm -rf --one-file-system "$work"
}
trap cleanup EXIT

cat >"$work/boot.sh" <<'EOF'
set -e
mount --bind "$1" "$1"
mount --make-private "$1"
cd "$1"
mount -t proc proc proc
mount -t sysfs -o ro sysfs sys
mount -t cgroup2 cgroup2 sys/fs/cgroup
mount -t tmpfs tmpfs dev
for device in null zero full random urandom tty; do
  touch dev/$device
  mount --bind /dev/$device dev/$device
done
ln -s /proc/self/fd dev/fd
mkdir dev/pts dev/shm
mount -t tmpfs tmpfs dev/shm
mount -t tmpfs tmpfs run
mount -t tmpfs tmpfs tmp
ip link set lo up
exec chroot . env -i container=namespaces PATH=/usr/sbin:/usr/bin:/sbin:/bin \
  /lib/systemd/systemd --unit=multi-user.target --log-target=null --show-status=no
EOF

# a control group of its own, so that systemd sees only its own processes
mkdir "$work/cgroup"
mount -t cgroup2 cgroup2 "$work/cgroup"
group=$work/cgroup/osteon_service_$$
mkdir "$group"
(
  echo "$BASHPID" >"$group/cgroup.procs"
  exec unshare --cgroup --mount --propagation private --pid --fork --net --ipc --uts --kill-child \
    bash "$work/boot.sh" "$root"
) >"$work/boot.log" 2>&1 &
boot=$!

cat >"$work/service.sh" <<'EOF'
set -euo pipefail
export LC_ALL=C.UTF-8 SYSTEMD_PAGER=cat
unit=osteon@my_cell
begin=$(mktemp) threads=$(mktemp) # in the guest's temporary folder, which ends with the guest
privileges=0+ # pattern of the effective capabilities that the cell's process may have
fail() {
  echo "service_long.sh: $1" >&2
  systemctl --no-pager status "$unit" simulated_cell >&2 || true
  journalctl --no-pager -u "$unit" -n 30 >&2 || true
  exit 1
}
is() { # KEY VALUE: fails unless the unit's KEY has this VALUE
  local found
  found=$(systemctl show -P "$1" "$unit")
  [[ $found == "$2" ]] || fail "$1 of the unit: found $found, accepted $2"
}
until_true() { # WHAT COMMAND...: fails unless COMMAND succeeds within 20 s
  for ((i = 0; i < 100; ++i)); do
    if "${@:2}" >/dev/null 2>&1; then return; fi
    sleep 0.2
  done
  fail "not within 20 s: $1"
}
as_visitor() { setpriv --reuid visitor --regid visitor --init-groups "$@"; }
start_cell() {
  systemd-run --quiet --collect --unit simulated_cell --uid osteon --property LimitRTPRIO=95 \
    --property AmbientCapabilities=CAP_SYS_NICE --working-directory /tmp osteon cell /etc/osteon/my_cell.yaml --seconds 600 --console off
}
renders() { as_visitor osteon status | grep -q "cutting"; }
recordings() { find /var/lib/osteon -name '*.mcap' -newer "$begin" | wc -l; }
listens() { ss -Hlun 'sport = :30200' | grep -q .; }
start() { # the arm's side comes last, as a person starts it: a session that nobody answers is closed after 10 s
  systemctl start "$unit"
  until_true "the cell listens to the arm" listens
  start_cell
  until_true "the cell renders" renders
  is ActiveState active
}

echo "== what systemd says of the unit"
systemd-analyze verify --man=no "$unit.service"
systemd-analyze security "$unit.service" | tail -1
getent passwd visitor >/dev/null || useradd --groups osteon visitor
getent passwd stranger >/dev/null || useradd stranger

echo "== a cell that has no file does not start"
systemctl start osteon@missing
[[ $(systemctl show -P ActiveState osteon@missing) == inactive ]] || fail "a cell without a file is not inactive"
[[ $(systemctl show -P ConditionResult osteon@missing) == no ]] || fail "the condition of a cell without a file holds"

echo "== a cell with an error in its file fails, and says where"
install -d /etc/osteon
# a container's root may not raise limits: there the rights come as capabilities, and the unit's own limits stay untried
if ! (ulimit -Hr 95 && ulimit -Hl unlimited) 2>/dev/null; then
  echo "this machine lets nobody raise a limit: real-time rights come as capabilities, LimitRTPRIO and LimitMEMLOCK are not tried"
  install -d /run/systemd/system/osteon@.service.d
  printf '[Service]\n%s=CAP_SYS_NICE CAP_IPC_LOCK\n' CapabilityBoundingSet >/run/systemd/system/osteon@.service.d/rights.conf
  printf 'AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK\n' >>/run/systemd/system/osteon@.service.d/rights.conf
  systemctl daemon-reload
  privileges=0*804000 # CAP_SYS_NICE and CAP_IPC_LOCK
fi
printf 'extends: demo\nlimits: {max_force_N: 900}\n' >/etc/osteon/wrong.yaml
systemctl start osteon@wrong
until_true "a wrong cell has failed" systemctl is-failed osteon@wrong
journalctl --no-pager -o cat -u osteon@wrong | grep "max_force_N" || fail "the journal does not name the key"

touch "$begin"
echo "== start: its user, its rights, its folders"
(cd /tmp && osteon new-cell my_cell --from demo >/dev/null && install -m 644 my_cell.yaml /etc/osteon/my_cell.yaml)
start
pid=$(systemctl show -P MainPID "$unit")
[[ $(stat -c %U "/proc/$pid") == osteon ]] || fail "the cell runs as $(stat -c %U "/proc/$pid")"
grep -E "^CapEff:\s+$privileges$" "/proc/$pid/status" || fail "the cell has privileges: $(grep CapEff "/proc/$pid/status")"
grep -E "^NoNewPrivs:\s+1$" "/proc/$pid/status" || fail "the cell can gain privileges"
grep -E "^VmLck:\s+[1-9][0-9]{3,} kB" "/proc/$pid/status" || fail "the cell's memory is not locked"
# SCHED_FIFO is policy 1; fields 40 and 41 behind the name in parentheses are priority and policy
for task in /proc/"$pid"/task/*; do
  sed 's/.*) //' "$task/stat" | awk -v name="$(<"$task/comm")" '$39 == 1 {print "real time:", name, "priority", $38}'
done | tee "$threads"
grep -q "real time: .* priority" "$threads" || fail "no thread of the cell has a real-time priority"
[[ $(stat -c '%U:%G %a' /run/osteon) == "osteon:osteon 750" ]] || fail "/run/osteon: $(stat -c '%U:%G %a' /run/osteon)"

echo "== a member of the group asks, a stranger cannot"
as_visitor osteon status
if setpriv --reuid stranger --regid stranger --init-groups osteon status; then fail "a stranger got an answer"; fi
as_visitor osteon pause
until_true "the cell pauses" bash -c 'osteon status | grep -qi pause'
as_visitor osteon resume
until_true "the cell renders again" renders

echo "== stop: in order, with a recording that has its end"
systemctl stop "$unit"
is ActiveState inactive
is Result success
[[ $(recordings) -eq 1 ]] || fail "found $(recordings) recordings after the first run, accepted 1"
osteon replay "$(find /var/lib/osteon -name '*.mcap' -newer "$begin")" | tail -3

echo "== killed: it failed, and never starts again by itself"
systemctl stop simulated_cell
start
systemctl kill --signal KILL --kill-who main "$unit"
until_true "a killed cell has failed" systemctl is-failed "$unit"
sleep 3
is ActiveState failed
is Result signal
is NRestarts 0

echo "== the arm goes: a fault ends it, and it stays at rest"
systemctl stop simulated_cell
systemctl reset-failed "$unit"
start
systemctl kill --signal KILL simulated_cell
until_true "a cell without an arm has failed" systemctl is-failed "$unit"
is Result exit-code
is ExecMainStatus 1
is NRestarts 0
journalctl --no-pager -o cat -u "$unit" | grep -i "fault" | tail -1 || fail "the journal does not name the fault"
[[ $(recordings) -eq 3 ]] || fail "found $(recordings) recordings after three runs, accepted 3: none is ever replaced"

echo "== it is not enabled"
[[ $(systemctl is-enabled "$unit") == static ]] || fail "the unit can be enabled: found $(systemctl is-enabled "$unit")"
userdel visitor
userdel stranger
echo "the unit does as docs/set_up.md says"
EOF

inside() { nsenter --target "$pid" --mount --pid --net --ipc --uts --cgroup --root --wd env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"; }
for ((i = 0; i < kMaxBootSeconds; ++i)); do
  pid=$(pgrep -P "$boot" || true)
  if [[ -n $pid ]] && inside systemctl is-system-running 2>/dev/null | grep -qE "running|degraded"; then break; fi
  sleep 1
done
[[ -n $pid ]] || { echo "service_long.sh: systemd did not boot:"; tail -5 "$work/boot.log"; exit 1; }
inside bash -s <"$work/service.sh"
