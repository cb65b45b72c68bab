"""Events that end a motion, for motion_table.py: how the motion begins, the event, and the actions that could start it
again while the pad or the key is still held."""

import dataclasses
import os
import signal
import time
import typing

from rig import Failed, Rig

HOLD = 0.4
# In steps. Far enough that no job reaches it meanwhile; and a limit that a jog reaches within seconds, a target before it.
FAR, LIMIT, NEAR = "13107200", 12_000, "8000"


def nothing(_rig):
    return None


@dataclasses.dataclass(frozen=True)
class Event:
    name: str
    motion: str
    begin: typing.Callable[[Rig], None]
    fire: typing.Callable[[Rig], typing.Optional[int]]
    afterwards: typing.Callable[[Rig], None] = nothing
    # The parts to restart after it: "", "studio" or "all", which includes the X server.
    destroys: str = ""
    prepare: typing.Callable[[Rig], None] = nothing
    # Whether no motion is required before it.
    may_rest: bool = False
    is_timed: bool = True
    # A check for rows without motion: a new act has to begin motion, otherwise the trial fails.
    control: typing.Callable[[Rig], None] = nothing


# Starts of motion

def wait_until_it_moves(rig, since):
    until = time.monotonic() + 4
    while not rig.drive.motion(since):
        if time.monotonic() > until:
            raise Failed("nothing begins to move")
        time.sleep(0.01)
    time.sleep(HOLD)
    rig.drive.read()
    if not rig.drive.packets[-1].moves:
        raise Failed("the motion does not last")


def press_pad(rig):
    rig.at("plus")
    time.sleep(0.1)
    rig.screen.button(True)


def by_mouse(rig):
    since = time.monotonic_ns()
    press_pad(rig)
    wait_until_it_moves(rig, since)


def focus_pad(rig):
    """Moves the keyboard focus from the entry before the pads to the pads. A pad accepts a key only after it has been
    released."""
    rig.click("torque")
    time.sleep(0.1)
    for key in ("Tab", "Tab", "space", "Return"):
        rig.screen.press(key)
        time.sleep(0.1)
    # The pointer is outside all controls.
    rig.at("nowhere")
    time.sleep(0.1)


def by_key(name):
    def begin(rig):
        focus_pad(rig)
        since = time.monotonic_ns()
        rig.screen.key(name, True)
        wait_until_it_moves(rig, since)
    return begin


by_space, by_enter = by_key("space"), by_key("Return")


def by_job(rig):
    rig.text("target", FAR)
    since = time.monotonic_ns()
    rig.click("go")
    rig.at("nowhere")
    wait_until_it_moves(rig, since)


def by_run(rig):
    since = time.monotonic_ns()
    rig.click("run")
    rig.at("nowhere")
    wait_until_it_moves(rig, since)


# Events

def up(rig):
    return rig.screen.button(False)


def key_up(name):
    return lambda rig: rig.screen.key(name, False)


def slide(rig):
    return rig.at("plus", dy=-90)


def slide_back(rig):
    rig.at("plus")


def leave_window(rig):
    return rig.screen.move(1400, 500)


def other_window(rig):
    other = rig.screen.another()
    return rig.screen.activate(other)


def back_to_window(rig):
    rig.screen.activate(rig.window)


def minimise(rig):
    return rig.screen.minimise(rig.window)


def keys(*names):
    return lambda rig: rig.screen.press(*names)


def click(name, counts_down=True):
    """Returns the time at which the button goes down on it, or up for controls that act on release."""
    def fire(rig):
        rig.at(name)
        time.sleep(0.1)
        down = rig.screen.button(True)
        time.sleep(0.05)
        up_again = rig.screen.button(False)
        return down if counts_down else up_again
    return fire


def to_process(which, number):
    def fire(rig):
        process = rig.studio if which == "studio" else rig.screen.server
        when = time.monotonic_ns()
        os.kill(process.pid, number)
        return when
    return fire


def kill_server(rig):
    rig.screen.let_go_of_display()
    return to_process("server", signal.SIGKILL)(rig)


def go_on(which):
    def afterwards(rig):
        time.sleep(0.7)
        to_process(which, signal.SIGCONT)(rig)
    return afterwards


