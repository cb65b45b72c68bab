#!/usr/bin/env python3
"""A HIPERFACE host: sends frames given in hex, prints every reply in hex, or "-" for none.

Written from SICK 8010701 "HIPERFACE - Beschreibung / Description" (tables of commands and "Dialog Timing") only, with the
Python standard library only, so that it can check the program's virtual encoder.

  master.py PATH FRAME...          PATH: a serial device, a pty, or tcp:HOST:PORT
  master.py ./encoder "40 42 02" "FF 50 AF"
  master.py --sum tcp:127.0.0.1:4000 "40 42"

Nothing is corrected: frames are sent as given, and replies are printed as received.
"""

import argparse
import sys
import time

sys.dont_write_bytecode = True  # the tests leave nothing behind

from wire import BIT_RATES, Wire  # noqa: E402

# Longest time to process a command in milliseconds.
MAX_MS = {0x42: 10, 0x43: 40, 0x44: 5, 0x46: 5, 0x47: 30, 0x49: 30, 0x4A: 30, 0x4B: 250, 0x4C: 5, 0x4D: 70, 0x4E: 5,
          0x4F: 40, 0x50: 5, 0x52: 5, 0x53: 0, 0x55: 40, 0x56: 5, 0x57: 40, 0x63: 40, 0x67: 5}
RESET = 0x53
LONGEST_REPLY = 3 + 3 + 128


class Host:
    """The times of the line: dead times, waiting times, and the converter's echo."""

    def __init__(self, wire, options):
        self.wire, self.options = wire, options
        self.character = 11 / options.baud
        self.silence = 44 / options.baud

    def ask(self, frame):
        """Sends a frame and returns the bytes before the line was silent again."""
        self.wire.send(frame)
        command = frame[1] & 0x7F if len(frame) > 1 else 0
        first = len(frame) * self.character + self.silence + MAX_MS.get(command, 250) / 1000 + self.options.margin
        deadline = time.monotonic() + first
        last = deadline + LONGEST_REPLY * self.character + self.options.margin
        got, echoed = b"", 0
        while True:
            more = self.wire.receive(min(deadline, last) - time.monotonic())
            if not more:
                break
            if self.options.echo and echoed < len(frame):
                own = more[:len(frame) - echoed]
                if own != frame[echoed:echoed + len(own)]:
                    sys.exit(f"echo {own.hex(' ').upper()} differs from what was sent")
                echoed += len(own)
                more = more[len(own):]
            if more:
                got += more
                deadline = time.monotonic() + self.options.idle
        if self.options.echo and echoed < len(frame):
            print("no echo", file=sys.stderr)
        time.sleep(0.2 if command == RESET else self.options.gap)
        return got


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("path", help="a serial device, a pty, or tcp:HOST:PORT")
    add("frames", nargs="+", type=bytes.fromhex, help="a frame in hex, with its checksum")
    add("--sum", action="store_true", help="append the checksum to every frame")
    add("--echo", action="store_true", help="the converter sends our own bytes back first")
    add("--baud", type=int, choices=sorted(BIT_RATES), default=9600)
    add("--parity", choices=["none", "even", "odd"], default="even")
    add("--gap", type=float, default=0.010, help="dead time between a reply and the next frame, in seconds")
    add("--idle", type=float, default=0.025, help="silence that ends a reply, in seconds")
    add("--margin", type=float, default=0.1, help="added to the encoder's longest time, in seconds")
    return parser.parse_args()


def main():
    options = parse_options()
    try:
        host = Host(Wire(options.path, options.baud, options.parity), options)
    except OSError as error:
        sys.exit(f"{options.path}: {error}")
    for frame in options.frames:
        if options.sum:
            checksum = 0
            for byte in frame:
                checksum ^= byte
            frame += bytes([checksum])
        print(host.ask(frame).hex(" ").upper() or "-", flush=True)


if __name__ == "__main__":
    main()
