"""The HIPERFACE encoder of encoder.py, without its line: takes the bytes of a request, returns those of the reply.

Written from SICK 8010701 "HIPERFACE - Beschreibung / Description" only, with the Python standard library only. Where the
manual is silent it behaves as usual: an error frame is the reply to 50h with one code, D0h if more codes wait; a request
is checked in the order checksum, command, length, argument, field, range, code, write enable, size.
"""

import json
import os
import sys
import time

BLOCK = 16
POSITION_BITS = {0x02: 14, 0x07: 26, 0x22: 15, 0x27: 27, 0x32: 12, 0x37: 24, 0x42: 9, 0x47: 21}

COUNTER_OVERFLOW, CHECKSUM, COMMAND, LENGTH, ARGUMENT = 0x08, 0x0A, 0x0B, 0x0C, 0x0D
PROTECTED, WRONG_CODE, SIZE, RANGE, NO_FIELD = 0x0E, 0x0F, 0x10, 0x11, 0x12


def xor(data):
    total = 0
    for byte in data:
        total ^= byte
    return total


class Refused(Exception):
    """An error: the request is answered with an error frame with this code."""

    def __init__(self, code):
        super().__init__(code)
        self.code = code


class Died(Exception):
    """Power was lost in the middle of a store."""


def need(condition, code):
    if not condition:
        raise Refused(code)


def field_size(status):
    return ((status & 7) + 1) * BLOCK


def settings_valid(byte):
    return byte & 0x07 != 0x07 and byte & 0x30 != 0x10 and byte & 0x08 == 0


