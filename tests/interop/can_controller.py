#!/usr/bin/python3
"""Plays the controller of the CAN devices of `osteon cell demo`: its reamer drive by CiA 301 and 402, its force sensor
by the maker's manual.

    can_controller.py OSTEON CONFIG_FOLDER

CAN frames travel in UDP datagrams (the simulated cell's tunnel, io/can/README.md), since few kernels at hand have CAN.
The drive: boot-up message, NMT, heartbeats, SDO with its abort codes, the state machine up to a turning tool and down
by quick stop, and EMCY 8130 after the controller's heartbeat has stopped. The sensor: its rate, readings, bias and
refusals. Skipped (exit 77) if no port is free.
"""

import os
import select
import socket
import struct
import subprocess
import sys
import tempfile
import time

PATIENCE_S = 60  # for any answer
NODE = 16  # the drive's CANopen node
SENSOR, FIRST, SECOND = 0x064, 0x001, 0x002  # CAN ids: commands to the sensor, first and second frame of its answers
HEADER = struct.Struct(">IBBHII")  # of the tunnel: magic, version, length, CAN id, session, sequence
MAGIC = 0x4F43414E  # "OCAN"


class Tunnel:
    """The controller's end of the cell's tunnel: one frame a datagram."""

    def __init__(self, port):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind(("127.0.0.1", port))
        self.peer, self.sequence, self.session = ("127.0.0.1", port + 1), 0, os.getpid()

    def send(self, can_id, data):
        head = HEADER.pack(MAGIC, 1, len(data), can_id, self.session, self.sequence)
        self.sequence += 1
        self.socket.sendto(head + data, self.peer)

    def receive(self, timeout):
        """The next frame as (CAN id, data); None if there is none within `timeout` seconds."""
        if not select.select([self.socket], [], [], timeout)[0]:
            return None
        datagram = self.socket.recv(64)
        magic, version, length, can_id, _, _ = HEADER.unpack_from(datagram)
        if (magic, version, HEADER.size + length) != (MAGIC, 1, len(datagram)):
            raise ValueError(f"tunnel: found {datagram.hex()}")
        return can_id, datagram[HEADER.size:]


class Controller:
    """The master of a CAN bus: waits for frames, and reads and writes the drive's objects by SDO."""

    def __init__(self, bus):
        self.bus = bus

    def expect(self, what, accepts, patience_s=PATIENCE_S):
        """The next frame (CAN id, data) for which accepts(id, data) is true; other frames are dropped."""
        until, seen = time.monotonic() + patience_s, []
        while time.monotonic() < until:
            frame = self.bus.receive(0.1)
            if frame is None:
                continue
            if accepts(*frame):
                return frame
            seen.append(f"{frame[0]:03X}#{frame[1].hex().upper()}")
        raise ValueError(f"{what}: found none within {patience_s} s, but {', '.join(seen[-5:]) or 'no frame at all'}")

    # --- CiA 301: SDO, expedited
    def answer_of(self, index, sub):
        """The eight bytes with which the drive answers a request for that object."""
        wanted = struct.pack("<HB", index, sub)
        return self.expect(f"SDO answer {index:04X}:{sub}", lambda i, d: i == 0x580 + NODE and d[1:4] == wanted)[1]

    def upload(self, index, sub=0):
        """Value of an object, little-endian, as bytes; or ("abort", code)."""
        self.bus.send(0x600 + NODE, struct.pack("<BHB4x", 0x40, index, sub))
        data = self.answer_of(index, sub)
        if data[0] == 0x80:
            return "abort", struct.unpack_from("<I", data, 4)[0]
        if data[0] & 0xE3 != 0x43:
            raise ValueError(f"SDO answer {index:04X}:{sub}: found command {data[0]:02X}, expected an expedited upload")
        return data[4:8 - (data[0] >> 2 & 3)]

    def download(self, index, sub, form, value):
        """Writes an object, with `form` as in struct. None if the drive accepts it, or ("abort", code)."""
        payload = struct.pack(form, value)
        command = 0x23 | (4 - len(payload)) << 2
        self.bus.send(0x600 + NODE, struct.pack("<BHB", command, index, sub) + payload.ljust(4, b"\0"))
        data = self.answer_of(index, sub)
        if data[0] == 0x80:
            return "abort", struct.unpack_from("<I", data, 4)[0]
        if data[0] != 0x60:
            raise ValueError(f"SDO answer {index:04X}:{sub}: found command {data[0]:02X}, expected 60")
        return None

    def number(self, index, sub=0, form="<i"):
        """An object's value as a number, with `form` as in struct."""
        return struct.unpack(form, self.upload(index, sub))[0]

    def status_becomes(self, mask, value, what):
        """Waits until the statusword (6041h) under `mask` is `value`, and returns the statusword."""
        until = time.monotonic() + PATIENCE_S
        while time.monotonic() < until:
            status = self.number(0x6041, 0, "<H")
            if status & mask == value:
                return status
        raise ValueError(f"{what}: found statusword {status:04X}, expected {value:04X} under {mask:04X}")


