"""The studio in a window, a separate drive and simulated user input, for motion_table.py."""

import collections
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from x11 import Screen

FOREIGN = pathlib.Path(__file__).resolve().parent.parent / "foreign"
SIZE = (1280, 1000)
# Positions in a window of that size, in English. --points has others.
POINTS = {
    "page": (59, 252), "take": (349, 70), "stop": (227, 78), "nowhere": (349, 860), "connect": (967, 25),
    "torque": (707, 429), "plus": (729, 478), "target": (379, 626), "go": (231, 735), "run": (661, 942),
    "parameters": (70, 288), "register 24": (501, 549),
}
Packet = collections.namedtuple("Packet", "at sequence word status position moves")
MS = 1_000_000


class Failed(Exception):
    """A trial that failed: no result about the studio's motion."""


class Drive:
    """moving_target.py, its commands and its record."""

    def __init__(self, folder):
        self.path = os.path.join(folder, "record")
        program = [sys.executable, "-B", str(FOREIGN / "moving_target.py"), "--record", self.path]
        self.process = subprocess.Popen(program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1)
        first_of_all(self.process.pid)
        self.place = self.process.stdout.readline().split()[1]
        self.record, self.partial = open(self.path, encoding="ascii"), ""
        self.packets, self.events = [], []

    def command(self, line):
        """Returns the time at which it was done."""
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()
        words = self.process.stdout.readline().split()
        if words[:1] != ["done"]:
            raise Failed(f"the drive does not obey {line}")
        return int(words[1])

    def read(self):
        """Returns the records since then."""
        *lines, self.partial = (self.partial + self.record.read()).split("\n")
        for line in lines:
            kind, at, *rest = line.split()
            if kind == "P":
                sequence, word, status, position, moves, _ = rest
                packet = Packet(int(at), int(sequence), int(word, 16), int(status, 16), int(position), moves == "1")
                self.packets.append(packet)
            else:
                self.events.append((int(at), " ".join(rest)))

    def event(self, name, since, seconds):
        """Returns the time of an event; None: it did not happen."""
        until = time.monotonic() + seconds
        while True:
            self.read()
            for at, what in self.events:
                if at >= since and what.split()[0] == name:
                    return at
            if time.monotonic() > until:
                return None
            time.sleep(0.01)

    def motion(self, since):
        self.read()
        return [packet for packet in self.packets if packet.moves and packet.at >= since]

    def end(self):
        self.process.kill()
        self.process.wait()
        self.record.close()


def first_of_all(pid):
    """With builds on the same computer, the measured times would include waiting for them."""
    try:
        os.sched_setscheduler(pid, os.SCHED_RR, os.sched_param(1))
    except (OSError, AttributeError):
        pass


def before_others():
    """Sets priorities as on an idle computer: if the system allows it, other users' builds run later."""
    try:
        os.setpriority(os.PRIO_PROCESS, 0, -10)
    except OSError:
        pass


class Rig:
    """The complete rig. `points`: positions of controls."""

    def __init__(self, binary, points, verbose):
        self.binary, self.points, self.verbose = binary, {**POINTS, **points}, verbose
        self.screen = self.drive = self.studio = self.window = self.folder = self.pictures = None

    def say(self, *words):
        if self.verbose:
            print(*words, file=sys.stderr, flush=True)

    def start(self):
        """Starts a new drive and a new studio in control of it, on the page Motion."""
        self.end_studio()
        if self.screen is None:
            self.screen = Screen(priority=before_others)
        self.folder = tempfile.mkdtemp(prefix="motion-")
        self.drive = Drive(self.folder)
        names = ["HOME", "XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME"]
        own = {**dict.fromkeys(names, self.folder), "DISPLAY": self.screen.name, "LANG": "C.UTF-8"}
        environment = {key: value for key, value in {**os.environ, **own}.items() if key != "WAYLAND_DISPLAY"}
        log = open(os.path.join(self.folder, "studio.log"), "w", encoding="utf-8")
        link = f"enip:{self.drive.place}"
        program = [self.binary, "--link", link]
        self.studio = subprocess.Popen(program, env=environment, stdout=log, stderr=log, preexec_fn=before_others)
        self.window = self.screen.window_of(self.studio.pid)
        self.screen.repeat(True)
        self.screen.place(self.window, 0, 0, *SIZE)
        time.sleep(1.0)
        self.left, self.top = self.screen.origin(self.window)
        self.screen.activate(self.window)
        began, until = time.monotonic_ns(), time.monotonic() + 30
        while not self.drive.event("OPEN", began, 1.5):
            if time.monotonic() > until:
                raise Failed("the studio does not take control")
            self.click("page")
            time.sleep(0.4)
            self.click("take")
        time.sleep(0.5)

    def end_studio(self):
        if self.screen is not None and self.screen.display is not None:
            self.screen.release_all()
        if self.studio is not None:
            if self.studio.poll() is None:
                os.kill(self.studio.pid, signal.SIGCONT)
                self.studio.kill()
            self.studio.wait()
            self.drive.end()
            shutil.rmtree(self.folder, ignore_errors=True)
        self.studio = self.drive = None

    def recover(self, destroys):
        """Ends a trial: releases all input, and restarts the destroyed parts: "", "studio" or "all"."""
        if destroys == "all":
            self.end()
        elif destroys:
            self.end_studio()
        else:
            self.screen.release_all()
            self.screen.repeat(True)
            self.screen.activate(self.window)
            time.sleep(0.3)
            self.screen.press("Escape")
            time.sleep(0.5)
            if self.drive.motion(time.monotonic_ns() - 300 * MS):
                self.end_studio()
            else:
                self.drive.command("place 0")

    def end(self):
        self.end_studio()
        if self.screen is not None:
            self.screen.end()
            self.screen = None

    def at(self, name, dx=0, dy=0):
        x, y = self.points[name]
        return self.screen.move(self.left + x + dx, self.top + y + dy)

    def click(self, name, times=1):
        self.at(name)
        time.sleep(0.1)
        for _ in range(times):
            self.screen.button(True)
            time.sleep(0.08)
            self.screen.button(False)
            # A slow frame must not see it at another position yet.
            time.sleep(0.25)

    def text(self, name, text):
        """Replaces the text of an entry."""
        self.click(name)
        self.screen.press("Control_L", "a")
        for letter in text:
            self.screen.press({"-": "minus", ".": "period"}.get(letter, letter))
            time.sleep(0.02)
        time.sleep(0.1)

    def picture(self, path):
        """Takes a screenshot, if ImageMagick is available."""
        if shutil.which("import"):
            environment = {**os.environ, "DISPLAY": self.screen.name}
            subprocess.run(["import", "-window", "root", path], env=environment, check=False, timeout=20)
