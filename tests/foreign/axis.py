"""A drive's axis that accelerates, turns and brakes: its states, its status word and its position, without I/O and
without a clock. Written from the project's reference (protocol/hiperdrive.md, sections 2 to 5) only, with the standard
library only.

Whether a control word commands motion is decided here, from the reference only: see `Axis.commands`.
"""

import math

ON, ENABLE, NO_STOP, NO_PAUSE, START, ACKNOWLEDGE = 0x0001, 0x0008, 0x0010, 0x0020, 0x0040, 0x0080
JOG_STEPS, CONTROL, SPEED_MODE = 0x0300, 0x0400, 0x1000
PRESENT = 0x0A30
FAULT, LOCK, WARNING, REACHED, ACKNOWLEDGED, STANDING, OUTSIDE = 0x0008, 0x0040, 0x0080, 0x0400, 0x1000, 0x2000, 0x8000
LOWER, UPPER, TARGET_INVALID, TIMEOUT = 0x8304, 0x8305, 0x8503, 0x8601
# Revolutions per minute at 100 %, and the seconds to reach them from standstill.
RPM, RAMP = 35.0, 0.25
# A drive that has moved this number of 65536ths of a turn against the commanded direction has turned the wrong way; this
# far past its target, it has passed it.
AWRY = 64