def drive(line):
    return lambda rig: rig.drive.command(line)


def close_window(rig):
    return rig.screen.close(rig.window)


def told(name, seconds=6, press=None):
    """Waits for an event in the drive's record; `press` begins the motion that leads to it."""
    def fire(rig):
        since = time.monotonic_ns()
        if press:
            press(rig)
        return rig.drive.event(name, since, seconds)
    return fire


def near_limit(*lines):
    """The upper limit is a part of a turn away, and has been read."""
    def prepare(rig):
        rig.drive.command("place 0")
        rig.drive.command(f"limits -6553600 {LIMIT}")
        for line in lines:
            rig.drive.command(line)
        time.sleep(3.0)
    return prepare


def press_go(rig):
    rig.click("go")
    rig.at("nowhere")


def overrun(rig):
    """The drive stops neither at its target nor at the limit after it."""
    near_limit("unlimited on", "overrun on")(rig)
    rig.text("target", NEAR)


def wrong_way(rig):
    rig.drive.command("reverse on")
    rig.text("target", FAR)


def key_elsewhere(name):
    """The key goes down in another window and is still down when the keyboard focus returns."""
    def begin(rig):
        focus_pad(rig)
        other_window(rig)
        time.sleep(0.4)
        rig.screen.key(name, True)
        time.sleep(0.6)
    return begin


def key_on_other_tab(name):
    def begin(rig):
        focus_pad(rig)
        rig.screen.press("Control_L", "1")
        time.sleep(0.4)
        rig.screen.key(name, True)
        time.sleep(0.6)
    return begin


def edit(rig):
    """A parameter differs from the drive, so that closing the window asks a question."""
    rig.click("parameters")
    time.sleep(4.0)
    rig.click("register 24")
    rig.screen.press("7")
    rig.screen.press("Return")
    time.sleep(0.5)
    rig.click("page")
    time.sleep(1.0)


def now(_rig):
    return time.monotonic_ns()


def without_repeat(rig):
    rig.screen.repeat(False)


def tab_back(rig):
    rig.screen.press("Control_L", "5")


def escape(rig):
    rig.screen.press("Escape")


MOUSE, SPACE, ENTER, JOB, RUN = "jog by mouse", "jog by Space", "jog by Enter", "move to a position", "run at a speed"
REST = "none"
BEGINS = {REST: nothing, MOUSE: by_mouse, SPACE: by_space, ENTER: by_enter, JOB: by_job, RUN: by_run}


def event(name, motion, fire, **more):
    return Event(name, motion, more.pop("begin", BEGINS[motion]), fire, **more)


def losses():
    """Returns the faults of the connection, for a jog and a job."""
    for motion in (MOUSE, JOB):
        for name, line in [
            ("TCP reset (RST)", "tcp reset"), ("TCP end (FIN)", "tcp fin"), ("explicit silence", "tcp silent"),
            ("explicit garbage", "tcp garbage"), ("UDP silence", "udp silent"), ("UDP garbage", "udp garbage"),
            ("fault of the drive", "fault 8200"),
        ]:
            yield event(name, motion, drive(line), destroys="studio",
                        afterwards=drive("udp answer") if line.startswith("udp") else
                        drive("tcp answer") if line in ("tcp silent", "tcp garbage") else nothing)


