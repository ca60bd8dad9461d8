#!/usr/bin/python3
"""Plays the controller of a simulated KR cell with nothing of Osteon's: Modbus TCP and RSI by the standard library alone.

    rsi_controller.py OSTEON CONFIG_FOLDER

Starts `osteon cell kr_16_thin_plate`, asks its PLC for motion as the register map of io/modbus/README.md says (function
codes 3 and 16), waits for the arm's RSI messages, parses them as XML and answers each as KUKA's documentation describes
it: <Sen Type="ImFree"> with <AK> and the message's IPOC. Checks that IPOC rises by 4 (ms) each cycle, that the corrected
axis A1 follows the correction, and that no other axis moves. Skipped (exit 77) if no ports are free, or if this machine
is too busy to answer within 4 ms.
"""

import os
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree as ElementTree

MODE, RUN_PERMITTED, VERSION, POWER_ON = 970, 974, 977, 982  # registers of the PLC
FIRST, COUNT = 970, 14  # the block that is read
HEARTBEAT, REQUEST = 990, 991  # registers that the controller writes
AXES = ("A1", "A2", "A3", "A4", "A5", "A6")
STEP_DEG, CYCLES, STEPS = 0.002, 750, 500  # 1 degree in 2 s; then 1 s of rest
PATIENCE_S = 60  # for the cell to start


