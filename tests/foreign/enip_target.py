#!/usr/bin/env python3
"""An EtherNet/IP target with HIPERDRIVE parameters in a dictionary, with faults on request.

Written from the project's reference (protocol/hiperdrive.md) and the manual's table (6.2) only, with the Python standard
library only. Explicit messages over TCP, ListIdentity and cyclic data over UDP at the same port. Its drives reach their
targets at once. The log has a line for each event: `SET 158 -65536`, `STORE`, `RESET`, `NETWORK 3`, `OPEN 16`, `STW 1
0479`, `CLOSE`, `LOST`.
"""

import argparse
import contextlib
import select
import signal
import socket
import struct
import sys
import time

import cip

# Number of drive 1: (type, first value, written, saved, least, most), or one of a list for the last two. Section 4; types are the
# manual's (6.2).
U8, I8, U16, I16, U32, I32, TEXT = "B", "b", "H", "h", "I", "i", "s"
DEVICE = {
    9: (U16, 241), 11: (I16, 29), 12: (U16, 0), 13: (TEXT, ""), 15: (TEXT, "POSITIONER"), 16: (TEXT, "7800.1234"),
    17: (U16, 0), 18: (TEXT, "07/2023"), 19: (TEXT, "2.10"), 47: (I16, 0, True, False, (-4, -3, -2, -1, 1)),
    **{number: (U32, 0, True, True, 0, 0xFFFFFFFF) for number in range(24, 43, 2)},
}
LEAST, MOST = -2**31, 2**31 - 1
DRIVE = {
    101: (U16, 0, True, False, 0, 0xFFFF), 102: (U8, 100, True, False, 1, 100), 103: (U8, 100, True, False, 1, 100),
    104: (I32, 0, True, False, LEAST, MOST), 105: (U16, 0x2A30), 106: (I16, 0), 107: (I32, 0),
    **{number: (U16, 0) for number in range(108, 119)}, 119: (I8, 33), 120: (U16, 7),
    121: (TEXT, "HDA30A"), 122: (TEXT, "7800.0077"), 123: (TEXT, "90817"), 124: (TEXT, "08/2023"), 125: (TEXT, "1.11"),
    126: (TEXT, "24"), 127: (TEXT, "A25"), 128: (TEXT, "A20"), 129: (TEXT, "35"),
    152: (U8, 1, True, True, 0, 1), 154: (U16, 256, True, True, 1, 65535), 156: (U16, 1, True, True, 1, 65535),
    158: (I32, -511 * 65536, True, True, LEAST, MOST), 160: (I32, 511 * 65536, True, True, LEAST, MOST),
    162: (U16, 10, True, True, 1, 65535), 164: (U16, 1, True, True, 1, 65535), 166: (U16, 350, True, True, 5, 350),
    170: (I32, 4096, True, False, LEAST, MOST), 172: (U8, 100, True, False, 1, 100), 174: (U8, 100, True, False, 1, 100),
    176: (I32, -4096, True, False, LEAST, MOST), 178: (U8, 100, True, False, 1, 100), 180: (U8, 100, True, False, 1, 100),
    182: (U16, 1000, True, False, 100, 10000), 186: (U16, 20, True, True, (*range(1, 101), 255)), 188: (U8, 1, True, True, 0, 253),
    190: (U32, 38400, True, True, (9600, 19200, 38400)), 192: (U16, 50, True, True, 0, 65535), 197: (U8, 0, True, False, 0, 0),
    198: (I32, 0, True, True, LEAST, MOST), 199: (U8, 0, True, False, 0, 1),
}
# Turns either way (section 5), of variants 1 to 12 and of 13; a step of the keys is no longer than both directions
# together.
TURNS = {**{variant: 512 for variant in range(1, 13)}, 13: 16000}
REACH = {158: 1, 160: 1, 198: 1, 170: 2, 176: 2}
NUMBERS = {1: {True: I8, False: U8}, 2: {True: I16, False: U16}, 4: {True: I32, False: U32}}
CATEGORIES = {"adapter": ("HIPERDRIVE SINGLE", 1), "hub4": ("HIPERDRIVE HUB-4", 4), "hub8": ("HIPERDRIVE HUB-8", 8)}


