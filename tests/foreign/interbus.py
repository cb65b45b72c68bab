"""A K3 encoder: the effect of an OUT word, and the resulting IN word.

Written from the project's reference of POSITAL's manual UME-IB (protocol/interbus.md) only, with the Python standard
library only. Where the manual is silent: a store is spent whenever a value was written, an encoder that ends a read-out
continues as before, and an undefined word has no effect.
"""

import copy
import json
import time

RUNNING, SETTING, READING = "running", "setting", "reading"
WRONG_DATA, UNKNOWN_CODE, LOST, BEYOND = 0x82000000, 0x84000000, 0x86000000, 0x98000004
INVALID, BUSY, VALUE, UNKNOWN_VALUE = 0x80000000, 0xC0000000, 0xA0000000, 0xA4000000
DATA = 0x01FFFFFF


def add_options(add):
    """Settings and faults of an encoder."""
    def number(text):
        return int(text, 0)

    def word(text):
        return int(text, 16)

    def error(text):
        step, reply = text.split(":")
        return int(step), word(reply)

    add("--serial-number", type=number, default=4000)
    add("--steps", type=number, default=8192)
    add("--turns", type=number, default=1)
    add("--direction", choices=["cw", "ccw"], default="cw")
    add("--preset", type=number, default=0)
    add("--zero-shift", type=number, default=0)
    add("--mode", type=number, default=1, help="of read-out 9: 1 position, 2 speed, 3 to 10 cam programs")
    add("--programs", type=json.loads, default={}, help='{"1": {"mask": 8, "cams": {"3": [15, 213]}}}')
    add("--shift", type=number, default=0)
    add("--position", type=number, default=1000, help="steps of the disc, 8192 in a turn")
    add("--rpm", type=float, default=0.0)
    add("--temperature", type=number, default=253, help="tenths of a degree Celsius")
    add("--narrow", action="store_true", help="temperatures have their sign in 16 bits")
    add("--flags", type=number, default=2)
    add("--complement", choices=["code", "bit"], default="code", help="what read-out 3 gives")
    add("--operating-time", type=number, default=1000, help="tens of minutes")
    add("--software-version", type=number, default=204)
    add("--busy", type=number, default=0, help="milliseconds of C0 words")
    add("--busy-with", choices=["nothing", "sent", "old"], default="nothing", help="the data beside them")
    add("--takes-late", action="store_true", help="what another word replaces while it is processed is not taken")
    add("--old-echo", type=error, help="MS:WORD, an echo that stands for so long after each word that sets")
    add("--stale", type=number, default=0, help="how often the old IN word is read after a new OUT word")
    add("--early", action="store_true", help="the echo is there once before the busy words")
    add("--manufacturer", action="store_true", help="echoes have bit 29 set")
    add("--straight", action="store_true", help="a selected program gives its outputs at once, without an echo")
    add("--error", type=error, action="append", default=[], help="STEP:WORD, the answer to the STEPth word that sets")
    add("--deaf-from", type=number, help="from this word that sets on nothing is echoed")
    add("--other-data", action="store_true", help="echoes have other data than were sent")
    add("--no-position", action="store_true", help="after a parameterisation no position comes")
    add("--unstored", action="store_true", help="a parameter is echoed and not taken")
    add("--lost", action="store_true", help="what the EEPROM held is lost")


