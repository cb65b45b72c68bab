#!/usr/bin/env python3
"""A HIPERFACE encoder on a pseudo terminal, for tests against a separate process with separate code.

Written from SICK 8010701 "HIPERFACE - Beschreibung / Description" only, with the Python standard library only. This file
has the line and the options; the encoder is in device.py.

It opens a pty, prints one line "ready PATH" and answers until SIGTERM (or the end of stdin, --stdin-eof). A request ends
with 6 ms of silence (4.6 ms on a real line). A client that closes the line is noticed if it stays away for some
milliseconds. The state is JSON:

  {"address": "40", "settings": "E4", "codes": ["55", "55", "55", "55"], "counter": 0, "position": 918833,
   "fields": [{"status": "C9", "bytes": "..."}], "free": "bytes that no field uses"}

Every option that takes bytes takes them as hex.
"""

import argparse
import json
import random
import sys
import threading
import time

sys.dont_write_bytecode = True  # the tests leave nothing behind

from device import BLOCK, Died, Encoder  # noqa: E402
from terminal import END, Terminal  # noqa: E402

SILENCE = 0.006  # seconds that end a frame
READ_STATUS = 0x50


class Line:
    """Splits the received bytes into frames, and answers them."""

    def __init__(self, encoder, options):
        self.encoder, self.options = encoder, options
        self.terminal = Terminal(options.stdin_eof)
        self.dead = False
        self.late_replies = 0
        self.status_replies = list(options.status_replies)
        self.last_status = b""
        self.random = random.Random(options.seed)

    def run(self):
        frame = b""
        while True:
            data = self.terminal.read(SILENCE if frame else None)
            if data is END:
                return
            if data:
                if self.options.echo:
                    self.terminal.write(data)
                frame += data
                continue
            if frame:
                self.serve(frame)
                frame = b""
            if data is None:
                self.dead = False
                self.terminal.hang_up()

    def serve(self, frame):
        if self.options.log:
            with open(self.options.log, "a", encoding="ascii") as log:
                log.write(frame.hex(" ").upper() + "\n")
        if self.dead or self.options.silent:
            return
        if self.options.nonsense:
            self.terminal.write(self.random.randbytes(self.random.randint(1, 40)))
            return
        try:
            reply = self.encoder.answer(frame)
        except Died:
            self.dead, reply = True, None
        if self.options.state:
            self.encoder.save(self.options.state)
        late, times = self.options.late_status
        if reply and frame[1] == READ_STATUS and self.late_replies < times:
            self.late_replies += 1
            threading.Timer(late, self.terminal.write, [reply]).start()
        elif reply and frame[1] == READ_STATUS and self.status_replies:
            self.answer_status(self.status_replies.pop(0), reply)
        elif reply:
            time.sleep(self.options.delay)
            self.terminal.write(reply)

    def answer_status(self, how, reply):
        """Damages a reply to 50h as a line or a device server may."""
        before, self.last_status = self.last_status, reply
        time.sleep(self.options.delay)
        parts = {
            "good": [reply],
            "lost": [],
            "twice": [reply, reply],
            "twice-apart": [reply, None, reply],
            "cut": [reply[:-1]],
            "behind-the-last": [before, reply],
            "the-last": [before],
        }
        for part in parts[how]:
            if part is None:
                time.sleep(0.1)
            else:
                self.terminal.write(part)


def parse_options(description=__doc__, more=lambda add: None):
    def byte(text):
        return int(text, 16)

    def late(text):
        milliseconds, times = text.split(":")
        return int(milliseconds) / 1000, int(times)

    def channel(text):
        number, value = text.split("=")
        return int(number, 16), int(value)

    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--link", help="symbolic link to make to the pty")
    add("--state", help="JSON file that keeps the EEPROM across runs; wins over the options")
    add("--log", help="file to append every request frame to, in hex, one a line")
    add("--stdin-eof", action="store_true", help="end when stdin ends")
    add("--echo", action="store_true", help="send the host's bytes back first, as many converters do")
    add("--silent", action="store_true", help="never answer")
    add("--nonsense", action="store_true", help="answer random bytes")
    add("--seed", type=int, default=1, help="of the random bytes")
    add("--die-in-store", type=int, metavar="N",
        help="write only half of the Nth store, then be silent until the client closes and opens the line")
    add("--delay", type=float, default=0.003, help="seconds to process a request")
    add("--late-status", type=late, default=(0.0, 0), metavar="MS:N",
        help="the first N replies to 50h come so late; what comes meanwhile is answered")
    add("--status-replies", type=lambda text: text.split(","), default=[], metavar="HOW,…",
        help="how the first replies to 50h come: good, lost, twice, twice-apart, cut, behind-the-last, the-last")
    add("--address", type=byte, default=0x40)
    add("--settings", type=byte, default=0xE4)
    add("--type", type=byte, default=0x37)
    add("--eeprom", type=byte, default=0x80, help="size byte of the type label")
    add("--hardware", type=byte, default=0x01, help="option byte of the type label")
    add("--serial", default="GB0450179")
    add("--firmware", default="V1.23")
    add("--date", default="01.02.16")
    add("--position", type=lambda text: int(text, 0), default=0x000E0531)
    add("--counter", type=lambda text: int(text, 0), default=0)
    add("--blocks", type=int, default=112, help="blocks of 16 bytes for data fields")
    add("--fields", type=json.loads, default=[], help='as JSON: [{"status": "C9", "bytes": "0815"}, ...]')
    add("--label", type=bytes.fromhex, default=b"", help="extended label, filled up with 00 to blocks of 16")
    add("--status", type=bytes.fromhex, default=b"", help="codes waiting in the queue")
    add("--channel", type=channel, action="append", default=[], metavar="CH=VALUE", help="analogue value")
    add("--reply-from", choices=["old", "new"], default="old", help="address in the reply to 55h")
    add("--no-repeat", action="store_true", help="replies to 55h, 57h and 67h without the argument")
    more(add)
    options = parser.parse_args()
    options.channels = dict([(0x00, 511), (0x01, 0), (0x48, 42)] + options.channel)
    options.label += bytes(-len(options.label) % BLOCK)
    return options


def main():
    options = parse_options()
    line = Line(Encoder(options), options)
    line.terminal.serve(options.link, line.run)


if __name__ == "__main__":
    main()
