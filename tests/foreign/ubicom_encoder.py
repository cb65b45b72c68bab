#!/usr/bin/env python3
"""A kit encoder with UBICOM on a pseudo terminal, for tests against a separate process with separate code.

Written from protocol/ubicom.md only, with the Python standard library only; the encoder is in kit.py. It prints one line
"ready PATH" and answers until SIGTERM (or the end of stdin, --stdin-eof). A frame ends with a pause of 20 ms.
"""

import argparse
import random
import sys
import time

sys.dont_write_bytecode = True  # the tests leave nothing behind

import kit  # noqa: E402
import ubicom  # noqa: E402
from terminal import END, Terminal  # noqa: E402

PAUSE = 0.020


class Line:
    def __init__(self, encoder, options):
        self.encoder, self.options = encoder, options
        self.terminal = Terminal(options.stdin_eof)
        self.random = random.Random(options.seed)

    def run(self):
        heard = b""
        while True:
            data = self.terminal.read(PAUSE if heard else None)
            if data is END:
                return
            if data is None:
                heard = b""
                self.terminal.hang_up()
                continue
            if not data:
                heard = b""
                continue
            if self.options.echo:
                self.terminal.write(data)
            heard += data
            while True:
                frame, heard = ubicom.take(heard)
                if frame is None:
                    break
                self.serve(frame)

    def serve(self, frame):
        if self.options.nonsense:
            self.terminal.write(self.random.randbytes(self.random.randint(1, 40)))
            return
        reply = self.answer(frame[2], frame[5:-1])
        if reply is None:
            return
        time.sleep(self.options.delay)
        if self.random.random() < self.options.broken:
            at = self.random.randrange(len(reply))
            reply = reply[:at] + bytes([reply[at] ^ 1 << self.random.randrange(8)]) + reply[at + 1:]
        self.terminal.write(reply)

    def answer(self, command, payload):
        number = int.from_bytes(payload[:2], self.options.order)
        if command == ubicom.READ and len(payload) == 2:
            value = self.encoder.read(ubicom.place(number))
            return None if value is None else ubicom.frame(command, [value])
        if command == ubicom.WRITE and len(payload) == 3:
            taken = self.encoder.write(ubicom.place(number), payload[2])
            return None if taken is None else ubicom.frame(command, [ubicom.ACK if taken else ubicom.NAK])
        if command == ubicom.POSITION and payload == b"\x01":
            position = self.encoder.position()
            if position is not None:
                return ubicom.frame(command, (position[0] << 17 | position[1]).to_bytes(5, "little"))
        return None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--link", help="symbolic link to make to the pty")
    add("--stdin-eof", action="store_true", help="end when stdin ends")
    add("--echo", action="store_true", help="send the host's bytes back first, as a single wire does")
    add("--order", choices=["little", "big"], default="little", help="of a register number's two bytes")
    add("--nonsense", action="store_true", help="answer random bytes")
    add("--broken", type=float, default=0.0, help="share of replies with one flipped bit")
    add("--seed", type=int, default=1)
    add("--delay", type=float, default=0.0, help="seconds to process a request")
    kit.add_options(add)
    options = parser.parse_args()
    line = Line(kit.Kit(options), options)
    line.terminal.serve(options.link, line.run)


if __name__ == "__main__":
    main()
