#!/usr/bin/env python3
"""Table of the time that the studio continues to command a motion after each event that ends it.

    tests/tools/motion_table.py target/release/encoder-studio --output table.md --csv trials.csv

Starts Xvfb, openbox, a drive (tests/foreign/moving_target.py) and the studio; holds the jog pads, begins a job, and then
causes the events that end a motion, with real pointer and key events. Needs Xvfb, openbox, libX11, libXtst and Linux; it
is not part of the tests. The complete table takes three quarters of an hour; --only NAME,… makes some rows, --count N
sets the number of trials.

A trial: the motion is commanded for 0.4 s, the event happens, and the record of the drive is searched for the last packet
of that motion. Then the actions follow that could start it again (the pointer returns, the window gets the keyboard
focus, the process continues …) while the pad or the key is still held, and a packet that commands motion within 3 s of
that counts as resumed.
"""

import argparse
import collections
import csv
import json
import os
import signal
import statistics
import sys
import time

sys.dont_write_bytecode = True

from events import EVENTS, nothing  # noqa: E402
from rig import MS, Failed, Rig  # noqa: E402

# A motion that continues for this time after the event is not ended by it.
MOST = 8.0
# Time without a packet that commands motion after which the motion has ended.
GAP = 0.35
AFTERWARDS = 3.0
# 250 ms and one interval of 10 ms.
BOUND = 260.0

# How the connection ended, from the drive's record.
CONNECTION = {"CLOSE": "closed", "LOST": "watchdog"}


class Trial:
    def __init__(self, event, latency=None, resumed=None, words="", connection=""):
        self.event, self.latency, self.resumed, self.words, self.connection = event, latency, resumed, words, connection


def last_of(packets, fired):
    """Returns the last packet of the motion at `fired`, and whether the motion has ended."""
    last, quiet = fired, False
    for packet in packets:
        if packet.at < fired:
            continue
        if packet.at - last > GAP * 1000 * MS or not packet.moves:
            return last, True
        last = packet.at
    return last, quiet


def wait_for_end(rig, fired):
    until = time.monotonic() + MOST
    while time.monotonic() < until:
        rig.drive.read()
        last, ended = last_of(rig.drive.packets, fired)
        # Without any packets it has ended as well.
        newest = rig.drive.packets[-1].at if rig.drive.packets else 0
        if ended or time.monotonic_ns() - max(newest, fired) > 2 * GAP * 1000 * MS:
            return last, True
        time.sleep(0.02)
    return last, False


def trial_of(rig, event):
    began = time.monotonic_ns()
    event.begin(rig)
    fired = event.fire(rig)
    if fired is None:
        raise Failed("what was to happen did not")
    rig.drive.read()
    if not event.may_rest and not any(began <= packet.at for packet in rig.drive.packets if packet.moves):
        raise Failed("nothing moved")
    last, ended = wait_for_end(rig, fired)
    trial = Trial(event, max(0.0, (last - fired) / MS) if ended else float("inf"))
    time.sleep(0.3)
    event.afterwards(rig)
    time.sleep(AFTERWARDS)
    if ended:
        rig.drive.read()
        again = [packet for packet in rig.drive.packets if packet.moves and packet.at > last and packet.at > fired]
        trial.resumed = bool(again)
        if again:
            trial.words = f"{len(again)} packets from {(again[0].at - fired) / MS:.0f} ms on, {again[0].word:04X}"
    if not trial.resumed and event.control is not nothing:
        rig.screen.release_all()
        time.sleep(0.5)
        event.control(rig)
    trial.connection = "kept" if event.destroys else ""
    for at, what in rig.drive.events:
        if at >= fired and what in CONNECTION:
            trial.connection = CONNECTION[what]
    return trial


