#!/usr/bin/env python3
"""A master of HIPERDRIVE drives over EtherNet/IP: carries out its arguments one after the other and prints a line for
each.

Written from the project's reference of the drive's manual and of the packets only, with the Python standard library only.

  get:N  set:N=V       a parameter by its number for `--drive` 1; set takes negative numbers too; a refusal is `status 09`
  raw:HEX              a CIP request; the reply in hex
  frame:COMMAND:HEX    an encapsulation frame in the session; the status of its reply, or `silence`
  identity, shout      the devices in the network, over TCP or UDP: vendor, code, serial number, name
  open  open:RPI:MULT  the cyclic connection, of RPI ms (default 10) and a time-out of RPI * 4 * 2**MULT (default 1)
  word:STW             this control word for five intervals; the status word
  until:MASK:VALUE     waits for this status word; the status word, or `late`
  move:TARGET          leads the drive to enabled and moves it there; the reached position
  begin:TARGET         the same, without waiting
  jog:MS               runs clockwise in speed mode for MS, stops, waits for the standstill: `moved` and `stands`, or an error
  hush                 sends nothing for the time-out and half a second; then whether the drive is at standstill
  flood:N              N datagrams of garbage, and half of N streams of it
  leave                closes the TCP connection and opens another, while cyclic data continue
  close, end           ForwardClose; UnRegisterSession
"""

import argparse
import random
import socket
import struct
import threading
import time

PATIENCE = 10.0
REGISTER, UNREGISTER, IDENTITY, RR_DATA = 0x65, 0x66, 0x63, 0x6F
SIGNED, TEXTS = (47, 106, 104, 107, 158, 160, 170, 176, 198), (13, 15, 16, 18, 19, *range(121, 130))
BYTES = (102, 103, 119, 152, 172, 174, 178, 180, 188, 197, 199)
LONG = (104, 107, 158, 160, 170, 176, 190, 198, *range(24, 43, 2))
OWNER = struct.pack("<HHI", 0x4321, 0x1234, 0x0000ABCD)
ASSEMBLIES = bytes.fromhex("20 04 24 68 2C 64 2C 65")
CONNECTION_MANAGER = bytes.fromhex("02 20 06 24 01")
ENABLED = (0x0000, 0x0400, 0x0401, 0x0409, 0x0439)


class Refused(Exception):
    """A refusal by the target."""


def frame(command, session, data=b"", context=b"python\0\0"):
    return struct.pack("<HHII8sI", command, len(data), session, 0, context, 0) + data


class Target:
    """A TCP connection with a session."""

    def __init__(self, place):
        host, port = place.rsplit(":", 1)
        self.address = (host, int(port))
        self.connect()

    def connect(self):
        self.tcp = socket.create_connection(self.address, timeout=PATIENCE)
        self.tcp.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.session = 0
        _, self.session, _ = self.ask(REGISTER, struct.pack("<HH", 1, 0))

    def take(self, count):
        data = b""
        while len(data) < count:
            more = self.tcp.recv(count - len(data))
            if not more:
                raise ConnectionError("the target has closed the connection")
            data += more
        return data

    def ask(self, command, data=b""):
        """Returns status, session and data of the reply."""
        self.tcp.sendall(frame(command, self.session, data))
        got, length, session, status, context, _ = struct.unpack("<HHII8sI", self.take(24))
        if (got, context) != (command, b"python\0\0"):
            raise ValueError(f"a reply to {got:02X} {context}")
        return status, session, self.take(length)

    def message(self, request, sockets=b""):
        """Sends a CIP request; returns its reply, and the items after it."""
        count = 2 + (1 if sockets else 0)
        data = struct.pack("<IHHHHHH", 0, 0, count, 0, 0, 0xB2, len(request)) + request + sockets
        status, _, reply = self.ask(RR_DATA, data)
        if status:
            raise Refused(f"frame {status:02X}")
        kind, length = struct.unpack("<HH", reply[12:16])
        assert kind == 0xB2, reply.hex(" ")
        return reply[16:16 + length], reply[16 + length:]

    def done(self, request, sockets=b""):
        """Returns the data of a successful reply, and the items after it."""
        reply, rest = self.message(request, sockets)
        assert reply[0] == request[0] | 0x80, reply.hex(" ")
        if reply[2]:
            words = struct.unpack(f"<{reply[3]}H", reply[4:4 + 2 * reply[3]])
            raise Refused(" ".join([f"status {reply[2]:02X}", *(f"{word:04X}" for word in words)]))
        return reply[4:], rest


