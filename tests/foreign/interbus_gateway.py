#!/usr/bin/env python3
"""A Modbus/TCP gateway with a K3 encoder (interbus.py), with faults on request.

Written from the project's references (protocol/interbus.md; the links of the command line) only, with the Python standard
library only. Several masters may be connected at once. The log has a line for each event: `W 020000FF` a new OUT word,
`R` an IN word read, `STORE parameters`, `STORE program 1`, `PRESET 100`.
"""

import argparse
import collections
import random
import select
import signal
import socket
import sys
import time

import interbus
import modbus


class Gateway:
    def __init__(self, options):
        self.options = options
        self.encoder = interbus.K3(options, self.note)
        self.random = random.Random(options.seed)
        self.requests = self.writes = 0
        # OUT as the gateway holds it, and the words that have not arrived at the encoder yet.
        self.out, self.coming = 0, collections.deque()
        self.cams_since = None

    def note(self, line):
        if self.options.log:
            with open(self.options.log, "a", encoding="ascii") as log:
                log.write(line + "\n")

    def halves(self, word):
        halves = [word >> 16, word & 0xFFFF]
        return halves[::-1] if self.options.order == "low-first" else halves

    def registers(self, function, first, count, values):
        base = self.options.input if function == modbus.READ_INPUT else self.options.output
        at = first - base
        if at < 0 or at + count > 2:
            raise modbus.Refused(modbus.ILLEGAL_ADDRESS)
        self.pass_on()
        if function == modbus.READ_INPUT:
            self.note("R")
            return self.halves(self.encoder.read())[at:at + count]
        if values is None:
            return self.halves(self.out)[at:at + count]
        out = self.halves(self.out)
        out[at:at + count] = values
        high, low = out[::-1] if self.options.order == "low-first" else out
        self.put(high << 16 | low)
        self.writes += 1
        if self.options.second_master and self.writes % self.options.second_master[1] == 0:
            self.put(self.options.second_master[0])
        return None

    def put(self, word):
        if word != self.out:
            self.note(f"W {word:08X}")
        if word >> 24 in (0x40, 0x42) and self.cams_since is None:
            self.cams_since = self.requests
        self.out = word
        self.coming.append((time.monotonic() + self.options.lag / 1000, word))
        self.pass_on()

    def pass_on(self):
        """Queues words: they arrive in their order, with a delay so that IN answers after the lag."""
        while self.coming and self.coming[0][0] <= time.monotonic():
            self.encoder.at, word = self.coming.popleft()
            self.encoder.write(word)
            self.encoder.at = None

    def answer(self, unit, pdu):
        if unit != self.options.unit:
            raise modbus.Refused(modbus.NO_ANSWER)
        if self.options.exception and self.requests % self.options.exception[1] == 0:
            raise modbus.Refused(self.options.exception[0])
        function, first, count, values = modbus.parse(pdu)
        registers = self.registers(function, first, count, values)
        if registers is None:
            return pdu[:5]
        return bytes([function, 2 * count]) + b"".join(register.to_bytes(2, "big") for register in registers)

    def take(self, transaction, unit, pdu):
        """Returns the bytes of the reply; None: the gateway disconnects."""
        self.requests += 1
        options = self.options
        if options.vanish_after is not None and self.requests > options.vanish_after:
            return None
        if options.vanish_writing is not None and self.cams_since is not None \
                and self.requests > self.cams_since + options.vanish_writing:
            return None
        if options.silent_after is not None and self.requests > options.silent_after:
            return b""
        try:
            reply = self.answer(unit, pdu)
        except modbus.Refused as refused:
            reply = bytes([pdu[0] | 0x80, refused.code])
        if options.garbage:
            return self.random.randbytes(13)
        reply = modbus.frame(transaction, unit, reply)
        if options.foreign_reply:
            reply = modbus.frame(transaction - 1 & 0xFFFF, unit, b"\x04\x04\x00\x00\x00\x01") + reply
        if options.cut and self.requests % options.cut == 0:
            reply = reply[:-2]
        if options.late and self.requests % options.late[1] == 0:
            time.sleep(options.late[0] / 1000)
        return reply


def serve(gateway, options):
    server = socket.create_server(("127.0.0.1", options.port))
    print("ready", f"127.0.0.1:{server.getsockname()[1]}", flush=True)
    buffers = {}
    while True:
        ready, _, _ = select.select([server, *buffers] + ([sys.stdin] if options.stdin_eof else []), [], [])
        if sys.stdin in ready:
            return
        for client in ready:
            if client is server:
                client, _ = server.accept()
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                buffers[client] = bytearray()
                continue
            try:
                data = client.recv(4096)
                buffers[client] += data
                while data and (request := modbus.take(buffers[client])) is not None:
                    reply = gateway.take(*request)
                    if reply is None:
                        return
                    for piece in [reply[at:at + 1] for at in range(len(reply))] if options.pieces else [reply]:
                        client.sendall(piece)
                closed = not data
            except (OSError, ValueError):
                closed = True
            if closed:
                client.close()
                del buffers[client]


def main():
    def number(text):
        return int(text, 0)

    def every(read):
        """Parses VALUE or VALUE:N, for every Nth time."""
        return lambda text: (read(text.partition(":")[0]), int(text.partition(":")[2] or 1))

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--stdin-eof", action="store_true", help="end when stdin ends")
    add("--port", type=int, default=0)
    add("--log", help="file to append what happens to")
    add("--unit", type=number, default=1)
    add("--input", type=number, default=0)
    add("--output", type=number, default=0)
    add("--order", choices=["high-first", "low-first"], default="high-first")
    add("--exception", type=every(number), help="CODE or CODE:N: every Nth request is refused with it")
    add("--second-master", type=every(lambda text: int(text, 16)), help="WORD or WORD:N: written behind every Nth word")
    add("--silent-after", type=int, help="requests after which nothing is answered")
    add("--vanish-after", type=int, help="requests after which the gateway is gone")
    add("--vanish-writing", type=int, help="requests after the first write of a cam after which the gateway is gone")
    add("--garbage", action="store_true", help="answer random bytes")
    add("--foreign-reply", action="store_true", help="the reply to another transaction before each reply")
    add("--cut", type=int, help="the end of every Nth reply is missing")
    add("--late", type=every(number), help="MS or MS:N: every Nth reply is that late")
    add("--lag", type=int, default=0, help="milliseconds from a word written to its effect on IN")
    add("--pieces", action="store_true", help="replies come byte by byte")
    add("--seed", type=int, default=1)
    interbus.add_options(add)
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    serve(Gateway(options), options)


if __name__ == "__main__":
    main()
