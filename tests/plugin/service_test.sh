#!/usr/bin/env bash
# service_test.sh SOURCE: checks that unit, user, group, limits, udev rule, package scripts and docs/set_up.md name the same
# user, group, rights and folders, and that systemd accepts them. Needs no root. Leaves systemd's own checks out if its
# programs are not installed.
set -euo pipefail
packaging=$1/plugin/packaging unit=$1/plugin/packaging/osteon@.service page=$1/docs/set_up.md install=$1/cmake/Install.cmake
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "service_test.sh: $1" >&2
  exit 1
}
has() { grep -qE -- "$2" "$1" || fail "${1#"$packaging/"} lacks: $2"; }
value() { sed -n "s/^$1=//p" "$unit"; } # the value of a key of the unit

echo "== one user, one group"
user=$(value User) group=$(value Group)
has "$packaging/osteon.sysusers" "^u $user "
has "$packaging/60-osteon.rules" "GROUP=\"$group\""
[[ $user == "$group" ]] || fail "found user $user and group $group, accepted one name: sysusers makes both"
[[ $(grep -c '^@' "$packaging/osteon.conf") -eq $(grep -c "^@$group - " "$packaging/osteon.conf") ]] ||
  fail "osteon.conf has rights of another group than $group"
has "$page" "usermod -aG $group "

echo "== one priority"
rtprio=$(sed -n "s/^@$group - rtprio //p" "$packaging/osteon.conf")
[[ $rtprio == "$(value LimitRTPRIO)" ]] || fail "found rtprio $rtprio and LimitRTPRIO=$(value LimitRTPRIO)"
[[ $(grep -oE 'rtprio [0-9]+' "$page" | sort -u) == "rtprio $rtprio" ]] ||
  fail "docs/set_up.md: found $(grep -oE 'rtprio [0-9]+' "$page" | sort -u | tr '\n' ' '), accepted rtprio $rtprio"
has "$1/session/setup/realtime_checks.cpp" "rtprio $rtprio"

echo "== folders"
[[ $(value RuntimeDirectory) == osteon ]] || fail "the unit has no RuntimeDirectory=osteon"
has "$unit" "^Environment=OSTEON_SOCKET_FOLDER=/run/$(value RuntimeDirectory)$"
has "$1/io/local/local_server.h" "\"/run/$(value RuntimeDirectory)\""
[[ $(value RuntimeDirectoryMode) == 0750 ]] || fail "the group cannot enter /run/osteon, or others can"
# a second cell's sockets lie there as well: the first one's end must not take them along
[[ $(value RuntimeDirectoryPreserve) == yes ]] || fail "the end of one cell removes another one's sockets"
# shellcheck disable=SC2016  # systemd's variable
has "$unit" '^ExecStop=-?/usr/bin/osteon stop --pid \$MAINPID$'
for folder in "$(value WorkingDirectory)" /etc/osteon /run/osteon; do has "$page" "$folder"; done

echo "== what is installed where"
has "$install" 'osteon\.sysusers DESTINATION lib/sysusers\.d RENAME osteon\.conf'
conffile=$(<"$packaging/conffiles")
[[ $conffile == /etc/security/limits.d/osteon.conf ]] || fail "conffiles: found $conffile"
for script in postinst prerm postrm conffiles; do has "$install" "packaging}/$script"; done
for script in postinst prerm postrm; do
  [[ -x $packaging/$script ]] || fail "$script is not executable"
  sh -n "$packaging/$script"
done

echo "== postinst, with and without systemd"
mkdir "$work/bin" "$work/sysusers"
for command in groupadd useradd udevadm systemctl; do
  printf '#!/bin/sh\necho "%s $*" >>"%s/calls"\n' "$command" "$work" >"$work/bin/$command"
done
printf '#!/bin/sh\nexit 2\n' >"$work/bin/getent" # no user exists yet
chmod +x "$work/bin"/*
cp "$work/bin/useradd" "$work/sysusers/systemd-sysusers"
sed -i 's/useradd/systemd-sysusers/' "$work/sysusers/systemd-sysusers"
postinst() {
  rm -f "$work/calls"
  touch "$work/calls"
  PATH=$1 /bin/sh "$packaging/postinst" "$2"
}
postinst "$work/bin" configure
grep -q "^groupadd --system $group$" "$work/calls" || fail "without systemd postinst makes no group: $(<"$work/calls")"
grep -qE "^useradd --system --gid $group .*/var/lib/osteon .* $user$" "$work/calls" || fail "postinst makes no user: $(<"$work/calls")"
postinst "$work/sysusers:$work/bin" configure
grep -q '^systemd-sysusers osteon.conf$' "$work/calls" || fail "postinst does not call systemd-sysusers: $(<"$work/calls")"
! grep -q useradd "$work/calls" || fail "postinst makes the user twice"
postinst "$work/bin" abort-upgrade
[[ ! -s $work/calls ]] || fail "postinst acts at abort-upgrade: $(<"$work/calls")"

echo "== as systemd reads them"
if command -v systemd-analyze >/dev/null; then
  sed 's|/usr/bin/osteon |/bin/true |' "$unit" >"$work/osteon@cell.service" # systemd-analyze verify needs a program that exists
  verdict=$(systemd-analyze verify --man=no "$work/osteon@cell.service" 2>&1) || fail "systemd-analyze: $verdict"
  ! grep -F "osteon@" <<<"$verdict" || fail "the unit's lines above"
  # what the service may do, by systemd's own measure from 0 to 10: a service that keeps all privileges has 8.7
  exposure=$(systemd-analyze security --offline=true "$work/osteon@cell.service" 2>&1) || fail "systemd-analyze: $exposure"
  level=$(sed -nE 's/.*exposure level for [^:]*: ([0-9]+)\.([0-9]).*/\1\2/p' <<<"$exposure")
  [[ -n $level && $level -le 50 ]] || fail "found an exposure of ${level:-none} tenths, accepted up to 50"
else
  echo "left out: no systemd-analyze"
fi
if command -v systemd-sysusers >/dev/null; then
  cp "$packaging/osteon.sysusers" "$work/osteon.conf"
  mkdir "$work/root" "$work/root/etc"
  systemd-sysusers --dry-run --root="$work/root" "$work/osteon.conf" 2>&1 | tee "$work/made" | grep "user '$user'" || fail "$(<"$work/made")"
else
  echo "left out: no systemd-sysusers"
fi