class Cyclic(threading.Thread):
    """The cyclic connection: sends its set-point every interval and keeps the received data."""

    def __init__(self, target, options, rpi_ms, multiplier):
        super().__init__(daemon=True)
        self.target, self.place, self.rpi = target, options.drive - 1, rpi_ms / 1000
        self.timeout = self.rpi * 4 * 2**multiplier
        self.places = {0: 1, 4: 4, 8: 8}[options.hub]
        self.length = 8 * (self.places + (0 if options.without_words else 1))
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind((target.tcp.getsockname()[0], 0))
        self.udp.setblocking(False)
        self.out, self.status, self.position, self.newest = [0, 100, 100, 0], 0, 0, 0
        self.came, self.hushed, self.ended = 0, False, threading.Event()
        self.open(rpi_ms * 1000, multiplier)
        self.start()

    def open(self, rpi_us, multiplier):
        def parameters(size):
            return 0x4800 | size

        data = struct.pack("<BBII", 3, 250, 0, 0x00010001) + OWNER + bytes([multiplier, 0, 0, 0])
        data += struct.pack("<IHIHB", rpi_us, parameters(self.length + 6), rpi_us, parameters(self.length + 2), 1)
        data += bytes([len(ASSEMBLIES) // 2]) + ASSEMBLIES
        port = self.udp.getsockname()[1]
        wanted = struct.pack(">HH4s8s", 2, port, bytes(4), bytes(8))
        reply, rest = self.target.done(b"\x54" + CONNECTION_MANAGER + data, struct.pack("<HH", 0x8001, 16) + wanted)
        self.connection, back = struct.unpack("<II", reply[:8])
        assert back == 0x00010001 and reply[8:16] == OWNER, reply.hex(" ")
        self.port = self.target.address[1]
        if rest[:4] == struct.pack("<HH", 0x8000, 16):
            self.port = struct.unpack(">H", rest[6:8])[0]

    def run(self):
        due, sequence = time.monotonic(), 0
        while not self.ended.is_set():
            due += self.rpi
            time.sleep(max(0, due - time.monotonic()))
            self.receive()
            if not self.hushed:
                sequence += 1
                self.send(sequence)

    def send(self, sequence):
        own = struct.pack("<HBBi", *self.out)
        data = bytes(8 * self.place) + own
        data += bytes(self.length - len(data))
        connected = struct.pack("<HI", sequence & 0xFFFF, 1) + data
        packet = struct.pack("<HHHIIHH", 2, 0x8002, 8, self.connection, sequence, 0xB1, len(connected)) + connected
        self.udp.sendto(packet, (self.target.address[0], self.port))

    def receive(self):
        while True:
            try:
                packet, _ = self.udp.recvfrom(2048)
            except BlockingIOError:
                return
            items, kind, size, connection, sequence, data_kind, length = struct.unpack("<HHHIIHH", packet[:18])
            assert (items, kind, size, connection, data_kind) == (2, 0x8002, 8, 0x00010001, 0xB1), packet.hex(" ")
            assert length == self.length + 2 == len(packet) - 18, packet.hex(" ")
            assert sequence > self.newest, f"{sequence} behind {self.newest}"
            at = 20 + 8 * self.place
            self.newest, self.came = sequence, self.came + 1
            self.status, _, self.position = struct.unpack("<Hhi", packet[at:at + 8])

    def wait(self, condition):
        """Waits for at least five packets, so that the received ones are an answer to the sent ones."""
        begin, came = time.monotonic(), self.came
        while time.monotonic() - begin < PATIENCE:
            if self.came >= came + 5 and condition():
                return True
            time.sleep(self.rpi)
        return False

    def word(self, control):
        self.out[0] = control
        return self.wait(lambda: True)


class Master:
    def __init__(self, options):
        self.options, self.target, self.cyclic = options, Target(options.place), None

    def path(self, number):
        drive = self.options.drive - 1 if number >= 100 else 0
        return bytes([3, 0x20, 0x64 + number // 100 + drive, 0x24, 1, 0x30, number])

    def get(self, number):
        data, _ = self.target.done(b"\x0E" + self.path(number))
        if number in TEXTS:
            return data.decode("ascii")
        return int.from_bytes(data, "little", signed=number in SIGNED)

    def set(self, number, value):
        size = 1 if number in BYTES else 4 if number in LONG else 2
        self.target.done(b"\x10" + self.path(number) + value.to_bytes(size, "little", signed=value < 0))

    def identity(self, item):
        count, kind, _ = struct.unpack("<HHH", item[:6])
        assert (count, kind) == (1, 0x0C), item.hex(" ")
        vendor, _, code = struct.unpack("<HHH", item[24:30])
        serial, name = struct.unpack("<I", item[34:38])[0], item[39:39 + item[38]].decode("ascii")
        return f"{vendor} {code} {serial} {name}"

    def shout(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
            udp.settimeout(PATIENCE)
            udp.sendto(frame(IDENTITY, 0), self.target.address)
            return self.identity(udp.recv(2048)[24:])

    def begin(self, target):
        cyclic = self.cyclic
        for control in ENABLED:
            cyclic.word(control)
        # Bit 6 has to differ from bit 12 of the status word.
        cyclic.out[3] = target
        cyclic.word(0x0439 if cyclic.status & 0x1000 else 0x0479)

    def jog(self, milliseconds):
        cyclic = self.cyclic
        for control in ENABLED[:4] + (0x1419,):
            cyclic.word(control)
        began, cyclic.out[1] = cyclic.position, 25
        cyclic.out[0] = 0x1459
        time.sleep(milliseconds / 1000)
        cyclic.out[0] = 0x1419
        stands = cyclic.wait(lambda: cyclic.status & 0x2000)
        moved = cyclic.position > began
        # From speed mode through "ready", so that no old target is a new job; then nothing moves.
        cyclic.word(0x0400)
        where, cyclic.out[1] = cyclic.position, 100
        for control in ENABLED[2:]:
            cyclic.word(control)
        rests = cyclic.position == where
        return " ".join([["still", "moved"][moved], ["runs", "stands"][bool(stands)], ["moves", "rests"][rests]])

    def hush(self):
        cyclic = self.cyclic
        moving = cyclic.status & 0x2000 == 0
        cyclic.hushed = True
        time.sleep(cyclic.timeout + 0.5)
        positions = [self.get(107)]
        time.sleep(0.3)
        positions.append(self.get(107))
        came = cyclic.came
        time.sleep(0.1)
        still = positions[0] == positions[1]
        return " ".join([["stood", "moved"][moving], ["moves", "stands"][still], ["sends", "silent"][cyclic.came == came]])

    def flood(self, count):
        noise = random.Random(1)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
            for at in range(count):
                start = struct.pack("<HHHI", 2, 0x8002, 8, 0x00020001) if at % 3 == 0 else b""
                udp.sendto(start + noise.randbytes(noise.randrange(200)), self.target.address)
        for _ in range(count // 2):
            with socket.create_connection(self.target.address, timeout=PATIENCE) as tcp:
                tcp.sendall(noise.randbytes(noise.randrange(1, 400)))

    def carry_out(self, thing):
        name, _, value = thing.partition(":")
        cyclic = self.cyclic
        match name:
            case "get":
                return self.get(int(value))
            case "set":
                number, _, value = value.partition("=")
                return self.set(int(number), int(value))
            case "raw":
                return self.target.message(bytes.fromhex(value))[0].hex(" ").upper()
            case "frame":
                command, _, data = value.partition(":")
                self.target.tcp.settimeout(0.5)
                try:
                    status, _, _ = self.target.ask(int(command, 16), bytes.fromhex(data))
                    return f"{status:02X}"
                except TimeoutError:
                    return "silence"
                finally:
                    self.target.tcp.settimeout(PATIENCE)
            case "identity":
                return self.identity(self.target.ask(IDENTITY)[2])
            case "shout":
                return self.shout()
            case "open":
                rpi, _, multiplier = (value or "10:1").partition(":")
                self.cyclic = Cyclic(self.target, self.options, int(rpi), int(multiplier))
                return f"{self.cyclic.connection:08X}"
            case "word":
                return f"{cyclic.status:04X}" if cyclic.word(int(value, 16)) else "late"
            case "until":
                mask, _, wanted = value.partition(":")
                mask, wanted = int(mask, 16), int(wanted, 16)
                reached = cyclic.wait(lambda: cyclic.status & mask == wanted)
                return f"{cyclic.status:04X}" if reached else f"{cyclic.status:04X} late"
            case "move":
                self.begin(int(value))
                reached = cyclic.wait(lambda: cyclic.status & 0x2400 == 0x2400)
                return f"{cyclic.position}" if reached else f"{cyclic.position} late"
            case "begin":
                return self.begin(int(value))
            case "jog":
                return self.jog(int(value))
            case "hush":
                return self.hush()
            case "flood":
                return self.flood(int(value))
            case "leave":
                self.target.tcp.close()
                return self.target.connect()
            case "close":
                cyclic.ended.set()
                cyclic.join()
                path = bytes([len(ASSEMBLIES) // 2, 0]) + ASSEMBLIES
                reply, _ = self.target.done(b"\x4E" + CONNECTION_MANAGER + b"\x03\xFA" + OWNER + path)
                assert reply[:8] == OWNER, reply.hex(" ")
            case "end":
                self.target.tcp.sendall(frame(UNREGISTER, self.target.session))
                return "closed" if self.target.tcp.recv(1) == b"" else "open"
            case _:
                raise ValueError(thing)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("place", help="HOST:PORT")
    add("things", nargs="+")
    add("--hub", type=int, default=0, choices=(4, 8))
    add("--drive", type=int, default=1)
    add("--without-words", action="store_true", help="no parameter words in the process data")
    options = parser.parse_args()
    master = Master(options)
    for thing in options.things:
        try:
            done = master.carry_out(thing)
            print("done" if done is None else done, flush=True)
        except Refused as refused:
            print(refused, flush=True)


if __name__ == "__main__":
    main()
