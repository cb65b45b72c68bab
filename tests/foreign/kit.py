"""The kit encoder of ubicom_encoder.py and bridge_adapter.py, without its lines: registers, banks, device modes, the
procedures.

Written from the project's references of the manual "IXARC kit encoders with BiSS C" (protocol/biss.md, ubicom.md) only,
with the Python standard library only. Where the manual is silent: an invalid write is refused, undocumented registers
read 00 and cannot be written, a mode is entered from operation only.
"""

import json
import time

PASSWORD = 0x2A
OPERATION, CALIBRATION, WIEGAND, DATA, FILTER, PRESET = 0, 1, 2, 4, 5, 7
BANK = 64
MOTOR, OEM = range(0x04, 0x24), range(0x24, 0x44)


def add_options(add):
    """Settings of an encoder."""
    def number(text):
        return int(text, 0)

    add("--log", help="file to append every register access to: W 0x24:0x10 AA, R 0x66, P for the position")
    add("--serial-number", type=number, default=0x00BC614E)
    add("--firmware", default="1.6.0")
    add("--device-id", type=bytes.fromhex, default=bytes.fromhex("010168110001"))
    add("--temperature", type=number, default=30, help="degrees Celsius")
    add("--errors", type=number, default=0)
    add("--warnings", type=number, default=0)
    add("--filter", type=number, default=3)
    add("--position", type=number, default=0x1234 << 17 | 0x18000)
    add("--rpm", type=float, default=0.0, help="above 0 clockwise: the position rises")
    add("--reverse", action="store_true", help="the motor turns round when a procedure waits for the other direction")
    add("--rests", type=float, default=0.0, help="seconds from the first access on in which the motor stands still")
    add("--stops", action="store_true", help="the motor stops when a Wiegand test is complete")
    add("--data", type=json.loads, default={}, help='content of the data areas: {"0x24:0x10": "AABB"}')
    add("--preset", type=bytes.fromhex, default=bytes(6), help="stored preset value, its six registers")
    add("--calibration", type=float, default=0.5, help="seconds of a run, in which the encoder is silent")
    add("--calibration-fails", type=number, help="status with which the second run ends")
    add("--revolutions", type=float, default=3.0, help="of the Wiegand test, each way")
    add("--left-in", type=number, default=0, help="device mode in which another host has left it, with the password set")
    add("--stranger", action="store_true", help="an encoder of nobody known, without a data sheet")
    add("--silent-after", type=number, help="accesses after which nothing is answered")


