#!/usr/bin/env python3
"""A host of the bridge protocol: carries out its arguments and prints a line of JSON for each.

Written from protocol/bridge.md, biss.md and ssi.md only, with the Python standard library only, so that it can check the
program's virtual adapter.

  bridge_host.py tcp:127.0.0.1:4000 hello config:2000000:35:6:18 frame reg:66 reg:40=02 reg:05 stream:50:1.0

  hello                       config:CLOCK_HZ:DATA_BITS:CRC_BITS:TIMEOUT_US      frame     one position frame
  reg:HEX[=HEX]               read or write a register                          wait:S    waits
  stream:PERIOD_US:SECONDS    counts frames, gaps, wrong CRCs                   raw:HEX   bytes unchanged
  ssi:CLOCKS:CLOCK_HZ:PAUSE_US                                                  word      one SSI word
  words:PERIOD_US:SECONDS:FORMAT    counts words and gaps, and how far the position moves from one to the next; FORMAT is
                                    that of ssi.py: bits of turns, of steps, code, error bits

Every argument except stream, words and raw waits for one reply, at most half a second.
"""

import argparse
import json
import sys
import time

sys.dont_write_bytecode = True  # the tests leave nothing behind

import bridge  # noqa: E402
import ssi  # noqa: E402
from wire import Wire  # noqa: E402


class Host:
    def __init__(self, path):
        self.wire = Wire(path, 115200, "none")
        self.seq, self.heard, self.stream = 0, b"", []
        self.clocks = 0
        self.wire.send(b"\x00")  # what stood before is nobody's

    def ask(self, op, body=b""):
        """Returns the reply's operation and body; None without a reply."""
        self.seq = (self.seq + 1) % 256
        self.wire.send(bridge.emit(self.seq, op, body))
        deadline, answer = time.monotonic() + 0.5, None
        while answer is None and time.monotonic() < deadline:
            for packet in self.receive(deadline - time.monotonic()):
                if packet is None or packet[1] in (bridge.SSI_DATA, bridge.BISS_DATA):
                    self.stream.append(packet)
                elif packet[0] == self.seq:
                    answer = packet[1:]
        return answer

    def receive(self, seconds):
        self.heard += self.wire.receive(seconds) or b""
        *packets, self.heard = self.heard.split(b"\x00")
        return [bridge.parse(packet) for packet in packets if packet]

    def reply(self, op, body=b""):
        answer = self.ask(op, body)
        if answer is None:
            return None, {"error": "no answer"}
        if answer[0] == bridge.ERROR:
            return None, {"op": answer[1][0], "error": answer[1][1], "text": answer[1][3:].decode()}
        if answer[0] != op | bridge.REPLY:
            return None, {"error": f"reply {answer[0]:02X}"}
        return answer[1], {}

    def carry_out(self, word):
        what, *numbers = word.split(":")
        if what == "hello":
            body, told = self.reply(bridge.HELLO)
            return told or hello(body)
        if what == "config":
            clock, data_bits, crc_bits, timeout = (int(number) for number in numbers)
            request = clock.to_bytes(4, "little") + bytes([data_bits, crc_bits]) + timeout.to_bytes(2, "little")
            body, told = self.reply(bridge.BISS_CONFIG, request)
            return told or {"clock_hz": int.from_bytes(body, "little")}
        if what == "frame":
            body, told = self.reply(bridge.BISS_READ)
            return told or {"t_us": int.from_bytes(body[:8], "little"), "status": body[8],
                            "raw": f"{int.from_bytes(body[9:], 'little'):011X}"}
        if what == "reg":
            address, _, value = numbers[0].partition("=")
            op = bridge.REG_WRITE if value else bridge.REG_READ
            body, told = self.reply(op, bytes([0]) + bytes.fromhex(address) + bytes.fromhex(value))
            return told or {"value": body[0]}
        if what == "stream":
            return self.count(bridge.BISS_STREAM, int(numbers[0]), float(numbers[1]), examine)
        if what == "ssi":
            self.clocks, clock, pause = (int(number) for number in numbers)
            request = bytes([self.clocks]) + clock.to_bytes(4, "little") + pause.to_bytes(2, "little") + b"\x01"
            body, told = self.reply(bridge.SSI_CONFIG, request)
            return told or {"clock_hz": int.from_bytes(body, "little")}
        if what == "word":
            body, told = self.reply(bridge.SSI_READ)
            return told or {"t_us": int.from_bytes(body[:8], "little"), "raw": f"{int.from_bytes(body[8:], 'little'):X}"}
        if what == "words":
            form = ssi.Format(numbers[2])
            return self.count(bridge.SSI_STREAM, int(numbers[0]), float(numbers[1]),
                              lambda packets, period: examine_words(packets, period, form, self.clocks))
        if what == "raw":
            self.wire.send(bytes.fromhex(numbers[0]))
            return {}
        time.sleep(float(numbers[0]))
        return {}

    def count(self, op, period, seconds, examine):
        """Starts a stream, reads it and ends it; everything is checked afterwards."""
        self.stream = []
        body, told = self.reply(op, period.to_bytes(4, "little"))
        if told:
            return told
        actual = int.from_bytes(body, "little")
        end = time.monotonic() + seconds
        portions = []
        while time.monotonic() < end:
            portions.append(self.wire.receive(end - time.monotonic()) or b"")
        self.heard += b"".join(portions)
        *packets, self.heard = self.heard.split(b"\x00")
        packets = self.stream + [bridge.parse(packet) for packet in packets if packet]
        self.stream = []
        ended = self.ask(op, bytes(4)) is not None
        packets += self.stream
        silent = self.wire.receive(0.3) in (b"", None)
        return {"period_us": actual, "ended": ended and silent, **examine(packets, actual)}