class Station:
    def __init__(self, options):
        self.options = options
        category, self.places = CATEGORIES[options.topology]
        self.plugged = options.drives or list(range(1, self.places + 1))
        self.values = {number: row[1] for number, row in DEVICE.items()}
        self.values.update({13: category, 17: options.serial})
        for drive in self.plugged:
            self.values.update({number + 100 * (drive - 1): row[1] for number, row in DRIVE.items()})
            self.values[107 + 100 * (drive - 1)] = options.position
            self.values[105 + 100 * (drive - 1)] = options.status
        self.busy_until = 0.0
        self.network = {3: struct.pack("<I", 2), 5: struct.pack("<IIIIIH", 0xC0A80107, 0xFFFFFF00, 0, 0, 0, 0)}
        self.acknowledged = {}
        self.requested, self.answered, self.answers = bytes(8), bytes(8), []
        self.answers_after = 0.0

    def note(self, line):
        if self.options.log:
            with open(self.options.log, "a", encoding="ascii") as log:
                log.write(line + "\n")

    def row(self, number):
        drive, base = number // 100, number if number < 100 else 100 + number % 100
        row = (DEVICE if drive == 0 else DRIVE).get(base)
        if row is None:
            raise cip.Refused(cip.NO_ATTRIBUTE)
        if drive > self.places:
            raise cip.Refused(cip.PATH_UNKNOWN)
        return drive, base, row

    def kind(self, number, row):
        """Returns the value as read: with the length of the manual, unless another one is requested."""
        length = self.options.lengths.get(number)
        return NUMBERS[length][row[0].islower()] if length else row[0]

    def read(self, number):
        drive, base, row = self.row(number)
        if number in self.options.refuse:
            raise cip.Refused(self.options.refuse[number])
        if drive and drive not in self.plugged:
            if base in (120, 152):
                return struct.pack("<" + row[0], 0)
            raise cip.Refused(cip.STATE)
        value = int(time.monotonic() < self.busy_until) if number == 47 else self.values[number]
        if row[0] != TEXT:
            kind = self.kind(number, row)
            if kind == row[0]:
                return struct.pack("<" + kind, value)
            return value.to_bytes(8, "little", signed=value < 0)[:struct.calcsize("<" + kind)]
        text = value.encode("ascii")
        return bytes([len(text)]) + text if self.options.counted else text

    def write(self, number, data):
        drive, base, row = self.row(number)
        if len(row) == 2:
            raise cip.Refused(cip.NOT_SETTABLE)
        if drive and drive not in self.plugged or time.monotonic() < self.busy_until:
            raise cip.Refused(cip.STATE)
        kind = row[0]
        if len(data) != struct.calcsize("<" + kind):
            raise cip.Refused(cip.TOO_SHORT if len(data) < struct.calcsize("<" + kind) else cip.TOO_LONG)
        (value,) = struct.unpack("<" + kind, data)
        reach = self.reach(drive, base)
        place = {158: (-reach, min(reach, self.of(drive, 160) - 1)), 160: (max(-reach, self.of(drive, 158) + 1), reach),
                 198: (self.of(drive, 158), self.of(drive, 160))} if drive else {}
        allowed = place.get(base, row[4:])
        inside = value in allowed[0] if len(allowed) == 1 else allowed[0] <= value <= allowed[1]
        inside = inside and abs(value) <= reach
        if base in (158, 160) and inside:
            position = self.of(drive, 107)
            inside = value <= position if base == 158 else value >= position
        if not inside:
            raise cip.Refused(cip.INVALID)
        self.note(f"SET {number} {value}")
        self.answers_after = self.options.slow.get((number, value), 0) / 1000
        if number == 47:
            self.save(value)
        elif base == 198:
            self.values[number] = self.values[number - 91] = (value + 32) // 64 * 64
        elif base != 199:
            self.values[number] = value

    def reach(self, drive, base):
        """Returns the most steps either way for a parameter that the turns limit; for another the range of its type."""
        if base not in REACH:
            return 2**32
        turns = REACH[base] * TURNS[self.of(drive, 120)]
        return min(MOST, turns * 256 * self.of(drive, 154) // self.of(drive, 156))

    def of(self, drive, base):
        return self.values[base + 100 * (drive - 1)]

    def save(self, value):
        if value in (1, -3):
            self.note("STORE")
        if value == -4:
            self.note("RESET")
            self.plugged = [drive for drive in self.plugged if drive != self.options.gone_after_reset]
        self.busy_until = time.monotonic() + self.options.busy / 1000

    def obey(self, drive, word, target):
        """Handles process data: commanded values are reached at once."""
        self.note_word(drive, word)
        self.values[101 + 100 * (drive - 1)] = word
        status = 0x0A30 | 0x2000
        status |= bool(word & 0x0400) | (word & 1) << 1 | (word & 8) >> 1
        seen = self.acknowledged.get(drive, 0)
        toggle = word >> 6 & 1
        if word & 0x0439 == 0x0439 and toggle != seen:
            self.values[107 + 100 * (drive - 1)] = target
            self.acknowledged[drive] = seen = toggle
        if word & 9 != 9:
            self.acknowledged[drive] = seen = 0
        status |= seen << 12
        self.values[105 + 100 * (drive - 1)] = status

    def note_word(self, drive, word):
        if self.values[101 + 100 * (drive - 1)] != word:
            self.note(f"STW {drive} {word:04X}")

    def image(self, with_words):
        image = b""
        for drive in range(1, self.places + 1):
            if drive in self.plugged:
                actual = (self.of(drive, 105), 0, self.of(drive, 107))
                image += struct.pack(self.options.struct + "Hhi", *actual)
            else:
                image += bytes(8)
        return image + (self.words() if with_words else b"")

    def request_words(self, request):
        """Section 6: the words of a packet; a request counts once, however often it is repeated."""
        if request != self.requested and self.options.words is not None:
            self.requested = request
            self.answers.append((time.monotonic() + self.options.words / 1e3, self.answer(request)))

    def words(self):
        while self.answers and self.answers[0][0] <= time.monotonic():
            self.answered = self.answers.pop(0)[1]
        return self.answered

    def answer(self, request):
        key, index, _value = struct.unpack(self.options.struct + "HHI", request)
        task, number = key >> 12, key & 0x07FF
        if task == 0:
            return bytes(8)
        self.note(f"WORDS {task} {number}")
        code, value = 7, 0
        with contextlib.suppress(cip.Refused):
            kind = self.kind(number, self.row(number)[2])
            if task == 1 and kind != TEXT:
                wide = struct.calcsize("<" + kind) == 4
                code, value = (2, 0xFFFFFFFF) if wide else (1, 0xFFFF)
                value &= self.values[number]
        return struct.pack(self.options.struct + "HHI", code << 12 | number, index, value)


class Target:
    def __init__(self, options, udp, port):
        self.options, self.udp, self.port = options, udp, port
        self.station = Station(options)
        self.sessions, self.requests, self.sets = set(), 0, 0
        self.connection = None

    def product(self):
        name = self.options.product
        return cip.identity(1010 if name.startswith("HIPERDRIVE") else 7, 44, 0x10000 + self.options.serial, name)

    def list_identity(self, context):
        item = struct.pack("<H", 1) + cip.socket_address(self.port, "127.0.0.1") + self.product() + b"\x03"
        return cip.frame(cip.LIST_IDENTITY, 0, context, cip.items((0x0C, item)))

    def take(self, frame, peer):
        """Returns the bytes of the reply; None: the target disconnects."""
        command, session, context, data = frame
        if command == cip.LIST_IDENTITY:
            return self.list_identity(context)
        if command == cip.REGISTER:
            number = 0x1000 + len(self.sessions)
            self.sessions.add(number)
            return cip.frame(command, number, context, struct.pack("<HH", 1, 0))
        if command == cip.UNREGISTER:
            return b""
        options = self.options
        self.requests += 1
        if options.vanish_after is not None and self.requests > options.vanish_after:
            return None
        if options.silent_after is not None and self.requests > options.silent_after:
            return b""
        if options.forget and self.requests % options.forget == 0:
            self.sessions.clear()
        if session not in self.sessions:
            return cip.frame(command, session, context, status=0x64)
        listed = cip.parse_items(data[6:])
        service, path, body = cip.parse_request(listed[0xB2])
        beside = []
        try:
            message, beside = self.message(service, path, body, listed, peer)
        except cip.Refused as refused:
            message = cip.reply(service, b"", refused.status, refused.extended)
        if service == cip.SET:
            self.sets += 1
            if self.sets == options.lose_set:
                return b""
        if options.garbage:
            return bytes(range(200, 250))
        answer = struct.pack("<IH", 0, 0) + cip.items((0, b""), (0xB2, message), *beside)
        answer = cip.frame(command, session, context, answer)
        if options.stale:
            other = struct.pack("<IH", 0, 0) + cip.items((0, b""), (0xB2, cip.reply(service, b"\x01\x02")))
            answer = cip.frame(command, session, b"othermsg", other) + answer
        if options.cut and self.requests % options.cut == 0:
            answer = answer[:-2]
        return answer

    def message(self, service, path, data, listed, peer):
        kind, attribute = path.get("class"), path.get("attribute")
        if service == cip.FORWARD_OPEN:
            return self.open(data, listed, peer)
        if service == cip.FORWARD_CLOSE:
            if self.connection is None:
                raise cip.Refused(cip.CONNECTION, 0x0107)
            self.station.note("CLOSE")
            self.connection = None
            return cip.reply(service, data[2:10] + b"\0\0"), []
        if kind == 1 and service == cip.GET_ALL:
            return cip.reply(service, self.product()), []
        if kind == 0xF6 and attribute == 3 and service == cip.GET:
            return cip.reply(service, bytes.fromhex("0050C2112233")), []
        if kind == 0xF5 and attribute in self.station.network:
            if service == cip.SET:
                self.station.note(f"NETWORK {attribute}")
                self.station.network[attribute] = data
                return cip.reply(service), []
            return cip.reply(service, self.station.network[attribute]), []
        if kind is None or not 0x64 <= kind <= 0x6C or not self.options.product.startswith("HIPERDRIVE"):
            raise cip.Refused(cip.PATH_UNKNOWN)
        number = attribute if kind == 0x64 else attribute + 100 * (kind - 0x65)
        if service == cip.GET:
            return cip.reply(service, self.station.read(number)), []
        if service == cip.SET:
            self.station.write(number, data)
            return cip.reply(service), []
        raise cip.Refused(cip.NO_SERVICE)

    def open(self, data, listed, peer):
        fields = struct.unpack_from("<BBIIHHIB3xIHIHB", data)
        _tick, _ticks, _to, back, serial, vendor, originator, multiplier, to_rpi, to_word, back_rpi, back_word, _ = fields
        if self.options.owned or self.connection:
            raise cip.Refused(cip.CONNECTION, 0x0106 if self.options.owned else 0x0100)
        if self.options.multicast_only and back_word >> 13 & 3 != 1:
            raise cip.Refused(cip.CONNECTION, 0x0108)
        length = 8 * self.station.places + (0 if self.options.no_words else 8)
        if (to_word & 0x1FF, back_word & 0x1FF) != (length + 6, length + 2):
            raise cip.Refused(cip.CONNECTION, 0x0127)
        port = struct.unpack_from(">H", listed[0x8001], 2)[0]
        self.connection = {
            "id": 0x00020001, "back": back, "to": (peer, port), "interval": back_rpi / 1e6, "sequence": 0,
            "next": time.monotonic() + back_rpi / 1e6, "words": not self.options.no_words,
            "watchdog": to_rpi / 1e6 * 4 * 2**multiplier, "heard": time.monotonic(),
        }
        self.station.note(f"OPEN {length}")
        head = struct.pack("<IIHHIIIBB", 0x00020001, back, serial, vendor, originator, to_rpi, back_rpi, 0, 0)
        return cip.reply(cip.FORWARD_OPEN, head), [(0x8000, cip.socket_address(self.port))]

    def datagram(self, packet, sender):
        if packet[:2] == struct.pack("<H", cip.LIST_IDENTITY) and len(packet) >= cip.HEADER.size:
            self.udp.sendto(self.list_identity(packet[12:20]), sender)
            return
        try:
            listed = cip.parse_items(packet)
            number, _sequence = struct.unpack("<II", listed[0x8002])
            data = listed[0xB1][6:]
        except (struct.error, KeyError):
            return
        if self.connection is None or number != self.connection["id"]:
            return
        self.connection["heard"] = time.monotonic()
        for drive in self.station.plugged:
            word, _speed, _torque, target = struct.unpack_from(self.options.struct + "HBBi", data, 8 * (drive - 1))
            self.station.obey(drive, word, target)
        if self.connection["words"]:
            self.station.request_words(data[8 * self.station.places:][:8])

    def tick(self):
        connection, now = self.connection, time.monotonic()
        if connection is None:
            return None
        if now - connection["heard"] > connection["watchdog"]:
            self.station.note("LOST")
            self.connection = None
            return None
        if now >= connection["next"]:
            connection["next"] += connection["interval"]
            connection["sequence"] += 1
            address = struct.pack("<II", connection["back"], connection["sequence"])
            count = struct.pack("<H", connection["sequence"] & 0xFFFF)
            image = self.station.image(connection["words"])
            self.udp.sendto(cip.items((0x8002, address), (0xB1, count + image)), connection["to"])
        return max(0.0, connection["next"] - time.monotonic())


def serve(options):
    server = socket.create_server(("127.0.0.1", options.port))
    port = server.getsockname()[1]
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.bind(("127.0.0.1", port))
    target = Target(options, udp, port)
    print("ready", f"127.0.0.1:{port}", flush=True)
    buffers, peers, waiting = {}, {}, []
    while True:
        wait = target.tick()
        now = time.monotonic()
        for due, client, answer in [own for own in waiting if own[0] <= now]:
            waiting.remove((due, client, answer))
            with contextlib.suppress(OSError):
                client.sendall(answer)
        waits = [due - now for due, _, _ in waiting] + ([] if wait is None else [wait])
        wait = max(0.0, min(waits)) if waits else None
        ready, _, _ = select.select([server, udp, *buffers] + ([sys.stdin] if options.stdin_eof else []), [], [], wait)
        if sys.stdin in ready:
            return
        for client in ready:
            if client is server:
                client, (peer, _) = server.accept()
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                buffers[client], peers[client] = bytearray(), peer
                continue
            if client is udp:
                target.datagram(*udp.recvfrom(2048))
                continue
            try:
                data = client.recv(4096)
                buffers[client] += data
                while data and (frame := cip.take(buffers[client])) is not None:
                    answer = target.take(frame, peers[client])
                    if answer is None:
                        return
                    if target.station.answers_after:
                        # Requests that arrive meanwhile are answered meanwhile.
                        waiting.append((time.monotonic() + target.station.answers_after, client, answer))
                        target.station.answers_after = 0.0
                        continue
                    if options.late and target.requests % options.late[1] == 0:
                        time.sleep(options.late[0] / 1000)
                    for piece in [answer[at:at + 1] for at in range(len(answer))] if options.pieces else [answer]:
                        client.sendall(piece)
                closed = not data
            except OSError:
                closed = True
            if closed:
                client.close()
                del buffers[client], peers[client]


def arguments():
    def refusals(text):
        return {int(number): int(status, 0) for number, status in (pair.split(":") for pair in text.split(","))}

    def lengths(text):
        return {int(number): int(length) for number, length in (pair.split(":") for pair in text.split(","))}

    def slow(text):
        parts = (part.split(":") for part in text.split(","))
        return {(int(number), int(value)): int(ms) for number, value, ms in parts}

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--stdin-eof", action="store_true", help="end when stdin ends")
    add("--port", type=int, default=0)
    add("--log", help="file to append what happens to")
    add("--product", default="HIPERDRIVE EtherNet/IP", help="its name in the identity object; another maker's has no parameters")
    add("--topology", choices=sorted(CATEGORIES), default="adapter")
    add("--drives", type=lambda text: [int(part) for part in text.split(",")], help="places with a drive")
    add("--serial", type=int, default=4321)
    add("--position", type=int, default=0)
    add("--order", dest="struct", type=lambda text: {"little": "<", "big": ">"}[text], default="little")
    add("--counted", action="store_true", help="texts have their length before them")
    add("--lengths", type=lengths, default={}, help="NUMBER:BYTES,… of what is read with another length than the manual's")
    add("--slow", type=slow, default={}, help="NUMBER:VALUE:MS,… of what is answered late when it is set, as 47:-4:8000")
    add("--refuse", type=refusals, default={}, help="NUMBER:STATUS,… of what is not read")
    add("--status", type=lambda text: int(text, 16), default=0x2A30, help="the status word of each drive until it is controlled")
    add("--gone-after-reset", type=int, help="the place whose drive no reset finds again")
    add("--busy", type=int, default=60, help="milliseconds for which parameter 47 is not 0")
    add("--owned", action="store_true", help="another master has the cyclic connection")
    add("--multicast-only", action="store_true")
    add("--no-words", action="store_true", help="process data without parameter words")
    add("--words", type=int, help="milliseconds until a request in the parameter words is answered; not answered without it")
    add("--silent-after", type=int, help="requests after which nothing is answered")
    add("--vanish-after", type=int, help="requests after which the target is gone")
    add("--forget", type=int, help="the session is forgotten with every Nth request")
    add("--lose-set", type=int, help="the reply to the Nth set is lost, which is done")
    add("--stale", action="store_true", help="a reply to another request before each reply")
    add("--cut", type=int, help="the end of every Nth reply is missing")
    add("--late", type=lambda text: tuple(int(part) for part in text.split(":")), help="MS:N: every Nth reply is late")
    add("--pieces", action="store_true", help="replies come byte by byte")
    add("--garbage", action="store_true", help="answer what is no frame")
    return parser


def main():
    options = arguments().parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    serve(options)


if __name__ == "__main__":
    main()
