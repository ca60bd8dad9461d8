#!/usr/bin/env bash
# modbus_tools.sh OSTEON CONFIG_FOLDER
# Reads and writes the simulated PLC of `osteon cell thin_plate` with mbpoll and pymodbus, by the register map of
# io/modbus/README.md. Checks the block 970 … 983 and its VERSION, that the PLC's own heartbeat counts, that a written
# heartbeat is read back, that motion is permitted after a request (pymodbus only), and the exception for register 2000,
# which does not exist. Exit 77 (skipped): neither tool is installed.
set -euo pipefail
osteon=$(realpath "$1") config=$(realpath "$2")
work=$(mktemp -d)
cell=''
cleanup() {
  if [[ -n $cell ]]; then
    kill -INT "$cell" 2>/dev/null || true
    wait "$cell" 2>/dev/null || true
  fi
  rm -rf "$work"
}
trap cleanup EXIT
fail() {
  echo "modbus_tools.sh: $1" >&2
  tail -5 "$work/cell.log" >&2 || true
  exit 1
}

python=/usr/bin/python3 # Debian's, which has Debian's packages
tools=()
if command -v mbpoll >/dev/null; then tools+=(mbpoll); fi
if "$python" -c 'import pymodbus.client' 2>/dev/null; then tools+=(pymodbus); fi
[[ ${#tools[@]} -gt 0 ]] || { echo "skipped: neither mbpoll nor python3-pymodbus is here (packages.txt, section optional)"; exit 77; }

# whether a TCP port answers on this machine
is_open() { (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; }
for ((first = 36000 + $$ % 1000 * 10; first < 65000; first += 10)); do
  is_open "$((first + 1))" || break
done
port=$((first + 1)) # of the PLC; the arm has the first
cd "$work"
"$osteon" --config-root "$config" cell thin_plate --port "$first" --console off >cell.log 2>&1 &
cell=$!
for ((i = 0; i < 600; ++i)); do
  if is_open "$port"; then break; fi
  kill -0 "$cell" 2>/dev/null || fail "the cell ended"
  sleep 0.1
done

# one function for each tool, called by its name at the end
with_mbpoll() {
  local ask=(mbpoll -m tcp -p "$port" -0 -t 4 -1 -q)
  # prints the value of one register
  register() { "${ask[@]}" -r "$1" 127.0.0.1 | sed -nE "s/^\[$1\]:[[:space:]]*([0-9]+).*/\1/p"; }
  "${ask[@]}" -r 970 -c 14 127.0.0.1 >block
  [[ $(grep -c '^\[9[78][0-9]\]:' block) -eq 14 ]] || fail "mbpoll: found $(cat block), expected 14 registers"
  [[ $(register 977) -eq 3 ]] || fail "mbpoll: VERSION: found $(register 977), expected 3"
  local beat later
  beat=$(register 983)
  sleep 0.3
  later=$(register 983)
  [[ $beat != "$later" ]] || fail "mbpoll: PLC_HEARTBEAT stands at $beat"
  "${ask[@]}" -r 990 127.0.0.1 4711 >/dev/null
  [[ $(register 990) -eq 4711 ]] || fail "mbpoll: CONTROLLER_HEARTBEAT: found $(register 990), expected 4711"
  if "${ask[@]}" -r 2000 127.0.0.1 >refused 2>&1; then fail "mbpoll: register 2000 was read"; fi
  grep -qi "illegal data address" refused || fail "mbpoll: register 2000: found $(cat refused)"
  echo "mbpoll: VERSION 3, heartbeats, and an exception for register 2000"
}

with_pymodbus() {
  "$python" - "$port" <<'PYTHON'
import sys
import time

from pymodbus.client import ModbusTcpClient

with ModbusTcpClient("127.0.0.1", port=int(sys.argv[1]), timeout=2) as plc:
    def read():
        answer = plc.read_holding_registers(970, 14, slave=1)
        assert not answer.isError(), answer
        return dict(enumerate(answer.registers, 970))

    assert read()[977] == 3, f"VERSION: found {read()[977]}, expected 3"
    until, beat, permitted = time.monotonic() + 30, 0, False
    while time.monotonic() < until and not permitted:
        beat += 1
        # the request is made anew until motion is permitted
        answer = plc.write_registers(990, [beat, 1 if beat % 20 else 0], slave=1)
        assert not answer.isError(), answer
        time.sleep(0.03)
        permitted = read()[974] == 1
    assert permitted, "RUN_PERMITTED stays 0"
    assert plc.read_holding_registers(990, 1, slave=1).registers == [beat]
    time.sleep(0.5)  # longer than the PLC waits for a heartbeat
    assert read()[974] == 0, "RUN_PERMITTED stays 1 without the controller's heartbeat"
    refused = plc.read_holding_registers(2000, 1, slave=1)
    assert refused.isError() and refused.exception_code == 2, f"register 2000: found {refused}"
print("pymodbus: motion permitted while the heartbeat beats, withdrawn without it, and an exception for register 2000")
PYTHON
}

for tool in "${tools[@]}"; do "with_$tool" || fail "$tool"; done
