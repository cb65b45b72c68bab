#!/usr/bin/env python3
"""An adapter with a serial line and the bridge protocol on a TCP port, with a HIPERFACE encoder or the configuration pin
of a kit encoder at the line, for tests against a separate process with separate code.

Written from protocol/bridge.md only, with the Python standard library only; the encoders are in device.py and
ubicom_encoder.py. It prints one
line "ready ADDRESS" and serves one client after the other until SIGTERM (or the end of stdin, --stdin-eof).
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
import ubicom  # noqa: E402
import ubicom_encoder  # noqa: E402
from device import Encoder  # noqa: E402
from encoder import parse_options  # noqa: E402

UART, SWITCHED_SUPPLY = 1 << 4, 1 << 5


class Pin(ubicom_encoder.Line):
    """The configuration pin of a kit encoder: 115200 baud, no parity."""

    format = (115200, 0)

    def __init__(self):
        parser = argparse.ArgumentParser()
        kit.add_options(parser.add_argument)
        self.options = parser.parse_args([])
        self.options.order = "little"
        self.encoder = kit.Kit(self.options)

    def transact(self, request):
        frame, _ = ubicom.take(request)
        return None if frame is None else self.answer(frame[2], frame[5:-1])


class Hiperface(Encoder):
    """Factory settings: 9600 baud, even parity."""

    format = (9600, 2)

    def transact(self, request):
        return self.answer(request)


class Adapter:
    def __init__(self, encoder, options, send):
        self.encoder, self.options, self.send = encoder, options, send
        self.began = time.monotonic()
        self.heard = b""
        self.format = None
        self.transfers = 0
        self.lost_command = options.lose_command

    def hear(self, data):
        self.heard += data
        *packets, self.heard = self.heard.split(b"\x00")
        for stuffed in packets:
            packet = bridge.parse(stuffed) if stuffed else None
            if packet is not None:
                self.answer(*packet)

    def note(self, words):
        if self.options.log:
            with open(self.options.log, "a", encoding="ascii") as log:
                log.write(words + "\n")

    def answer(self, seq, op, body):
        number = self.transfers
        reply = self.carry_out(op, body)
        if op == bridge.UART_TRANSFER and number in self.options.lose:
            return
        if op == bridge.UART_TRANSFER and body[9] == self.lost_command:
            self.lost_command = None
            return
        if self.options.dead_from is not None and self.transfers > self.options.dead_from:
            return
        if isinstance(reply, int):
            self.send(bridge.emit(seq, bridge.ERROR, bytes([op, reply]) + bridge.text("no")))
        else:
            self.send(bridge.emit(seq, op | bridge.REPLY, reply))

    def carry_out(self, op, body):
        if op == bridge.HELLO:
            capabilities = UART if self.encoder.supplied is None else UART | SWITCHED_SUPPLY
            numbers = b"".join(number.to_bytes(4, "little") for number in (capabilities, 0, 0))
            return b"\x01" + numbers + b"".join(map(bridge.text, ["line adapter", "L3", "1.0"]))
        if op == bridge.SUPPLY and self.encoder.supplied is not None:
            on, millivolt = bool(body[0]), int.from_bytes(body[1:3], "little")
            self.note(f"S {millivolt}" if on else "S off")
            self.encoder.supplied = on
            return bytes([on]) + b"".join(n.to_bytes(2, "little") for n in ((millivolt, 60) if on else (0, 0)))
        if op == bridge.UART_CONFIG:
            self.format = int.from_bytes(body[0:4], "little"), body[4]
            self.note(f"F {self.format[0]} {self.format[1]}")
            return body[0:4]
        if op == bridge.UART_TRANSFER:
            if self.format is None:
                return bridge.BAD_ARGUMENT
            return self.transfer(int.from_bytes(body[0:4], "little"), int.from_bytes(body[4:8], "little"), body[8:])
        return bridge.NOT_SUPPORTED

    def transfer(self, timeout_us, idle_us, request):
        self.transfers += 1
        self.note(request.hex(" ").upper())
        character = 11 / self.format[0]
        time.sleep(character * len(request))
        is_heard = self.format == self.encoder.format and self.encoder.supplied is not False
        reply = self.encoder.transact(request) if is_heard else None
        if reply is None or self.options.delay > timeout_us / 1e6:
            time.sleep(timeout_us / 1e6)
            return self.clock()[:8]
        time.sleep(self.options.delay)
        started = self.clock()
        time.sleep(character * len(reply) + idle_us / 1e6)
        return started + reply

    def clock(self):
        return int((time.monotonic() - self.began) * 1e6).to_bytes(8, "little")


def more(add):
    add("--lose", type=lambda text: [int(part) for part in text.split(",")], default=[], metavar="N,…",
        help="the replies of these transfers (0 is the first) do not reach the host")
    add("--lose-command", type=lambda text: int(text, 16), metavar="HEX",
        help="the first reply to this command of the encoder does not reach the host")
    add("--pin", action="store_true", help="the configuration pin of a kit encoder is at the line")
    add("--dead-from", type=int, metavar="N", help="no reply after this number of transfers")
    add("--supply", choices=["off", "on"], help="it switches the encoder's supply, which is like this at the start")


def main():
    options = parse_options(__doc__, more)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    encoder = Pin() if options.pin else Hiperface(options)
    encoder.supplied = {None: None, "off": False, "on": True}[options.supply]
    server = socket.create_server(("127.0.0.1", 0))
    print("ready", f"127.0.0.1:{server.getsockname()[1]}", flush=True)
    client = adapter = None
    while True:
        watched = [client or server] + ([sys.stdin] if options.stdin_eof else [])
        ready, _, _ = select.select(watched, [], [])
        if sys.stdin in ready:
            return
        if client is None:
            client, _ = server.accept()
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            adapter = Adapter(encoder, options, client.sendall)
            continue
        try:
            data = client.recv(4096)
            if not data:
                raise ConnectionError
            adapter.hear(data)
        except OSError:
            client.close()
            client = adapter = None


if __name__ == "__main__":
    main()