def check(equal, found, expected, what):
    """Raises ValueError, which tells found and expected, unless `equal`."""
    if not equal:
        raise ValueError(f"{what}: found {found}, expected {expected}")


def check_drive(controller):
    """Checks the drive by CiA 301 and 402; returns the speed that the tool reached [rpm of the motor]."""
    bus = controller.bus
    bus.send(0x000, bytes([0x82, NODE]))  # NMT: reset communication
    controller.expect("boot-up message", lambda i, d: i == 0x700 + NODE and d == b"\0")
    device = controller.number(0x1000, 0, "<I")
    check(device & 0xFFFF == 402, device & 0xFFFF, 402, "device type 1000h: profile")
    check(controller.number(0x1018, 0, "<B") == 4, controller.number(0x1018, 0, "<B"), 4, "identity 1018h")
    for index, sub, code, what in ((0x5FFF, 0, 0x06020000, "an object that is not there"),
                                   (0x1018, 9, 0x06090011, "a sub-index that is not there")):
        found = controller.upload(index, sub)
        check(found == ("abort", code), found, f"abort {code:08X}", what)
    found = controller.download(0x6041, 0, "<H", 1)
    check(found == ("abort", 0x06010002), found, "abort 06010002", "a write of an object that is read only")
    check(controller.download(0x1017, 0, "<H", 50) is None, "a refusal", "50 ms", "producer heartbeat 1017h")
    bus.send(0x000, bytes([0x01, NODE]))  # NMT: start
    controller.expect("heartbeat of state operational", lambda i, d: i == 0x700 + NODE and d == b"\x05")
    # CiA 402: shutdown, switch on, enable operation
    check(controller.download(0x6060, 0, "<b", 3) is None, "a refusal", "profile velocity", "mode 6060h")
    controller.status_becomes(0x4F, 0x40, "switch on disabled")
    for word, mask, value, what in ((0x06, 0x6F, 0x21, "ready to switch on"), (0x07, 0x6F, 0x23, "switched on"),
                                    (0x0F, 0x6F, 0x27, "operation enabled")):
        check(controller.download(0x6040, 0, "<H", word) is None, "a refusal", what, "controlword 6040h")
        controller.status_becomes(mask, value, what)
    # target reached (bit 10): within 20 rpm for 50 ms
    check(controller.download(0x606D, 0, "<H", 20) is None, "a refusal", 20, "velocity window 606Dh")
    check(controller.download(0x606E, 0, "<H", 50) is None, "a refusal", 50, "velocity window time 606Eh")
    target_rpm = 1000  # of the motor
    check(controller.download(0x60FF, 0, "<i", target_rpm) is None, "a refusal", target_rpm, "target velocity 60FFh")
    status = controller.number(0x6041, 0, "<H")
    check(status & 0x400 == 0, f"{status:04X}", "bit 10 clear", "statusword just after a new target velocity")
    controller.status_becomes(0x46F, 0x427, "operation enabled, target reached")
    speed_rpm = controller.number(0x606C)
    check(abs(speed_rpm - target_rpm) <= 20, speed_rpm, target_rpm, "velocity 606Ch [rpm]")
    # option 6: braked along the quick-stop ramp, then held there until the voltage is disabled
    check(controller.download(0x605A, 0, "<h", 6) is None, "a refusal", 6, "quick stop option 605Ah")
    check(controller.download(0x6040, 0, "<H", 0x02) is None, "a refusal", "quick stop", "controlword 6040h")
    controller.status_becomes(0x46F, 0x407, "quick stop active, finished")
    rest_rpm = controller.number(0x606C)
    check(abs(rest_rpm) <= 5, rest_rpm, "at rest", "velocity 606Ch [rpm] after a quick stop")
    check(controller.download(0x6040, 0, "<H", 0x00) is None, "a refusal", "disable voltage", "controlword 6040h")
    controller.status_becomes(0x4F, 0x40, "switch on disabled")
    # option 2: braked as well, then switch on disabled; options that the drive does not have are refused
    check(controller.download(0x605A, 0, "<h", 2) is None, "a refusal", 2, "quick stop option 605Ah")
    for option in (4, -1):
        found = controller.download(0x605A, 0, "<h", option)
        check(found == ("abort", 0x06090030), found, "abort 06090030", f"quick stop option {option}")
    for word in (0x06, 0x07, 0x0F, 0x02):
        check(controller.download(0x6040, 0, "<H", word) is None, "a refusal", f"{word:02X}", "controlword 6040h")
    controller.status_becomes(0x4F, 0x40, "switch on disabled after quick stop option 2")
    # after a single heartbeat of the controller (node 7Fh) the drive must send EMCY 8130, heartbeat error
    watched = controller.download(0x1016, 1, "<I", 0x7F << 16 | 200)
    check(watched is None, watched, "200 ms", "consumer heartbeat 1016h")
    bus.send(0x77F, b"\x05")
    _, emergency = controller.expect("EMCY", lambda i, d: i == 0x080 + NODE and len(d) == 8)
    code = struct.unpack_from("<H", emergency)[0]
    check(code == 0x8130, f"{code:04X}", "8130", "EMCY of a controller whose heartbeat stays away")
    check(controller.download(0x1016, 1, "<I", 0) is None, "a refusal", "off", "consumer heartbeat 1016h")
    bus.send(0x000, bytes([0x82, NODE]))
    return speed_rpm


