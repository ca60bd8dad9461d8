#!/usr/bin/python3
"""Reads a recording as the MCAP specification describes it, independently of io/recording, and has protoc decode it.

    mcap_reader.py RECORDING.mcap

Checks that the file is complete up to its footer, that the number of messages equals its statistics, that every chunk has
the size it claims, and that protoc decodes the first and the last message of every channel by the schema inside the file.
If the Python package mcap is installed, its reader must find the same messages. Skipped (exit 77) without protoc or zstd.
"""

import shutil
import struct
import subprocess
import sys
import tempfile
from collections import Counter

MAGIC = b"\x89MCAP0\r\n"
# opcodes of the records that are read
FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, STATISTICS = 0x02, 0x03, 0x04, 0x05, 0x06, 0x0B


class Bytes:
    """Takes little-endian fields from the front of a record."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        if self.at + count > len(self.data):
            raise ValueError("a record ends in a field")
        self.at += count
        return self.data[self.at - count:self.at]

    def number(self, form):
        """The next number, with `form` as in struct: H 16, I 32, Q 64 bits."""
        return struct.unpack("<" + form, self.take(struct.calcsize("<" + form)))[0]

    def text(self):
        """The next string: its length in 32 bits, then UTF-8."""
        return self.take(self.number("I")).decode()


def records(data):
    """The records of a file or chunk, each as (opcode, content)."""
    at = 0
    while at < len(data):
        opcode, length = struct.unpack_from("<BQ", data, at)
        at += 9
        if at + length > len(data):
            raise ValueError("a record is longer than the file")
        yield opcode, data[at:at + length]
        at += length


def uncompressed(chunk):
    """The records inside a chunk, as bytes."""
    fields = Bytes(chunk)
    fields.take(16)  # times of the first and the last message
    size = fields.number("Q")
    fields.take(4)  # checksum
    compression = fields.text()
    packed = fields.take(fields.number("Q"))
    if compression == "zstd":
        packed = subprocess.run(["zstd", "-d", "-c", "-q"], input=packed, capture_output=True, check=True).stdout
    elif compression:
        raise ValueError(f"compression {compression} is not known here")
    if len(packed) != size:
        raise ValueError(f"a chunk has {len(packed)} bytes, says {size}")
    return packed


class Recording:
    """Schemas and channels by number; for each channel the number of messages, and its first and last message."""

    def __init__(self, data):
        if not (data.startswith(MAGIC) and data.endswith(MAGIC)):
            raise ValueError("no MCAP, or without its end")
        self.schemas, self.channels, self.messages = {}, {}, {}
        self.counts, self.statistics, self.footer = Counter(), None, False
        self.read(data[len(MAGIC):-len(MAGIC)])

    def read(self, data):
        """Takes over the records of the file, and of a chunk by calling itself."""
        for opcode, record in records(data):
            fields = Bytes(record)
            if opcode == CHUNK:
                self.read(uncompressed(record))
            elif opcode == SCHEMA:
                number, name, encoding = fields.number("H"), fields.text(), fields.text()
                self.schemas[number] = (name, encoding, fields.take(fields.number("I")))
            elif opcode == CHANNEL:
                number, schema = fields.number("H"), fields.number("H")
                self.channels[number] = (schema, fields.text())
            elif opcode == MESSAGE:
                number = fields.number("H")
                fields.take(4)  # sequence
                stamp = fields.number("Q")
                fields.take(8)  # time of publication
                self.counts[number] += 1
                kept = self.messages.setdefault(number, [])  # at most the first and the last message
                kept[1:] = [(stamp, fields.data[fields.at:])]
            elif opcode == STATISTICS:
                self.statistics = fields.number("Q")
            elif opcode == FOOTER:
                self.footer = True


def decode(schema, message):
    """The message as text, by protoc with the schema of the file."""
    name, _, descriptor = schema
    with tempfile.NamedTemporaryFile(suffix=".desc") as file:
        file.write(descriptor)
        file.flush()
        return subprocess.run(["protoc", f"--decode={name}", f"--descriptor_set_in={file.name}"], input=message,
                              capture_output=True, check=True).stdout.decode()


def compare_with_package(path, recording):
    """The same messages by the Python package mcap, where it is installed."""
    try:
        from mcap.reader import make_reader
    except ImportError:
        return "the package mcap is not installed: its reader was not tried"
    with open(path, "rb") as file:
        counts = Counter(channel.id for _, channel, _ in make_reader(file).iter_messages())
    if counts != recording.counts:
        raise ValueError(f"the package mcap finds {counts}, this reader {recording.counts}")
    return "the package mcap finds the same messages"


def main(path):
    for program in ("protoc", "zstd"):
        if not shutil.which(program):
            print(f"skipped: no {program}")
            return 77
    with open(path, "rb") as file:
        recording = Recording(file.read())
    total = sum(recording.counts.values())
    if not recording.footer or recording.statistics != total or total == 0:
        raise ValueError(f"{total} messages, statistics say {recording.statistics}, footer: {recording.footer}")
    for number, (schema, topic) in sorted(recording.channels.items()):
        name, encoding, _ = recording.schemas[schema]
        if encoding != "protobuf":
            raise ValueError(f"{topic}: encoding {encoding}, expected protobuf")
        for stamp, message in recording.messages.get(number, []):
            text = decode(recording.schemas[schema], message)
            # protoc prints a field that the schema does not have by its number
            if not text or any(line.strip()[:1].isdigit() for line in text.splitlines()):
                raise ValueError(f"{topic}: a field of {name} at {stamp} is not in its schema")
        print(f"{topic:<24} {name:<28} {recording.counts[number]} messages")
    print(compare_with_package(path, recording))
    return 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: mcap_reader.py RECORDING.mcap")
    sys.exit(main(sys.argv[1]))