class Kit:
    def __init__(self, options):
        self.options = options
        self.began = time.monotonic()
        self.rpm, self.offset = 0.0 if options.rests else options.rpm, options.position
        self.rests_until = None if options.rests else 0.0
        self.ready = 0.0
        self.memory = {bank: bytearray(BANK) for bank in [*MOTOR, *OEM]}
        for place, content in options.data.items():
            bank, offset = (int(part, 0) for part in place.split(":"))
            content = bytes.fromhex(content)
            self.memory[bank][offset:offset + len(content)] = content
        self.eds = {2: sheet_common(), 3: sheet_encoder()}
        self.preset, self.filter = bytearray(options.preset), options.filter
        self.saved_pulses = bytes(4)
        self.accesses = 0
        self.start()
        self.mode, self.protection = options.left_in, PASSWORD if options.left_in else 0

    def start(self):
        self.bank = self.mode = self.protection = 0
        self.leave()

    def leave(self):
        """Discards unsaved changes."""
        self.command = {"calibration": 0, "wiegand": 0, "data": 0, "filter": 0, "preset": 0}
        self.run = None  # (end, status after it, seconds-free check)
        self.status = {"calibration": 0, "wiegand": 0, "filter": 0, "preset": 0}
        self.pulses, self.code = bytearray(4), 0
        self.open, self.shadow = None, None
        self.entered = bytearray(self.preset)

    def restart(self):
        self.ready = time.monotonic() + 0.5
        self.start()

    # Position

    def steps(self):
        turned = (time.monotonic() - self.began) * self.rpm / 60 * (1 << 17)
        return int(self.offset + turned) % (1 << 33)

    def turn(self, rpm):
        self.offset, self.began, self.rpm = self.steps(), time.monotonic(), rpm

    def position(self):
        """Returns multiturn, singleturn, error, warning; None while the encoder starts."""
        self.note("P")
        if not self.answers(registers=False):
            return None
        steps = self.steps()
        return steps >> 17, steps & 0x1FFFF, bool(self.options.errors), bool(self.options.warnings)

    def answers(self, registers=True):
        self.settle()
        silent = self.options.silent_after is not None and self.accesses > self.options.silent_after
        calibrates = self.run is not None and self.mode == CALIBRATION
        return not silent and time.monotonic() >= self.ready and not (registers and calibrates)

    def settle(self):
        if self.rests_until is None:
            self.rests_until = time.monotonic() + self.options.rests
        if self.rests_until and time.monotonic() > self.rests_until:
            self.rests_until = 0.0
            self.turn(self.options.rpm)
        if self.run is None or time.monotonic() < self.run[0]:
            return
        _, what, status = self.run
        self.run = None
        self.status[what] = status
        if what == "wiegand":
            at = 0 if status == 3 else 2
            self.pulses[at:at + 2] = bytes([63, 58])
        if (what, status) in (("calibration", 0x02), ("wiegand", 0x03)) and self.options.reverse:
            self.turn(-self.rpm)
        if status == 0x06 and self.options.stops:
            self.turn(0.0)

    # Registers: place is (bank or None, address)

    def note(self, line):
        self.accesses += 1
        if self.options.log:
            with open(self.options.log, "a", encoding="ascii") as log:
                log.write(line + "\n")

    def read(self, place):
        """Returns the value; None without an answer."""
        self.note(f"R {name(place)}")
        if not self.answers():
            return None
        bank, address = place
        if bank is None:
            return self.direct(address)
        if bank == 0:
            return self.special(address)
        if bank == 1:
            return {0: self.command["preset"], 1: self.status["preset"]}.get(
                address, self.entered[address - 2] if 2 <= address <= 7 else 0)
        if bank in self.eds:
            return self.eds[bank][address]
        if bank in self.memory:
            source = self.shadow if self.open and bank in self.open else self.memory
            return source[bank][address]
        return None

    def direct(self, address):
        firmware = [int(part) for part in self.options.firmware.split(".")]
        fixed = {0x40: self.bank, 0x41: 2, 0x42: 0x61, 0x43: 0x29, 0x66: self.options.temperature + 50,
                 0x68: self.options.errors, 0x69: self.options.warnings, 0x6A: self.mode, 0x6B: self.protection,
                 0x6E: self.filter, 0x7E: 0x46, 0x7F: 0x72}
        if self.options.stranger and (address in (0x42, 0x43) or 0x78 <= address <= 0x7F):
            return 0x58
        if 0x44 <= address <= 0x47:
            return self.options.serial_number.to_bytes(4, "big")[address - 0x44]
        if 0x74 <= address <= 0x76:
            return firmware[address - 0x74]
        if 0x78 <= address <= 0x7D:
            return self.options.device_id[address - 0x78]
        return fixed.get(address, 0)

    def special(self, address):
        production = bytes([64, 60, 64, 59])
        if 0x09 <= address <= 0x0C:
            return self.pulses[address - 0x09]
        if 0x0D <= address <= 0x10:
            return production[address - 0x0D]
        if 0x11 <= address <= 0x14:
            return self.saved_pulses[address - 0x11]
        return {0x00: self.command["calibration"], 0x01: self.status["calibration"], 0x06: self.command["wiegand"],
                0x07: self.status["wiegand"], 0x08: self.code, 0x1A: self.command["data"],
                0x1B: 1 if self.open else 0, 0x24: self.command["filter"],
                0x25: self.status["filter"]}.get(address, 0)

    def write(self, place, value):
        """Returns True: accepted, False: refused, None: no answer."""
        self.note(f"W {name(place)} {value:02X}")
        if not self.answers():
            return None
        bank, address = place
        if bank is None:
            return self.write_direct(address, value)
        special = {(0, 0x00): (CALIBRATION, self.calibrate), (0, 0x06): (WIEGAND, self.wiegand),
                   (0, 0x1A): (DATA, self.data), (0, 0x24): (FILTER, self.choose), (1, 0x00): (PRESET, self.edit)}
        if place in special:
            mode, carry_out = special[place]
            return self.mode == mode and carry_out(value)
        if bank == 1 and 2 <= address <= 7 and self.status["preset"] == 1:
            self.entered[address - 2] = value
            return True
        if self.open and bank in self.open:
            self.shadow[bank][address] = value
            return True
        return False

    def write_direct(self, address, value):
        if address == 0x40:
            self.bank = value
        elif address == 0x6B:
            self.protection = value
        elif address == 0x6A and value == OPERATION:
            self.mode = OPERATION
            self.leave()
        elif address == 0x6A and value in (1, 2, 4, 5, 7) and self.protection == PASSWORD and self.mode in (0, value):
            self.mode = value
        else:
            return False
        return True

    # Procedures

    def calibrate(self, value):
        if value not in (1, 2) or self.run or (value == 2 and self.status["calibration"] != 0x02):
            return False
        clockwise = value == 2
        status = 0x22 if clockwise else 0x02
        if not 25 <= self.options.temperature <= 40:
            status = 0x31
        elif not 300 <= abs(self.rpm) <= 700:
            status = 0x32
        elif (self.rpm > 0) != clockwise:
            status = 0x30
        elif clockwise and self.options.calibration_fails:
            status = self.options.calibration_fails
        self.command["calibration"], self.status["calibration"] = value, 0x01
        self.run = (time.monotonic() + self.options.calibration, "calibration", status)
        return True

    def wiegand(self, value):
        status = self.status["wiegand"]
        if value == 3:
            self.run, self.status["wiegand"] = None, 0x00
        elif value == 5 and status == 0x06:
            self.saved_pulses = bytes(self.pulses)
        elif (value == 1 and status in (0x00, 0x03, 0x06)) or (value == 2 and status == 0x03):
            self.status["wiegand"] = 0x01 if value == 1 else 0x04
            seconds = self.options.revolutions / max(abs(self.rpm), 1e-3) * 60
            self.run = (time.monotonic() + seconds, "wiegand", 0x03 if value == 1 else 0x06)
        else:
            return False
        self.command["wiegand"] = value
        return True

    def data(self, value):
        if value in (1, 2) and not self.open:
            self.open = MOTOR if value == 1 else OEM
            self.shadow = {bank: bytearray(self.memory[bank]) for bank in self.open}
        elif value in (3, 4) and self.open:
            if value == 3:
                self.memory.update(self.shadow)
            self.open = self.shadow = None
        else:
            return False
        self.command["data"] = value
        return True

    def choose(self, value):
        status = self.status["filter"]
        if value == 1 and status == 0:
            self.status["filter"] = 2
        elif value in (3, 4) and status in (1, 2):
            self.status["filter"], self.chosen = 1, value
        elif value == 2 and status == 1:
            self.filter = self.chosen
            self.restart()
            return True
        else:
            return False
        self.command["filter"] = value
        return True

    def edit(self, value):
        if value == 2:
            self.status["preset"], self.command["preset"] = 1, 2
            return True
        if value == 3 and self.status["preset"] == 1:
            if self.entered[2] > 1 or self.entered[5] > 0:
                return False
            self.preset = bytearray(self.entered)
        elif value in (1, 4, 5):
            steps = self.steps()
            multiturn, singleturn = steps >> 17, steps & 0x1FFFF
            if value in (1, 4):
                singleturn = int.from_bytes(self.preset[0:3], "little")
            if value in (1, 5):
                multiturn = int.from_bytes(self.preset[3:6], "little")
            self.offset, self.began = multiturn << 17 | singleturn, time.monotonic()
        else:
            return False
        self.restart()
        return True