def hello(body):
    words, rest = [], body[13:]
    while rest:
        words.append(rest[1:1 + rest[0]].decode())
        rest = rest[1 + rest[0]:]
    numbers = [int.from_bytes(body[at:at + 4], "little") for at in (1, 5, 9)]
    return {"version": body[0], "capabilities": numbers[0], "max_clock_hz": numbers[1], "max_sample_hz": numbers[2],
            "name": words[0], "serial": words[1], "firmware": words[2]}


def examine_words(packets, period, form, clocks):
    broken = gaps = lost = late = 0
    number, seq, start = 0, None, None
    words = []
    for packet in packets:
        if packet is None:
            broken += 1
            continue
        own, op, body = packet
        if op != bridge.SSI_DATA:
            continue
        gaps += seq is not None and own != (seq + 1) % 256
        seq = own
        first, t0 = int.from_bytes(body[0:4], "little"), int.from_bytes(body[4:12], "little")
        missing, width, count = int.from_bytes(body[16:18], "little"), body[18], body[19]
        gaps += first != number or len(body) != 20 + count * width
        number = first + count
        start = t0 if start is None else start
        late += t0 != start + first * period
        lost += missing
        words += [int.from_bytes(body[at:at + width], "little") for at in range(20, 20 + count * width, width)]
    told = [form.read(word, clocks) for word in words]
    positions = 1 << form.multiturn + form.singleturn
    moves = [(after[0] - before[0]) % positions for before, after in zip(told, told[1:])]
    return {"words": len(words), "broken": broken, "gaps": gaps, "lost": lost, "off_time": late,
            "with_errors": sum(errors != 0 for _, errors in told),
            "least_move": min(moves, default=None), "greatest_move": max(moves, default=None)}


def examine(packets, period):
    frames = broken = gaps = lost = wrong = bad_status = late = 0
    number, seq, start = 0, None, None
    positions = []
    for packet in packets:
        if packet is None:
            broken += 1
            continue
        own, op, body = packet
        if op != bridge.BISS_DATA:
            continue
        gaps += seq is not None and own != (seq + 1) % 256
        seq = own
        first, t0 = int.from_bytes(body[0:4], "little"), int.from_bytes(body[4:12], "little")
        missing, width, count = int.from_bytes(body[16:18], "little"), body[18], body[19]
        gaps += first != number
        number = first + count
        start = t0 if start is None else start
        late += t0 != start + first * period
        lost += missing
        for at in range(20, 20 + count * (width + 1), width + 1):
            raw = int.from_bytes(body[at + 1:at + 1 + width], "little")
            bad_status += body[at] != 0
            positions.append(raw)
        frames += count
    for raw in positions[::101]:
        wrong += bridge.crc6(raw >> 6, 35) != raw & 0x3F
    steps = [raw >> 8 for raw in positions[:1] + positions[-1:]]
    return {"frames": frames, "broken": broken, "gaps": gaps, "lost": lost, "wrong_crc": wrong,
            "bad_status": bad_status, "off_time": late, "first_steps": steps[0] if steps else None,
            "last_steps": steps[-1] if steps else None}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("path", help="a serial device, a pty, or tcp:HOST:PORT")
    parser.add_argument("actions", nargs="+")
    options = parser.parse_args()
    host = Host(options.path)
    for word in options.actions:
        print(json.dumps(host.carry_out(word)), flush=True)


if __name__ == "__main__":
    main()