def trials_of(rig, event, count):
    """Runs the requested number of trials; the rig is restarted after events that destroy it, and after a failure."""
    trials, failures = [], 0
    while len(trials) < count and failures < 5:
        try:
            if rig.studio is None:
                rig.start()
            event.prepare(rig)
            trials.append(trial_of(rig, event))
            rig.say(event.name, f"{trials[-1].latency:.1f} ms", trials[-1].words)
            rig.recover(event.destroys)
        except (Failed, RuntimeError, OSError) as why:
            failures += 1
            rig.say(event.name, "failed:", why)
            if rig.pictures:
                rig.picture(os.path.join(rig.pictures, f"{event.name.replace(' ', '-')}-{failures}.png"))
            rig.recover("all")
    return trials


def row_of(event, trials):
    """Returns a line of the table."""
    times = [trial.latency for trial in trials]
    resumed, longest = sum(bool(trial.resumed) for trial in trials), max(times)
    faults = ["late"] * (longest > BOUND) + ["resumes"] * bool(resumed)
    shown = ["goes on" if value == float("inf") else f"{value:.0f}" for value in (statistics.median(times), longest)]
    verdict = f"**{', '.join(faults)}**" if faults else ""
    ends = collections.Counter(trial.connection for trial in trials if trial.connection)
    connection = ", ".join(f"{how} {count}" for how, count in sorted(ends.items()))
    shown = shown if event.is_timed else ["", ""]
    return [event.name, event.motion, str(len(trials)), *shown, f"{resumed}", connection, verdict]


HEAD = ["event", "motion", "trials", "median ms", "longest ms", "resumed", "connection", "fault"]


def markdown(trials):
    measured = [(event, [trial for trial in trials if trial.event == event]) for event in EVENTS]
    rows = [row_of(event, own) for event, own in measured if own]
    lines = ["| " + " | ".join(HEAD) + " |", "|---|---|--:|--:|--:|--:|---|---|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binary", help="the studio")
    parser.add_argument("--count", type=int, default=10, help="trials of a quick event; of one that ends a session half as many")
    parser.add_argument("--only", default="", help="names of events, or their beginnings, with commas")
    parser.add_argument("--list", action="store_true", help="name the events and end")
    parser.add_argument("--points", type=json.loads, default={}, help='places in the window: {"plus": [640, 400]}')
    parser.add_argument("--minutes", type=float, default=90, help="no further event is begun after this time")
    parser.add_argument("--output", help="file for the table")
    parser.add_argument("--csv", help="file for a line a trial; more are added to those that it has")
    parser.add_argument("--pictures", help="folder for pictures of the screen after failures")
    parser.add_argument("--verbose", action="store_true")
    options = parser.parse_args()
    chosen = [name for name in options.only.split(",") if name]
    events = [event for event in EVENTS if not chosen or any(event.name.startswith(name) for name in chosen)]
    if options.list:
        print("\n".join(f"{event.name}: {event.motion}" for event in events))
        return
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))
    rig = Rig(os.path.abspath(options.binary), options.points, options.verbose)
    rig.pictures = options.pictures
    until, all_trials = time.monotonic() + 60 * options.minutes, earlier(options.csv)
    try:
        for event in events:
            if time.monotonic() > until:
                rig.say("no time left for", event.name)
                break
            count = max(1, options.count // 2) if event.destroys else options.count
            trials = trials_of(rig, event, count)
            all_trials += trials
            keep(options.csv, trials)
            if options.output:
                with open(options.output, "w", encoding="utf-8") as out:
                    out.write(markdown(all_trials))
    finally:
        rig.end()
    if not options.output:
        print(markdown(all_trials))


def earlier(path):
    """Reads trials of earlier runs."""
    if not path or not os.path.exists(path):
        return []
    by_name = {(event.name, event.motion): event for event in EVENTS}
    with open(path, newline="", encoding="utf-8") as lines:
        return [Trial(by_name[name, motion], float(latency), resumed == "yes", *more)
                for name, motion, latency, resumed, *more in csv.reader(lines) if (name, motion) in by_name]


def keep(path, trials):
    if path:
        with open(path, "a", newline="", encoding="utf-8") as out:
            rows = [[trial.event.name, trial.event.motion, f"{trial.latency:.3f}", "yes" if trial.resumed else "no",
                     trial.words, trial.connection] for trial in trials]
            csv.writer(out).writerows(rows)


if __name__ == "__main__":
    main()