def sheet_common():
    """Returns bank 2 with factory settings, with its checksum."""
    sheet = bytearray(BANK)
    for offset, value in {0x00: 0x01, 0x01: 0x02, 0x02: 0x04, 0x03: 0x43, 0x05: 0x1C, 0x06: 0x30, 0x0C: 0x20,
                          0x0E: 0x01, 0x0F: 0xF4, 0x10: 0x01, 0x11: 0x01, 0x14: 0x03, 0x15: 0x23, 0x17: 0x21}.items():
        sheet[offset] = value
    sheet[0x3F] = sum(sheet[:0x3F]) % 256
    return sheet


def sheet_encoder():
    """Returns bank 3 with factory settings, with its checksum."""
    sheet = bytearray(BANK)
    for offset, content in {0x00: "0101", 0x02: "6129", 0x04: "0102", 0x06: "FF", 0x0A: "10", 0x0C: "11",
                            0x1C: "00000021", 0x2C: "2EE0", 0x30: "00E9", 0x32: "017A", 0x34: "1388", 0x36: "2EE0",
                            0x38: "0046"}.items():
        content = bytes.fromhex(content)
        sheet[offset:offset + len(content)] = content
    sheet[0x3F] = sum(sheet[:0x3F]) % 256
    return sheet


def name(place):
    bank, address = place
    return f"0x{address:02X}" if bank is None else f"0x{bank:02X}:0x{address:02X}"
