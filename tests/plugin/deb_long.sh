#!/usr/bin/env bash
# deb_long.sh BUILD [FOLDER]: tests the Debian packages on a bare Debian 12, where nothing else is installed. Makes the
# packages of BUILD (osteon_app, osteon_studies and osteon_plugin must be built), checks them with lintian, installs them
# in a fresh debootstrap below FOLDER (a temporary one), runs the demo to its summary, and purges them. Then the
# service's unit runs there under a systemd (service_long.sh). Needs root, debootstrap, lintian, a mirror of Debian, 2 GB;
# takes two minutes on an idle machine. Exit code 1: something does not hold.
set -euo pipefail
build=$(realpath "$1") folder=${2:-}
readonly kMaxSeconds=60 # from apt's start to the demo's summary
if [[ -z ${OSTEON_DEB_NAMESPACE:-} ]]; then
  [[ $EUID -eq 0 ]] || { echo "deb_long.sh: found user $EUID, accepted root: debootstrap and chroot need it" >&2; exit 2; }
  # a mount namespace for this script, so that all mounts end with it
  OSTEON_DEB_NAMESPACE=1 exec unshare --mount --propagation private bash "$0" "$@"
fi
cleanup() {
  umount -R "$bare/dev" "$bare/proc" 2>/dev/null || true
  if [[ -z ${2:-} ]]; then rm -rf --one-file-system "$folder"; fi
}
[[ -n $folder ]] || folder=$(mktemp -d)
bare=$folder/bare debs=$folder/debs
trap 'cleanup "$@"' EXIT
mkdir -p "$folder"
rm -rf --one-file-system "$bare" "$debs"
mkdir -p "$debs"

echo "== packages"
(cd "$build" && cpack --config CPackConfig.cmake -B "$debs") >"$folder/cpack.log" || { tail -5 "$folder/cpack.log"; exit 1; }
rm -rf "$debs/_CPack_Packages"
ls -sh "$debs"

echo "== lintian"
# no archive has these packages: their changelog closes no bug
lintian --allow-root --fail-on error --suppress-tags initial-upload-closes-no-bugs "$debs"/*.deb

echo "== a bare Debian"
debootstrap --variant=minbase bookworm "$bare" >"$folder/debootstrap.log" || { tail -3 "$folder/debootstrap.log"; exit 1; }
mkdir "$bare/debs"
cp "$debs"/*.deb "$bare/debs/"
# use this machine's mirror of Debian
rm -f "$bare/etc/apt/sources.list"
cp /etc/resolv.conf "$bare/etc/"
cp -r /etc/apt/sources.list* /etc/apt/apt.conf.d "$bare/etc/apt/"
mount -t proc proc "$bare/proc"
mount --rbind /dev "$bare/dev"
inside() { chroot "$bare" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -c "$1"; }
inside 'apt-get update' >"$folder/update.log"
# names of all installed packages, and all paths of the bare system but caches, logs and mounts
packages() { inside "dpkg-query -W -f '\${Package}\n'" | sort; }
files() { find "$bare" -xdev \( -path "$bare/var/cache" -o -path "$bare/var/log" -o -path "$bare/var/lib/apt" -o \
  -path "$bare/var/lib/dpkg" -o -path "$bare/tmp" -o -path "$bare/run" -o -path "$bare/debs" -o -path "$bare/proc" -o -path "$bare/dev" \) -prune -o -print | sort; }
files >"$folder/before"
packages >"$folder/packages_before"

echo "== install, and the demo"
start=$(date +%s)
inside 'apt-get install -y --no-install-recommends /debs/*.deb' >"$folder/install.log" || { tail -5 "$folder/install.log"; exit 1; }
echo "installed after $(($(date +%s) - start)) s"
inside 'mkdir /debs/run && cd /debs/run && osteon demo --seconds 8 --console off' >"$folder/demo.log" || { tail -30 "$folder/demo.log"; exit 1; }
seconds=$(($(date +%s) - start))
grep -E "Verdict|Ended|Engine|Bone removed" "$folder/demo.log"
echo "the demo's summary after $seconds s (at most $kMaxSeconds)"
grep -qE "Bone removed +[1-9][0-9]" "$folder/demo.log"
inside 'osteon --version && ! command -v g++ && ! command -v npm'
inside 'test -s /usr/share/man/man1/osteon.1.gz && zcat /usr/share/man/man1/osteon.1.gz | grep -q "^\.TH"'
inside 'bash -n /usr/share/bash-completion/completions/osteon && grep -q "complete .*osteon" /usr/share/bash-completion/completions/osteon'
inside 'test -s /usr/share/zsh/vendor-completions/_osteon && test -s /usr/share/fish/vendor_completions.d/osteon.fish'

echo "== the service's user, its rights, and what its unit names"
inside 'id osteon && getent passwd osteon | grep -q ":/var/lib/osteon:/usr/sbin/nologin$" && getent group osteon'
inside 'grep -q "^@osteon - rtprio 95$" /etc/security/limits.d/osteon.conf'
inside "dpkg-query -W -f '\${Conffiles}' osteon | grep -q ' /etc/security/limits.d/osteon.conf '"
inside 'test -s "/lib/systemd/system/osteon@.service" && test -s /lib/udev/rules.d/60-osteon.rules'
# the service's user runs the demo in the folders that the unit names; a member of the group asks and stops it
cat >"$bare/debs/service.sh" <<'EOF'
set -e
as() { setpriv --reuid "$1" --regid "$1" --init-groups "${@:2}"; }
install -d -o osteon -g osteon -m 750 /run/osteon /var/lib/osteon /var/cache/osteon
useradd --groups osteon visitor
cd /var/lib/osteon
OSTEON_SOCKET_FOLDER=/run/osteon XDG_CACHE_HOME=/var/cache/osteon as osteon osteon run demo --simulated --console off &
for ((i = 0; i < 60; ++i)); do
  if as visitor osteon status; then break; fi
  sleep 1
done
as visitor osteon stop
wait
userdel visitor
rm -r /run/osteon /var/lib/osteon /var/cache/osteon
EOF
inside 'bash /debs/service.sh' >"$folder/service.log" 2>&1 || { tail -20 "$folder/service.log"; exit 1; }
grep "osteon stop:" "$folder/service.log"

echo "== purge"
inside 'apt-get purge -y osteon libosteon0 libosteon-dev && apt-get autoremove --purge -y' >"$folder/purge.log"
packages | diff "$folder/packages_before" - || { echo "packages are left"; exit 1; }
# only files with osteon in their name count: other packages may leave files
files | comm -13 "$folder/before" - | grep -i osteon && { echo "files are left"; exit 1; }
echo "nothing is left"

echo "== the unit under a systemd"
inside 'apt-get install -y --no-install-recommends systemd dbus iproute2 /debs/*.deb' >"$folder/systemd.log"
umount -R "$bare/dev" "$bare/proc" # systemd mounts these in its own namespaces
bash "$(dirname "$0")/service_long.sh" "$bare"
((seconds <= kMaxSeconds)) || { echo "the demo's summary came too late; load of this machine: $(cut -d' ' -f1-3 /proc/loadavg)"; exit 1; }
