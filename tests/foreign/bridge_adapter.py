#!/usr/bin/env python3
"""An adapter with the bridge protocol on a TCP port or a pseudo terminal, with the kit encoder and an SSI encoder on the
same shaft, for tests against a separate process with separate code.

Written from protocol/bridge.md, biss.md and ssi.md only, with the Python standard library only; the encoder is in kit.py,
SSI words are in ssi.py. It prints one line "ready ADDRESS" and serves one client after the other until SIGTERM (or the
end of stdin, --stdin-eof).
"""

import argparse
import select
import signal
import socket
import sys
import time

sys.dont_write_bytecode = True  # the tests leave nothing behind

import bridge  # noqa: E402
import kit  # noqa: E402
import ssi  # noqa: E402
from terminal import END, Terminal  # noqa: E402


class Refused(Exception):
    def __init__(self, code, words):
        super().__init__(words)
        self.code, self.words = code, words


class Adapter:
    def __init__(self, encoder, options, send):
        self.encoder, self.options, self.send = encoder, options, send
        self.began = time.monotonic()
        self.heard = b""
        self.bits = None
        self.clocks = self.burst_us = None
        self.stream = None  # period in microseconds, start, frames sent, whether they are SSI words
        self.pushed = self.frames = self.words = 0

    def hear(self, data):
        self.heard += data
        *packets, self.heard = self.heard.split(b"\x00")
        for stuffed in packets:
            packet = bridge.parse(stuffed) if stuffed else None
            if packet is not None:
                self.answer(*packet)

    def answer(self, seq, op, body):
        if self.options.silent:
            return
        try:
            reply = self.carry_out(op, body)
        except Refused as refused:
            self.send(bridge.emit(seq, bridge.ERROR, bytes([op, refused.code]) + bridge.text(refused.words)))
            return
        self.send(bridge.emit(seq, op | bridge.REPLY, reply))

    def carry_out(self, op, body):
        if op == bridge.HELLO:
            self.stream = None
            switches = 0 if self.encoder.supplied is None else 1 << 5
            numbers = [self.options.capabilities | switches, self.options.max_clock, 0]
            numbers = b"".join(number.to_bytes(4, "little") for number in numbers)
            return bytes([self.options.version]) + numbers + b"".join(map(bridge.text, ["bench adapter", "B7", "2.1"]))
        if op == bridge.SUPPLY and self.encoder.supplied is not None:
            return self.supply(bool(body[0]), int.from_bytes(body[1:3], "little"))
        if op == bridge.BISS_CONFIG:
            clock = min(int.from_bytes(body[0:4], "little"), self.options.max_clock)
            self.bits = body[4] + body[5]
            return clock.to_bytes(4, "little")
        if op in (bridge.SSI_CONFIG, bridge.SSI_READ, bridge.SSI_STREAM) and self.options.capabilities & 1:
            return self.of_ssi(op, body)
        if op not in (bridge.BISS_READ, bridge.REG_READ, bridge.REG_WRITE, bridge.BISS_STREAM):
            raise Refused(bridge.NOT_SUPPORTED, "not supported")
        if self.bits is None:
            raise Refused(bridge.BAD_ARGUMENT, "not configured")
        if op == bridge.BISS_STREAM:
            period = int.from_bytes(body, "little")
            self.stream = (period, time.monotonic(), 0, False) if period else None
            return body
        if self.stream:
            raise Refused(bridge.BUSY, "a stream is running")
        if op == bridge.BISS_READ:
            status, raw = self.frame()
            return self.clock(time.monotonic()) + bytes([status]) + raw.to_bytes(8, "little")
        if self.options.line != "good" or self.encoder.supplied is False:
            raise Refused(bridge.NO_ANSWER, "no answer")
        address = body[1]
        place = (None, address) if address >= 0x40 else (self.encoder.bank, address)
        if op == bridge.REG_WRITE:
            if self.encoder.write(place, body[2]) is None:
                raise Refused(bridge.NO_ANSWER, "no answer")
            # The control frame that writes a register returns its value; a command may restart the encoder then.
            value = self.encoder.read(place) if self.encoder.answers() else body[2]
        else:
            value = self.encoder.read(place)
        if value is None:
            raise Refused(bridge.NO_ANSWER, "no answer")
        return bytes([value])

    def supply(self, on, millivolt):
        """Keeps the supply: HELLO does not switch it, nor does a host that disconnects."""
        self.encoder.note(f"S {millivolt}" if on else "S off")
        if on and not self.encoder.supplied:
            self.encoder.restart()
        self.encoder.supplied = on
        measured = (millivolt, 60) if on else (0, 0)
        return bytes([on]) + b"".join(number.to_bytes(2, "little") for number in measured)

    def of_ssi(self, op, body):
        if op == bridge.SSI_CONFIG:
            clock, pause = int.from_bytes(body[1:5], "little"), int.from_bytes(body[5:7], "little")
            if not 1 <= body[0] <= 64 or clock < 1000 or body[7] != 1:
                raise Refused(bridge.BAD_ARGUMENT, "no such clocks")
            clock = min(clock, self.options.max_clock)
            self.clocks, self.burst_us = body[0], -(-body[0] * 1_000_000 // clock) + pause
            return clock.to_bytes(4, "little")
        if self.clocks is None:
            raise Refused(bridge.BAD_ARGUMENT, "not configured")
        if op == bridge.SSI_STREAM:
            period = int.from_bytes(body, "little")
            period = max(period, self.burst_us) if period else 0
            self.stream = (period, time.monotonic(), 0, True) if period else None
            return period.to_bytes(4, "little")
        if self.stream:
            raise Refused(bridge.BUSY, "a stream is running")
        moment = time.monotonic()
        return self.clock(moment) + self.word().to_bytes(8, "little")

    def word(self):
        """Returns the bits of an SSI burst: those of the frame, followed by zeros."""
        position = self.encoder.position()
        if self.options.line in ("open", "high") or position is None:
            return (1 << self.clocks) - 1
        if self.options.line == "low":
            return 0
        form = self.options.ssi
        self.words += 1
        # The last of the error bits is cleared by a transfer.
        error = self.options.ssi_error and self.words % self.options.ssi_error == 0
        frame = form.frame(position[0], position[1], 17, int(error))
        return frame << self.clocks - form.bits if self.clocks >= form.bits else frame >> form.bits - self.clocks

    def clock(self, moment):
        return int((moment - self.began) * 1e6).to_bytes(8, "little")

    def frame(self):
        """Returns status and bits of a position frame."""
        if self.options.line != "good":
            return {"open": (1, 0), "low": (2, 0), "high": (3, (1 << self.bits) - 1)}[self.options.line]
        position = None if self.encoder.supplied is False else self.encoder.position()
        if position is None:
            return 1, 0
        self.frames += 1
        raw = bridge.frame(*position)
        if self.options.damage and self.frames % self.options.damage == 0:
            raw ^= 1 << 20
        return 0, raw >> 41 - self.bits if self.bits < 41 else raw << self.bits - 41

    def due(self):
        return None if self.stream is None else 0.01

    def push(self):
        """Returns the frames that are due, at most as many as fit into a packet."""
        while self.stream:
            period, start, sent, is_ssi = self.stream
            count = min(int((time.monotonic() - start) * 1e6 / period) - sent, 60)
            if count <= 0:
                return
            if is_ssi:
                op, width = bridge.SSI_DATA, (self.clocks + 7) // 8
                values = b"".join(self.word().to_bytes(width, "little") for _ in range(count))
            else:
                op, width = bridge.BISS_DATA, 6
                values = b"".join(bytes([status]) + raw.to_bytes(6, "little")
                                  for status, raw in (self.frame() for _ in range(count)))
            body = (sent.to_bytes(4, "little") + self.clock(start + sent * period / 1e6) + period.to_bytes(4, "little")
                    + bytes(2) + bytes([width, count]) + values)
            self.send(bridge.emit(self.pushed, op, body))
            self.pushed = (self.pushed + 1) % 256
            self.stream = (period, start, sent + count, is_ssi)


def supplied(options):
    """Returns the encoder; with None the adapter does not control its supply."""
    encoder = kit.Kit(options)
    encoder.supplied = {None: None, "off": False, "on": True}[options.supply]
    return encoder


def serve_terminal(options):
    terminal = Terminal(options.stdin_eof)
    encoder = supplied(options)

    def run():
        adapter = Adapter(encoder, options, terminal.write)
        while True:
            data = terminal.read(adapter.due())
            if data is END:
                return
            if data is None:
                adapter = Adapter(encoder, options, terminal.write)
                terminal.hang_up()
            elif data:
                adapter.hear(data)
            adapter.push()

    terminal.serve(options.link, run)


def serve_port(options):
    encoder = supplied(options)
    server = socket.create_server(("127.0.0.1", 0))
    print("ready", f"127.0.0.1:{server.getsockname()[1]}", flush=True)
    client = adapter = None
    while True:
        watched = [client or server] + ([sys.stdin] if options.stdin_eof else [])
        ready, _, _ = select.select(watched, [], [], adapter.due() if adapter else None)
        if sys.stdin in ready:
            return
        if client is None:
            client, _ = server.accept()
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            adapter = Adapter(encoder, options, client.sendall)
            continue
        try:
            if ready:
                data = client.recv(4096)
                if not data:
                    raise ConnectionError
                adapter.hear(data)
            adapter.push()
        except OSError:
            client.close()
            client = adapter = None


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--link", help="be on a pseudo terminal, and make this symbolic link to it")
    add("--stdin-eof", action="store_true", help="end when stdin ends")
    add("--version", type=int, default=1)
    add("--capabilities", type=int, default=0b000110)
    add("--max-clock", type=int, default=5_000_000)
    add("--line", choices=["good", "open", "low", "high"], default="good")
    add("--ssi", type=ssi.Format, default="12,13,gray,0", help="the SSI encoder: bits of turns, of steps, code, error bits")
    add("--ssi-error", type=int, default=0, help="the last error bit speaks in every Nth word")
    add("--damage", type=int, help="one bit of every Nth frame is flipped")
    add("--silent", action="store_true", help="never answer")
    add("--supply", choices=["off", "on"], help="it switches the encoder's supply, which is like this at the start")
    kit.add_options(add)
    options = parser.parse_args()
    if options.link:
        serve_terminal(options)
    else:
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
        serve_port(options)


if __name__ == "__main__":
    main()