def check_sensor(controller):
    """Checks the force sensor; returns the measured force [N], the rate found and the rate set [Hz]."""
    bus = controller.bus

    def command(*code):
        bus.send(SENSOR, bytes(code).ljust(8, b"\0"))

    def answer(code, what):
        """The 16 bytes of an answer: its two frames joined."""
        first = controller.expect(what, lambda i, d: i == FIRST and d[0] == code)[1]
        return first + controller.expect(what, lambda i, d: i == SECOND)[1]

    command(0x0C)  # stop
    time.sleep(0.2)
    while bus.receive(0.05):  # drop frames that were on their way
        pass
    rate_code, hz = 3, 50  # the sensor's code 3 stands for 50 Hz
    command(0x0F, rate_code)
    found = answer(0x0F, "answer to a new rate")
    check(found[2] == 0, found[2], "no error", "a new rate")
    command(0x10)
    found = answer(0x10, "the rate")
    check(found[1] == rate_code, found[1], rate_code, "the rate, read back")
    command(0x0F, 99)
    found = answer(0x0F, "answer to a rate that is not there")
    check(found[2] != 0, found[2], "an error", "a rate that is not there")
    command(0x0B)  # start
    readings, begin = [], time.monotonic()
    while len(readings) < 50:
        data = answer(0x0B, "a reading")
        readings.append(struct.unpack_from(">6h", data, 1))
        check(data[13] & 0x3F == 0, data[13], "no overload", "a reading")
    taken_hz = (len(readings) - 1) / (time.monotonic() - begin)
    force_N = [value / 50 for value in readings[-1][:3]]  # 50 counts per newton
    size_N = sum(value * value for value in force_N) ** 0.5
    # reamer with its holder below the sensor: some newtons
    check(2 < size_N < 100, f"{size_N:.2f} N", "the weight of a tool", "force")
    command(0x11, 1)  # the present load is zero from now on
    until = time.monotonic() + PATIENCE_S
    while True:
        counts = struct.unpack_from(">6h", answer(0x0B, "a reading"), 1)
        if max(abs(value) for value in counts[:3]) <= 10:
            break
        check(time.monotonic() < until, counts, "zero within 0.2 N", "readings after bias")
    command(0x11, 0)
    command(0x0C)
    time.sleep(0.5)
    while bus.receive(0.05):
        pass
    late = bus.receive(0.5)
    check(late is None or late[0] not in (FIRST, SECOND), late, "silence", "a sensor that was stopped")
    return size_N, taken_hz, hz


def free_ports():
    """The first of four consecutive ports that are free now for UDP and TCP; 0 if there are none."""
    for first in range(35000 + os.getpid() % 1000 * 10, 65000, 10):
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
    tunnel = Tunnel(port + 2)  # the cell's ports: FRI, PLC, then two for each CAN bus
    with tempfile.TemporaryDirectory() as folder, open(os.path.join(folder, "said"), "w+") as cell_log:
        command = [osteon, "--config-root", config, "cell", "demo", "--port", str(port), "--console", "off"]
        cell = subprocess.Popen(command, cwd=folder, stdout=cell_log, stderr=subprocess.STDOUT)
        try:
            controller = Controller(tunnel)
            until = time.monotonic() + PATIENCE_S
            while True:  # ask for the device type (1000h) until the drive answers
                check(cell.poll() is None, "the cell ended", "a cell", "osteon cell")
                check(time.monotonic() < until, "no answer", "an answer", "the drive")
                tunnel.send(0x600 + NODE, struct.pack("<BHB4x", 0x40, 0x1000, 0))
                if (tunnel.receive(0.5) or (0, b""))[0] == 0x580 + NODE:
                    break
            speed_rpm = check_drive(controller)
            size_N, taken_hz, hz = check_sensor(controller)
            print(f"CAN: the drive turned at {speed_rpm} rpm and stopped, EMCY 8130 without a heartbeat; "
                  f"the sensor read {size_N:.1f} N at {taken_hz:.0f} Hz (set: {hz})")
        except ValueError:
            cell_log.seek(0)
            print(cell_log.read()[-2000:], file=sys.stderr)
            raise
        finally:
            cell.terminate()
            cell.wait(20)
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: can_controller.py OSTEON CONFIG_FOLDER")
    try:
        sys.exit(main(os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])))
    except (OSError, ValueError) as error:
        sys.exit(f"can_controller.py: {error}")