class K3:
    def __init__(self, options, note):
        self.options, self.note = options, note
        self.began = time.monotonic()
        self.gear = (options.steps, options.turns)
        self.backwards = options.direction == "ccw"
        self.preset, self.armed, self.zero_shift = options.preset, False, options.zero_shift
        self.shift, self.mode, self.lost = options.shift, options.mode, options.lost
        self.programs = {number: {"mask": 0, "cams": [[0, 0] for _ in range(8)]} for number in range(1, 9)}
        for number, told in options.programs.items():
            program = self.programs[int(number)]
            program["mask"] = told.get("mask", 0)
            for cam, edges in told.get("cams", {}).items():
                program["cams"][int(cam)] = list(edges)
        self.offset = 0
        self.state, self.changed, self.out, self.fixed = RUNNING, None, 0, None
        self.old, self.old_left, self.busy_until, self.early = 0, 0, 0.0, False
        self.busy_data, self.stale_until, self.pending = 0, 0.0, None
        self.sets = 0
        self.at = None

    def now(self):
        """Sets the time at which a word arrives, if a gateway passes it on late."""
        return time.monotonic() if self.at is None else self.at

    # Position

    def turned(self):
        place = self.options.position + (self.now() - self.began) * self.options.rpm / 60 * 8192
        return -int(place // 1) if self.backwards else int(place // 1)

    def position(self):
        steps, turns = self.gear
        place = (self.turned() + self.offset) % (8192 * turns)
        return (place * steps // (8192 * turns) + self.zero_shift) % steps

    def fire(self):
        self.note(f"PRESET {self.preset}")
        steps, turns = self.gear
        wanted = (self.preset - self.zero_shift) % steps
        self.offset = -(-wanted * 8192 * turns // steps) - self.turned()

    def program(self):
        return self.programs[self.mode - 2] if 3 <= self.mode <= 10 else None

    def live(self):
        if self.lost:
            return LOST
        position, program = self.position(), self.program()
        if self.mode == 2:
            return round(self.options.rpm) & DATA
        if program is None:
            return position
        outputs = 0
        for number, (start, stop) in enumerate(program["cams"]):
            on = start <= position <= stop if start <= stop else position >= start or position <= stop
            outputs |= (on and program["mask"] >> number & 1) << number
        return (position << 8 >> self.shift) & 0x01FFFF00 | outputs

    # Words

    def shown(self):
        if self.old_left:
            return self.old
        if self.early:
            return self.fixed
        if self.now() < self.stale_until:
            return self.options.old_echo[1]
        if self.now() < self.busy_until:
            return BUSY | self.busy_data
        return self.live() if self.fixed is None else self.fixed

    def read(self):
        word = self.shown()
        if self.old_left:
            self.old_left -= 1
        else:
            self.early = False
        return word

    def write(self, word):
        if word == self.out:
            return
        edge = word >> 31 and not self.out >> 31
        self.old, self.old_left = self.shown(), self.options.stale
        if self.pending and self.now() < self.busy_until:
            self.note("NOT TAKEN")
            self.programs, self.shift, self.gear, self.backwards, self.preset, self.zero_shift = self.pending
        self.busy_data = {"nothing": 0, "sent": word & DATA, "old": self.out & DATA}[self.options.busy_with]
        self.pending = None
        if self.options.takes_late:
            self.pending = copy.deepcopy(
                (self.programs, self.shift, self.gear, self.backwards, self.preset, self.zero_shift))
        self.out, self.early, self.busy_until, self.stale_until = word, False, 0.0, 0.0
        program = self.program()
        if word == 0:
            if self.state == READING:
                self.state, self.fixed = (SETTING, INVALID) if self.changed else (RUNNING, None)
        elif word == 0x80000000:
            if edge:
                self.store()
                self.state, self.fixed = RUNNING, INVALID if self.options.no_position else None
        elif word >> 16 == 0x2080 and self.state != SETTING or word >> 16 == 0x2080 and program:
            self.select(word & 0xFFFF)
        elif word >> 16 == 0x2021 and (program or self.state != SETTING):
            self.state, self.fixed = READING, self.value(word & 0xFFFF)
        elif program is not None:
            self.set_cams(word, program)
        elif word in (0x40000000, 0x60000000) and self.state == RUNNING and self.mode == 1:
            if word == 0x60000000 or self.armed:
                self.fire()
                self.armed = self.armed and word == 0x60000000
        elif word in (0x20400000, 0x20400001) and self.state == RUNNING:
            self.mode = 1 + (word & 1)
        elif word >> 29 == 0 and word >> 25:
            taken = UNKNOWN_CODE if self.state == READING or self.mode == 2 else self.parameter(word >> 25, word & DATA)
            self.echo(word, taken, "parameters")

    def echo(self, word, error, what):
        """Returns the IN word after a value was set, or refused."""
        self.sets += 1
        error = dict(self.options.error).get(self.sets, error)
        self.state = SETTING
        if self.options.deaf_from is not None and self.sets >= self.options.deaf_from:
            self.fixed = None
            return
        if not error:
            self.changed = what
        echo = word | BUSY | (self.options.manufacturer << 29)
        self.fixed = error or (echo ^ 1 if self.options.other_data else echo)
        self.early = self.options.early
        self.stale_until = self.now() + (self.options.old_echo[0] / 1000 if self.options.old_echo else 0)
        self.busy_until = max(self.now(), self.stale_until) + self.options.busy / 1000

    def store(self):
        if self.changed:
            self.note(f"STORE {self.changed}")
            self.lost = False
        self.changed = None

    def select(self, number):
        if number > 8:
            return
        self.store()
        self.mode = number + 2 if number else 1
        self.state, self.fixed = RUNNING, None
        if number and not self.options.straight:
            self.state, self.fixed = SETTING, 0xE0800000 | number

    def parameter(self, code, data):
        """Returns the error word, or None."""
        steps, turns = self.gear
        gear = {1: (data + (self.options.flags & 1), turns), 2: (steps, data)}.get(code)
        if gear is not None:
            fits = 1 <= gear[1] <= 4096 and 1 <= gear[0] <= min(8192 * gear[1], DATA)
        else:
            fits = {3: data in (3, 4), 4: data < steps, 5: True, 7: data == 0}.get(code)
        if not fits:
            return UNKNOWN_CODE if fits is None else WRONG_DATA
        if self.options.unstored:
            return None
        if gear is not None:
            self.gear = gear
        elif code == 3:
            self.backwards = data == 4
        elif code == 4:
            self.preset, self.armed = data, True
        elif code == 5:
            self.zero_shift = data
        else:
            self.gear, self.backwards, self.preset, self.armed, self.zero_shift = (DATA, 4096), False, 0, False, 0
        return None

    def set_cams(self, word, program):
        number, data, what = word >> 25 & 0xF, word & DATA, f"program {self.mode - 2}"
        if word >> 29 in (2, 3):
            error = UNKNOWN_CODE if number > 7 else BEYOND if data >= self.gear[0] else None
            if not error:
                program["cams"][number][word >> 29 == 3] = data
            self.echo(word, error, what)
        elif word >> 16 == 0x2040:
            error = WRONG_DATA if word & 0xFF00 else None
            program["mask"] = program["mask"] if error else word & 0xFF
            self.echo(word, error, what)
        elif word >> 16 == 0x2010:
            error = WRONG_DATA if word & 0xFFFF > 25 else None
            self.shift = self.shift if error else word & 0xFFFF
            self.echo(word, error, what)
        elif word >> 16 == 0x2020:
            asked, cam = word >> 4 & 0xFFF, word & 0xF
            value = UNKNOWN_VALUE
            if word & 0xFFFF == 0:
                value = VALUE | program["mask"]
            elif word & 0xFFFF == 0x40:
                value = VALUE | self.shift
            elif asked in (1, 2) and cam < 8:
                value = VALUE | program["cams"][cam][asked - 1]
            self.state, self.fixed = READING, value
        elif word >> 29 == 0 and word >> 25:
            self.echo(word, UNKNOWN_CODE, what)

    def value(self, number):
        direction = 4 if self.backwards else 3
        values = {0: self.options.serial_number, 1: self.gear[0] - (self.options.flags & 1), 2: self.gear[1],
                  3: direction - 3 if self.options.complement == "bit" else direction, 4: self.preset,
                  5: self.zero_shift, 6: int(self.armed), 7: self.options.software_version,
                  8: self.options.operating_time, 9: self.mode, 0xA: self.options.flags,
                  0xC: self.options.temperature & (0xFFFF if self.options.narrow else DATA)}
        if number & 0xFF0F == 0xD:
            return VALUE | 0x10 + (number >> 4)
        return VALUE | values[number] if number in values else UNKNOWN_VALUE