EVENTS = [
    event("release", MOUSE, up),
    event("pad left", MOUSE, slide, afterwards=slide_back),
    event("window left", MOUSE, leave_window, afterwards=slide_back),
    event("focus lost", MOUSE, other_window, afterwards=back_to_window),
    event("focus lost", SPACE, other_window, afterwards=back_to_window),
    event("focus lost", ENTER, other_window, afterwards=back_to_window),
    event("focus lost", RUN, other_window, afterwards=back_to_window),
    event("minimised", MOUSE, minimise, afterwards=back_to_window),
    event("minimised", SPACE, minimise, afterwards=back_to_window),
    event("tab", MOUSE, keys("Control_L", "1"), afterwards=tab_back),
    event("tab", SPACE, keys("Control_L", "1"), afterwards=tab_back),
    event("file dialog (Ctrl+O)", MOUSE, keys("Control_L", "o"), afterwards=escape),
    event("file dialog (Ctrl+O)", SPACE, keys("Control_L", "o"), afterwards=escape),
    event("dialog (Connect…)", SPACE, click("connect", counts_down=False), afterwards=escape),
    event("help card", SPACE, keys("F1"), afterwards=keys("F1")),
    event("Esc", MOUSE, keys("Escape")),
    event("Esc", SPACE, keys("Escape")),
    event("Esc", JOB, keys("Escape")),
    event("Esc", RUN, keys("Escape")),
    event("STOP", SPACE, click("stop")),
    event("STOP", JOB, click("stop")),
    event("STOP", RUN, click("stop")),
    event("another key", MOUSE, keys("a")),
    event("Space", MOUSE, keys("space")),
    event("Space", JOB, keys("space")),
    event("key released, repeating", SPACE, key_up("space")),
    event("key released, repeating", ENTER, key_up("Return")),
    event("key released, not repeating", SPACE, key_up("space"), prepare=without_repeat),
    event("key released, not repeating", ENTER, key_up("Return"), prepare=without_repeat),
    event("key held in another window", SPACE, now, begin=key_elsewhere("space"), afterwards=back_to_window,
          may_rest=True, is_timed=False, control=by_space),
    event("key held in another window", ENTER, now, begin=key_elsewhere("Return"), afterwards=back_to_window,
          may_rest=True, is_timed=False, control=by_enter),
    event("key held on another tab", SPACE, now, begin=key_on_other_tab("space"), afterwards=tab_back,
          may_rest=True, is_timed=False, control=by_space),
    event("SIGSTOP", MOUSE, to_process("studio", signal.SIGSTOP), afterwards=go_on("studio"), destroys="studio"),
    event("SIGSTOP", SPACE, to_process("studio", signal.SIGSTOP), afterwards=go_on("studio"), destroys="studio"),
    event("SIGSTOP", JOB, to_process("studio", signal.SIGSTOP), afterwards=go_on("studio"), destroys="studio"),
    event("SIGKILL", MOUSE, to_process("studio", signal.SIGKILL), destroys="studio"),
    event("X server frozen", MOUSE, to_process("server", signal.SIGSTOP), afterwards=go_on("server"), destroys="studio"),
    event("X server frozen", SPACE, to_process("server", signal.SIGSTOP), afterwards=go_on("server"), destroys="studio"),
    event("X server frozen", JOB, to_process("server", signal.SIGSTOP), afterwards=go_on("server"), destroys="studio"),
    event("X server killed", MOUSE, kill_server, destroys="all"),
    event("X server killed", JOB, kill_server, destroys="all"),
    event("window closed", MOUSE, close_window, destroys="studio"),
    event("window closed", JOB, close_window, destroys="studio"),
    event("window closed with unsaved edits", MOUSE, close_window, prepare=edit, destroys="studio"),
    event("window closed with unsaved edits", JOB, close_window, prepare=edit, destroys="studio"),
    event("SIGTERM", MOUSE, to_process("studio", signal.SIGTERM), destroys="studio"),
    event("SIGTERM", JOB, to_process("studio", signal.SIGTERM), destroys="studio"),
    *losses(),
    event("60 ms without cyclic data", MOUSE, drive("pause 60"), destroys="studio"),
    event("60 ms without cyclic data", REST, drive("pause 60"), destroys="studio", may_rest=True, is_timed=False),
    event("limit, the drive stops", MOUSE, told("STAND", press=press_pad), begin=nothing, prepare=near_limit(),
          destroys="studio"),
    event("limit ignored by the drive", MOUSE, told("BEYOND", press=press_pad), begin=nothing,
          prepare=near_limit("unlimited on"), destroys="studio"),
    event("limit ignored by the drive", RUN, told("BEYOND", press=lambda rig: rig.click("run")), begin=nothing,
          prepare=near_limit("unlimited on"), destroys="studio"),
    event("target ignored by the drive", JOB, told("PAST", press=press_go), begin=nothing, prepare=overrun,
          destroys="studio"),
    event("wrong way", MOUSE, told("WRONG", press=press_pad), begin=nothing, prepare=drive("reverse on"),
          destroys="studio"),
    event("wrong way", JOB, told("WRONG", press=press_go), begin=nothing, prepare=wrong_way, destroys="studio"),
]