class Axis:
    def __init__(self, position=0):
        self.position, self.velocity = float(position), 0.0
        self.lower, self.upper, self.turn = -511 * 65536, 511 * 65536, 65536.0
        self.word, self.percent = 0, 0
        self.is_fault = self.is_locked = self.is_reached = self.is_acknowledged = False
        self.code = 0
        # A run: +1 or -1, and whether it ends at the limits. A job: its target, and whether it waits.
        self.run, self.is_endless = 0, False
        self.job, self.is_paused, self.was_job = None, False, False
        self.is_standing = True
        self.is_reversed = self.is_unlimited = self.is_overrunning = self.is_pauseless = False
        self.began = float(position)

    def level(self):
        """0 not ready, 1 ready, 2 operational, 3 enabled."""
        if self.is_fault or self.is_locked or not self.word & CONTROL:
            return 0
        if not self.word & ON:
            return 1
        return 3 if self.word & ENABLE else 2

    def commands(self, word):
        """A word commands motion: in speed mode while bit 6 is set; in positioning with bits 4 and 5 while a job is under
        way or if bit 6 begins one, because it differs from status bit 12; with bit 8 or 9 in any case. A word that began
        a motion which a fault has ended still commands it. Called before `obey`."""
        if word & (CONTROL | ON | ENABLE) != CONTROL | ON | ENABLE:
            return False
        if word & JOG_STEPS:
            return True
        if word & SPEED_MODE:
            return bool(word & START)
        if word & (NO_STOP | NO_PAUSE) != NO_STOP | NO_PAUSE:
            return False
        if self.job is not None or bool(word & START) != self.is_acknowledged:
            return True
        return self.is_fault and word == self.word and self.was_job

    def obey(self, word, speed, torque, target):
        """Applies the control word; returns a line for the log, or None."""
        before, self.word, self.percent = self.word, word, speed
        falls = before & ~word
        if self.is_fault and falls & ACKNOWLEDGE:
            self.is_fault, self.is_locked, self.code = False, True, 0
        elif self.is_locked and falls & ON:
            self.is_locked = False
        if self.level() < 3:
            self.halt()
            if self.level() < 2:
                self.is_acknowledged = False
                self.is_reached = self.is_reached and (self.is_fault or self.is_locked)
            return None
        able = speed > 0 and torque > 0
        if word & SPEED_MODE:
            self.job = None
            if word & START and not (before & SPEED_MODE and before & START) and able:
                self.run, self.is_endless = 1 if word & NO_STOP else -1, bool(word & NO_PAUSE)
                return self.begin(True)
            if not word & START:
                self.run = 0
            return None
        self.run = 0
        if not word & NO_STOP:
            self.job = None
            return None
        self.is_paused = self.job is not None and not word & NO_PAUSE and not self.is_pauseless
        toggle = bool(word & START)
        if word & NO_PAUSE and toggle != self.is_acknowledged and able:
            if not self.lower <= target <= self.upper:
                return self.fail(TARGET_INVALID)
            self.job, self.was_job = target, True
            return self.begin(toggle)
        return None

    def begin(self, toggle):
        self.is_acknowledged, self.is_reached, self.is_standing = toggle, False, False
        self.began = self.position
        return "START"

    def halt(self):
        """Ends any motion; the axis brakes."""
        self.run, self.job, self.is_paused = 0, None, False

    def fail(self, code):
        self.halt()
        self.is_fault, self.code = True, code
        return f"FAULT {code:04X}"

    def place(self, position):
        self.position = self.began = float(position)
        self.velocity = 0.0

    def wanted(self):
        """Returns the commanded velocity in steps per second, and the target if there is one."""
        most = RPM / 60 * self.turn * self.percent / 100
        if self.run:
            end = None if self.is_endless or self.is_unlimited else (self.upper if self.run > 0 else self.lower)
            return self.run * most, end
        if self.job is not None and not self.is_paused:
            if self.is_overrunning:
                return math.copysign(most, self.job - self.began), None
            return math.copysign(most, self.job - self.position), self.job
        return 0.0, None

    def direction(self):
        """Returns the commanded direction: +1, -1 or 0."""
        velocity, _ = self.wanted()
        return (velocity > 0) - (velocity < 0)

    def advance(self, seconds):
        """Lets time pass; returns lines for the log."""
        wanted, end = self.wanted()
        gain = RPM / 60 * self.turn / RAMP
        if end is not None and not self.is_reversed:
            left = abs(end - self.position)
            wanted = math.copysign(min(abs(wanted), math.sqrt(2 * gain * left)), end - self.position)
            if left <= max(2.0, abs(self.velocity) * seconds):
                return self.arrive(end)
        step = gain * seconds
        self.velocity += max(-step, min(step, wanted - self.velocity))
        before = self.position
        self.position += (-self.velocity if self.is_reversed else self.velocity) * seconds
        if not self.is_unlimited and not self.is_endless_run() and self.blocks(before):
            self.position, self.velocity = min(max(self.position, self.lower), self.upper), 0.0
            return [self.fail(UPPER if self.position >= self.upper else LOWER)]
        if not wanted and self.velocity == 0.0 and not self.is_standing:
            self.is_standing = True
            return ["STAND"]
        return []

    def is_endless_run(self):
        return bool(self.run) and self.is_endless

    def blocks(self, before):
        """Returns whether a limit was crossed from inside."""
        return self.lower <= before <= self.upper and not self.lower <= self.position <= self.upper

    def arrive(self, end):
        # A run that has reached a limit stops there; a job is done, and the word that began it is harmless.
        is_new = not self.is_standing
        self.position, self.velocity, self.is_standing = float(end), 0.0, True
        if self.job is not None:
            self.is_reached, self.job, self.was_job = True, None, False
        return ["STAND"] if is_new else []

    def strays(self):
        """Returns the error of the position: BEYOND a limit in the commanded direction, PAST its target, WRONG way."""
        direction, found = self.direction(), []
        if direction > 0 and self.position > self.upper or direction < 0 and self.position < self.lower:
            found.append("BEYOND")
        if self.job is not None and direction * (self.position - self.job) * 65536 / self.turn > AWRY:
            found.append("PAST")
        if direction * (self.position - self.began) * 65536 / self.turn < -AWRY:
            found.append("WRONG")
        return found

    def status(self):
        level, word = self.level(), PRESENT
        word |= (1 if level >= 1 else 0) | (2 if level >= 2 else 0) | (4 if level >= 3 else 0)
        outside = not self.lower <= round(self.position) <= self.upper
        for bit, is_set in ((FAULT, self.is_fault), (LOCK, self.is_locked), (WARNING, self.is_fault),
                            (REACHED, self.is_reached), (ACKNOWLEDGED, self.is_acknowledged),
                            (STANDING, self.is_standing), (OUTSIDE, outside)):
            word |= bit if is_set else 0
        return word

    def speed(self):
        """Returns the speed in tenths of a revolution per minute."""
        velocity = -self.velocity if self.is_reversed else self.velocity
        return round(velocity / self.turn * 600)
