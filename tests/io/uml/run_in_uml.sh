#!/usr/bin/env bash
# run_in_uml.sh LAUNCH TEST WORK: boots a user-mode Linux on this machine's own files, read-only, with a virtual CAN
# interface vcan0, and runs TEST (a GoogleTest executable) in it. Exit: 0 passed, 1 failed, 77 skipped, with the reason.
#
# WORK is the one folder that the guest may write to. Needs no special rights: the guest is an ordinary process.
set -euo pipefail
launch=$(readlink -f "$1") test=$(readlink -f "$2") work=$3
seconds=${OSTEON_UML_SECONDS:-240}

skip() { echo "skipped: $*"; exit 77; }
for tool in linux.uml candump cansend insmod ip timeout; do
  PATH=$PATH:/usr/sbin:/sbin command -v "$tool" >/dev/null ||
    skip "no $tool here (packages.txt, section test: user-mode-linux, can-utils, kmod, iproute2)"
done
modules=$(linux.uml --version)
modules=/usr/lib/uml/modules/$modules/kernel
[[ -r $modules/net/can/can.ko ]] || skip "user-mode Linux is here, its CAN modules are not: $modules/net/can/can.ko"

mkdir -p "$work"
work=$(readlink -f "$work")
rm -f "$work"/{log,result,boot}
guest=$(mktemp -d) # a short name, because it is part of the guest's command line
trap 'rm -rf "$guest"' EXIT

# The guest's init. Names are quoted here, so that folders may have spaces.
printf -v line 'work=%q test=%q modules=%q' "$work" "$test" "$modules"
cat >"$guest/init" <<GUEST
#!/bin/bash
$line
GUEST
cat >>"$guest/init" <<'GUEST'
export PATH=/usr/bin:/bin:/usr/sbin:/sbin OSTEON_VCAN=vcan0 HOME=/
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t hostfs -o "$work" none "$work"
{
  for module in net/can/can drivers/net/can/dev/can-dev drivers/net/can/vcan net/can/can-raw; do insmod "$modules/$module.ko"; done
  ip link set lo up
  ip link add dev vcan0 type vcan
  ip link set vcan0 up
  rc=0
  cd "$work" && "$test" --gtest_color=no || rc=$?
} >"$work/log" 2>&1 </dev/null
echo "$rc" >"$work/result"
sync
echo o >/proc/sysrq-trigger
sleep 60
GUEST
chmod +x "$guest/init"

# Vector registers of a guest thread are not kept beyond SSE (launch.cpp), so glibc is told not to use them.
no_vectors=glibc.cpu.hwcaps=-AVX512F,-AVX512VL,-AVX512BW,-AVX512CD,-AVX512DQ,-AVX2,-AVX,-FMA,-XSAVE,-XSAVEC
rc=0
TMPDIR=$guest timeout -k 5 "$seconds" "$launch" linux.uml rootfstype=hostfs rootflags=/ ro "init=$guest/init" mem=256M \
  con=null con0=null,fd:1 con1=null quiet "umid=osteon$$" "uml_dir=$guest/uml" "GLIBC_TUNABLES=$no_vectors" \
  >"$work/boot" 2>&1 </dev/null || rc=$?

[[ ! -f $work/log ]] || cat "$work/log"
if [[ ! -f $work/result ]]; then
  echo "the guest ended (exit $rc, 124: after $seconds s) without a result; its kernel said:"
  tail -n 30 "$work/boot"
  exit 1
fi
[[ $(<"$work/result") == 0 ]]