class Encoder:
    """The encoder without its line: takes the bytes of a request and returns those of the reply, or None."""

    def __init__(self, options):
        self.options = options
        self.address = options.address
        self.settings = options.settings
        self.codes = [0x55] * 4
        self.counter = options.counter
        self.position = options.position
        self.fields = []  # status bytes; the fields lie in memory one after another
        self.memory = bytearray(b"\xff" * (options.blocks * BLOCK))
        self.queue = list(options.status)
        self.stores = 0
        self.deaf_until = 0.0
        for field in options.fields:
            self.add_field(field)
        if options.state and os.path.exists(options.state):
            self.load(options.state)
        # Argument bytes (None: checked by the command) and the functions of the commands.
        self.commands = {
            0x42: (0, self.read_position), 0x43: (5, self.set_position), 0x44: (1, self.read_analogue),
            0x46: (0, self.read_counter), 0x47: (0, self.increment), 0x49: (1, self.clear_counter),
            0x4A: (4, self.read_data), 0x4B: (None, self.store_data), 0x4C: (1, self.field_status),
            0x4D: (3, self.define_field), 0x4E: (0, self.free_memory), 0x4F: (3, self.change_code),
            0x50: (0, self.read_status), 0x52: (0, self.type_label), 0x53: (0, self.reset),
            0x55: (2, self.set_address), 0x56: (0, self.serial), 0x57: (2, self.configure),
            0x63: (5, self.set_position), 0x67: (1, self.configure_temporarily),
        }

    def answer(self, frame):
        if len(frame) < 3 or frame[0] not in (self.address, 0xFF) or time.monotonic() < self.deaf_until:
            return None
        address, command = self.address, frame[1]
        try:
            need(xor(frame) == 0, CHECKSUM)
            need(command in self.commands, COMMAND)
            length, carry_out = self.commands[command]
            need(length is None or len(frame) - 3 == length, LENGTH)
            data = carry_out(*frame[2:-1])
        except Refused as refused:
            command, data = 0x50, bytes([refused.code])
        if data is None:
            return None
        if command == 0x55 and self.options.reply_from == "new":
            address = self.address
        if command in (0x55, 0x57, 0x67) and self.options.no_repeat:
            data = b""
        reply = bytes([address, command | (0x80 if self.queue else 0)]) + data
        return reply + bytes([xor(reply)])

    # Position, analogue values, counter

    def read_position(self):
        return self.position.to_bytes(4, "big")

    def set_position(self, hh, hl, lh, ll, code0):
        position = int.from_bytes(bytes([hh, hl, lh, ll]), "big")
        need(position < 1 << POSITION_BITS.get(self.options.type, 32), ARGUMENT)
        need(code0 == self.codes[0], WRONG_CODE)
        self.position = position
        return b""

    def read_analogue(self, channel):
        need(channel in self.options.channels, ARGUMENT)
        return bytes([channel]) + self.options.channels[channel].to_bytes(2, "big", signed=True)

    def read_counter(self):
        return self.counter.to_bytes(3, "big")

    def increment(self):
        self.counter = (self.counter + 1) % (1 << 24)
        if self.counter == 0 and len(self.queue) < 4:
            self.queue.append(COUNTER_OVERFLOW)
        return b""

    def clear_counter(self, code0):
        need(code0 == self.codes[0], WRONG_CODE)
        self.counter = 0
        return b""

    # Data fields

    def place(self, number):
        """Returns status and start of a data field within its memory; field FFh is the extended label."""
        if number == 0xFF and self.options.label:
            return 0x88 | (len(self.options.label) // BLOCK - 1), 0, self.options.label
        need(number < len(self.fields), NO_FIELD)
        return self.fields[number], sum(map(field_size, self.fields[:number])), self.memory

    def part(self, number, address, count, code):
        need(1 <= count <= 128, ARGUMENT)
        status, start, memory = self.place(number)
        need(address + count <= field_size(status), RANGE)
        need(status & 0x08 == 0 or code == self.codes[status >> 4 & 3], WRONG_CODE)
        return status, memory, start + address

    def read_data(self, number, address, count, code):
        _, memory, start = self.part(number, address, count, code)
        return bytes([number, address, count]) + bytes(memory[start:start + count])

    def store_data(self, *arguments):
        need(len(arguments) >= 4 and len(arguments) == 4 + arguments[2], LENGTH)
        number, address, count, code = arguments[:4]
        status, memory, start = self.part(number, address, count, code)
        need(status & 0x40, PROTECTED)
        self.stores += 1
        dies = self.stores == self.options.die_in_store
        written = count // 2 if dies else count
        memory[start:start + written] = bytes(arguments[4:4 + written])
        if dies:
            raise Died
        return bytes([number, address, count])

    def field_status(self, number):
        return bytes([number, self.place(number)[0]])

    def define_field(self, number, status, code):
        need(number <= len(self.fields) - (0 if status & 0x80 else 1), NO_FIELD)
        exists = number < len(self.fields)
        guard = self.fields[number] if exists else status
        need(code == self.codes[guard >> 4 & 3], WRONG_CODE)
        last = number >= len(self.fields) - 1
        if not status & 0x80:
            need(last, SIZE)
            self.fields.pop()
        else:
            same = exists and field_size(guard) == field_size(status)
            others = sum(map(field_size, self.fields[:number]))
            need(same or last and others + field_size(status) <= len(self.memory), SIZE)
            self.fields[number:number + 1] = [status]
        return bytes([number, status])

    def free_memory(self):
        used = sum(map(field_size, self.fields))
        return bytes([(len(self.memory) - used) // BLOCK, len(self.fields)])

    def change_code(self, number, old, new):
        need(number < 4, ARGUMENT)
        need(old == self.codes[number], WRONG_CODE)
        self.codes[number] = new
        return bytes([number])

    # Status, labels, line

    def read_status(self):
        return bytes([self.queue.pop(0) if self.queue else 0])

    def type_label(self):
        return bytes([self.settings, self.options.type, self.options.eeprom, self.options.hardware])

    def reset(self):
        self.queue.clear()
        self.deaf_until = time.monotonic() + 0.1
        return None

    def set_address(self, new, code0):
        need(0x40 <= new <= 0x5F, ARGUMENT)
        need(code0 == self.codes[0], WRONG_CODE)
        self.address = new
        return bytes([new])

    def serial(self):
        return (self.options.serial.ljust(9)[:9] + self.options.firmware[:20] + self.options.date).encode("ascii")

    def configure(self, settings, code0):
        need(settings_valid(settings), ARGUMENT)
        need(code0 == self.codes[0], WRONG_CODE)
        self.settings = settings
        return bytes([settings])

    def configure_temporarily(self, settings):
        need(settings_valid(settings), ARGUMENT)
        return bytes([settings])

    # Persistent content

    def add_field(self, field):
        status, content = int(field["status"], 16), bytes.fromhex(field.get("bytes", ""))
        start = sum(map(field_size, self.fields))
        if len(content) > field_size(status) or start + field_size(status) > len(self.memory):
            sys.exit(f"field {len(self.fields)} does not fit")
        self.memory[start:start + len(content)] = content
        self.fields.append(status)

    def kept(self):
        fields, start = [], 0
        for status in self.fields:
            end = start + field_size(status)
            fields.append({"status": f"{status:02X}", "bytes": self.memory[start:end].hex().upper()})
            start = end
        return {"address": f"{self.address:02X}", "settings": f"{self.settings:02X}",
                "codes": [f"{code:02X}" for code in self.codes], "counter": self.counter,
                "position": self.position, "fields": fields, "free": self.memory[start:].hex().upper()}

    def save(self, path):
        with open(path + ".new", "w", encoding="ascii") as file:
            json.dump(self.kept(), file, indent=1)
        os.replace(path + ".new", path)

    def load(self, path):
        with open(path, encoding="ascii") as file:
            kept = json.load(file)
        self.address, self.settings = int(kept["address"], 16), int(kept["settings"], 16)
        self.codes = [int(code, 16) for code in kept["codes"]]
        self.counter, self.position = kept["counter"], kept["position"]
        self.fields = [int(field["status"], 16) for field in kept["fields"]]
        self.memory = bytearray.fromhex("".join(field["bytes"] for field in kept["fields"]) + kept["free"])
