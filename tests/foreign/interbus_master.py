#!/usr/bin/env python3
"""A master of a K3 encoder at a Modbus/TCP gateway: carries out its arguments one after the other and prints a line for
each.

Written from the project's reference of POSITAL's manual UME-IB only, with the Python standard library only.

  WORD          writes the OUT word and waits for its reply: the exact echo for a word that sets, the value of a
                read-out, a word without bit 31 for everything else; prints the IN word, or `IN late` with the last one
  in, out       prints the IN word (function 4), or the current OUT word (function 3)
  raw:HEX       sends a PDU and prints the reply's, or `exception 02`
  other:THING   one of these as another simultaneous client
"""

import argparse
import time

import modbus

PATIENCE, SETTLES = 2.0, 0.05


class Master:
    def __init__(self, options):
        self.options = options
        self.client = modbus.Client(options.place.removeprefix("tcp:"), options.unit)
        self.cams = options.cams

    def order(self, halves):
        return halves[::-1] if self.options.low_first else halves

    def word(self, function, base):
        high, low = self.order(self.client.read(function, base, 2))
        return high << 16 | low

    def read(self):
        return self.word(modbus.READ_INPUT, self.options.input)

    def write(self, word):
        self.client.write(self.options.output, self.order([word >> 16, word & 0xFFFF]))

    def belongs(self, out, word):
        """Returns whether the IN word is the expected one, or an error."""
        echo, runs = out | 0xC0000000, word >> 31 == 0
        if word >> 29 == 0b100 or word >> 24 == 0xA4:
            return True
        if out >> 16 == 0x2080:
            self.cams = out & 0xF != 0
            return word == echo or runs
        if out >> 16 in (0x2020, 0x2021):
            return word >> 24 in (0xA0, 0xA1)
        if out in (0x00000000, 0x80000000):
            return runs
        sets = self.cams or out >> 29 == 0
        return word == echo if sets else runs

    def carry_out(self, thing):
        if thing == "in":
            return f"{self.read():08X}"
        if thing == "out":
            return f"{self.word(modbus.READ_HOLDING, self.options.output):08X}"
        if thing.startswith("raw:"):
            pdu = bytes.fromhex(thing[4:])
            return (pdu[:1] + self.client.ask(pdu)).hex(" ").upper()
        out = int(thing, 16)
        before = self.read()
        self.write(out)
        last, since, reads, began = None, 0, 0, time.monotonic()
        while time.monotonic() - began < PATIENCE:
            word = self.read()
            reads += 1
            since = since + 1 if word == last else 0
            last = word
            # The reply to a word is stable for two cycles. The previous word, and a position, cannot be distinguished from
            # a new one, so that they are given time.
            told_apart = word >> 31 and word != before
            settled = since >= 1 if told_apart else reads > 8 and time.monotonic() - began > SETTLES
            if self.belongs(out, word) and settled:
                return f"{word:08X}"
        return f"{last:08X} late"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("place", help="HOST:PORT")
    add("things", nargs="+")
    add("--unit", type=int, default=1)
    add("--input", type=int, default=0)
    add("--output", type=int, default=0)
    add("--low-first", action="store_true")
    add("--cams", action="store_true", help="a cam program is selected")
    options = parser.parse_args()
    master, other = Master(options), None
    for thing in options.things:
        who = master
        if thing.startswith("other:"):
            other = other or Master(options)
            who, thing = other, thing[6:]
        try:
            print(who.carry_out(thing), flush=True)
        except modbus.Refused as refused:
            print(refused, flush=True)


if __name__ == "__main__":
    main()
