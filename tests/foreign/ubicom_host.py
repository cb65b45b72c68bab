#!/usr/bin/env python3
"""A UBICOM host: sends frames given in hex, prints every reply in hex, or "-" for none.

Written from protocol/ubicom.md only, with the Python standard library only, so that it can check the program's virtual
encoder.

  ubicom_host.py PATH FRAME...          PATH: a serial device, a pty, or tcp:HOST:PORT
  ubicom_host.py ./enc "80 01 01 02 00 26 00 55" "80 01 03 01 00 01 79"

Frames are sent as given, and replies are printed as received; "wait:SECONDS" waits.
"""

import argparse
import sys
import time

sys.dont_write_bytecode = True  # the tests leave nothing behind

import ubicom  # noqa: E402
from wire import Wire  # noqa: E402


def ask(wire, frame, patience):
    wire.send(frame)
    heard, deadline = b"", time.monotonic() + patience
    while time.monotonic() < deadline:
        more = wire.receive(deadline - time.monotonic())
        if more is None:
            break
        heard += more
        reply, rest = ubicom.take(heard)
        if reply is not None:
            return reply + rest
    return heard


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patience", type=float, default=0.25, help="seconds for a reply")
    parser.add_argument("path", help="a serial device, a pty, or tcp:HOST:PORT")
    parser.add_argument("frames", nargs="+", help="frames in hex, each whole; wait:SECONDS")
    options = parser.parse_args()
    wire = Wire(options.path, 115200, "none")
    for word in options.frames:
        if word.startswith("wait:"):
            time.sleep(float(word[5:]))
            continue
        print(ask(wire, bytes.fromhex(word), options.patience).hex(" ").upper() or "-", flush=True)


if __name__ == "__main__":
    main()