class Modbus:
    """Function codes 3 and 16 of Modbus TCP, in one connection."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=2)
        self.transaction = 0

    def ask(self, function, body):
        """Sends a request; returns the answer without its function code."""
        self.transaction = (self.transaction + 1) & 0xFFFF
        self.socket.sendall(struct.pack(">HHHBB", self.transaction, 0, len(body) + 2, 1, function) + body)
        header = self.receive(7)
        transaction, protocol, length, _ = struct.unpack(">HHHB", header)
        answer = self.receive(length - 1)
        if transaction != self.transaction or protocol != 0 or answer[0] != function:
            raise ValueError(f"Modbus: answer {header.hex()} {answer.hex()} to function {function}")
        return answer[1:]

    def receive(self, count):
        data = b""
        while len(data) < count:
            part = self.socket.recv(count - len(data))
            if not part:
                raise ValueError("Modbus: the connection was closed")
            data += part
        return data

    def read(self):
        """The block of registers, as a dictionary from register to value."""
        answer = self.ask(3, struct.pack(">HH", FIRST, COUNT))
        values = struct.unpack(f">{COUNT}H", answer[1:])
        return {FIRST + i: value for i, value in enumerate(values)}

    def write(self, first, values):
        body = struct.pack(">HHB", first, len(values), 2 * len(values))
        self.ask(16, body + struct.pack(f">{len(values)}H", *values))


class Heartbeat(threading.Thread):
    """A thread that requests motion and writes the heartbeat every 30 ms, until it is stopped."""

    def __init__(self, port):
        super().__init__(daemon=True)
        self.port, self.registers, self.stopped, self.error = port, {}, threading.Event(), ""

    def run(self):
        try:
            modbus, beat = Modbus(self.port), 0
            self.registers = modbus.read()
            while not self.stopped.wait(0.03):
                beat = (beat + 1) & 0xFFFF
                # the request is made anew until motion is permitted
                permitted = self.registers[RUN_PERMITTED]
                modbus.write(HEARTBEAT, [beat, 1 if permitted or beat % 20 else 0])
                self.registers = modbus.read()
        except (OSError, ValueError) as error:
            self.error = str(error)


def answer_arm(port, heart):
    """Answers CYCLES messages after the drives have power; returns their IPOCs and measured axes [deg]."""
    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.bind(("127.0.0.1", port))
    listener.settimeout(PATIENCE_S)
    ipocs, axes = [], []
    while len(ipocs) < CYCLES:
        datagram, sender = listener.recvfrom(4096)
        listener.settimeout(5)
        rob = ElementTree.fromstring(datagram)
        if rob.tag != "Rob" or rob.get("Type") != "KUKA":
            raise ValueError(f"RSI: found <{rob.tag} Type={rob.get('Type')}>, expected <Rob Type=KUKA>")
        ipoc = int(rob.findtext("IPOC"))
        correction = STEP_DEG * min(len(ipocs), STEPS)
        corrections = " ".join(f'{axis}="{correction if axis == "A1" else 0.0:.4f}"' for axis in AXES)
        listener.sendto(f'<Sen Type="ImFree"><AK {corrections}/><IPOC>{ipoc}</IPOC></Sen>'.encode(), sender)
        if not heart.registers.get(POWER_ON):
            continue
        ipocs.append(ipoc)
        axes.append([float(rob.find("AIPos").get(axis)) for axis in AXES])
    return ipocs, axes


def check(ipocs, axes):
    """Raises ValueError unless IPOC rose by 4 and only A1 moved; returns the angle that A1 moved [deg]."""
    steps = {b - a for a, b in zip(ipocs, ipocs[1:])}
    if steps != {4}:
        raise ValueError(f"RSI: IPOC rises by {sorted(steps)}, expected 4 each cycle")
    moved = [last - first for first, last in zip(axes[0], axes[-1])]
    if abs(moved[0] - STEP_DEG * STEPS) > 0.01:
        raise ValueError(f"RSI: A1 went {moved[0]:.4f} degrees, corrected by {STEP_DEG * STEPS:.4f}")
    if max(abs(angle) for angle in moved[1:]) > 0.001:
        raise ValueError(f"RSI: axes that were not corrected moved by {moved[1:]} degrees")
    return moved[0]


def free_ports():
    """The first of four consecutive ports that are free now for UDP and TCP; 0 if there are none."""
    for first in range(34000 + os.getpid() % 1000 * 10, 65000, 10):
        try:
            for offset in range(4):
                for kind in (socket.SOCK_DGRAM, socket.SOCK_STREAM):
                    with socket.socket(socket.AF_INET, kind) as probe:
                        probe.bind(("127.0.0.1", first + offset))
            return first
        except OSError:
            continue
    return 0


def main(osteon, config):
    port = free_ports()
    if port == 0:
        print("skipped: no free ports")
        return 77
    take_real_time()
    with tempfile.TemporaryDirectory() as folder, open(os.path.join(folder, "said"), "w+") as cell_log:
        command = [osteon, "--config-root", config, "cell", "kr_16_thin_plate", "--port", str(port)]
        cell = subprocess.Popen(command, cwd=folder, stdout=cell_log, stderr=subprocess.STDOUT)
        try:
            heart = connect(port + 1, cell)
            if heart is None:
                raise ValueError("the cell ended: " + text_of(cell_log))
            moved = check(*answer_arm(port, heart))
            if heart.error:
                raise ValueError(heart.error)
            registers = heart.registers
            if not (registers[RUN_PERMITTED] and registers[POWER_ON] and registers[MODE]):
                raise ValueError(f"PLC: motion without permission: {registers}")
            print(f"RSI: {CYCLES} messages answered, A1 went {moved:.4f} degrees; Modbus: VERSION {registers[VERSION]}")
            heart.stopped.set()
        except TimeoutError:
            if "answers late" not in text_of(cell_log):
                raise
            print("skipped: this machine is too busy to answer within 4 ms, so the arm ended RSI")
            return 77
        finally:
            cell.terminate()
            cell.wait(10)
    return 0


def take_real_time():
    """The arm ends RSI where answers are late: real-time scheduling helps, where it is allowed."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(20))
    except PermissionError:
        pass


def text_of(file):
    file.seek(0)
    return file.read().strip()


def connect(port, cell):
    """A started Heartbeat for the PLC at that port; None if the cell ends before the port is open."""
    give_up = time.monotonic() + PATIENCE_S
    while time.monotonic() < give_up:
        if cell.poll() is not None:
            return None
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1).close()
        except OSError:
            time.sleep(0.1)
            continue
        heart = Heartbeat(port)
        heart.start()
        return heart
    raise ValueError("the PLC's port is not open")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: rsi_controller.py OSTEON CONFIG_FOLDER")
    try:
        sys.exit(main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])))
    except (OSError, ValueError) as error:
        sys.exit(f"rsi_controller.py: {error}")
