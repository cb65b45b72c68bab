#!/usr/bin/env python3
"""An EtherNet/IP target whose HIPERDRIVE drives take time to move, and that keeps a record of every cyclic packet.

enip_target.py with the axes of axis.py: they accelerate, turn, brake, have limits and faults. Their faults are set at run
time, one command per line on stdin; each is answered by a line `done NANOSECONDS` on stdout.

    place N            sets the position                       limits LOWER UPPER
    reverse on|off     it turns the wrong way                  unlimited on|off   it ignores its limits
    overrun on|off     it does not stop at a target            pauseless on|off   it does not obey a pause
    drive N            the following commands are for this drive instead of the first one
    fault CODE         it fails now, with a hexadecimal code
    tcp answer|silent|garbage|reset|fin                        handling of explicit messages
    udp answer|silent|garbage                                  handling of cyclic data to the master
    pause MS           no cyclic data for this time            delay MS           delays each cyclic packet by this time

The record (--record FILE) has a line per packet, `P TIME SEQUENCE WORD STATUS POSITION MOTION DRIVE`, where MOTION is 1
if the control word commands motion (`Axis.commands`), and a line per event, `E TIME NAME`: START and STAND of the drive,
FAULT, OPEN, CLOSE, LOST of the connection, and BEYOND, PAST or WRONG with the first packet that tells the master of a
position beyond a limit, past the target, or against the commanded direction. Times are nanoseconds of CLOCK_MONOTONIC;
those of packets are the kernel's.
"""

import select
import signal
import socket
import struct
import sys
import time

import cip
import enip_target
from axis import TIMEOUT, Axis

# Linux: the kernel returns the arrival time of a datagram, on its real-time clock.
SO_TIMESTAMPNS = 35


def arrival(ancillary):
    """Returns the arrival time of a datagram, in nanoseconds of CLOCK_MONOTONIC."""
    now = time.monotonic_ns()
    for level, kind, data in ancillary:
        if level == socket.SOL_SOCKET and kind == SO_TIMESTAMPNS:
            seconds, nanoseconds = struct.unpack("@ll", data[:struct.calcsize("@ll")])
            return now - (time.time_ns() - (seconds * 1_000_000_000 + nanoseconds))
    return now


class Station(enip_target.Station):
    def __init__(self, options):
        super().__init__(options)
        self.axes = {drive: Axis(options.position) for drive in self.plugged}
        self.turned = time.monotonic()
        self.record = open(options.record, "w", encoding="ascii", buffering=1) if options.record else None
        self.is_astray = set()

    def tell(self, name, when=None):
        if self.record:
            self.record.write(f"E {when or time.monotonic_ns()} {name}\n")

    def turn(self):
        """Updates all axes to the current time."""
        now = time.monotonic()
        seconds, self.turned = now - self.turned, now
        for drive, axis in self.axes.items():
            axis.lower, axis.upper = self.of(drive, 158), self.of(drive, 160)
            axis.turn = 256 * self.of(drive, 154) / self.of(drive, 156)
            # A busy computer calls this rarely: an interval longer than 10 ms is divided into several steps.
            steps = max(1, round(seconds / 0.01))
            for _ in range(steps):
                for line in axis.advance(seconds / steps):
                    self.tell(line)
            self.publish(drive, axis)

    def publish(self, drive, axis):
        base = 100 * (drive - 1)
        buffer = [self.values[108 + base + place] for place in range(8)]
        if axis.code and axis.code != buffer[0]:
            buffer = [axis.code, *buffer[:7]]
        self.values.update({108 + base + place: code for place, code in enumerate(buffer)})
        self.values.update({105 + base: axis.status(), 106 + base: axis.speed(), 107 + base: round(axis.position)})

    def write(self, number, data):
        super().write(number, data)
        if number >= 100 and number % 100 == 98:
            self.axes[number // 100].place(self.values[number])

    def command(self, drive, output, sequence, when):
        """Returns a drive's part of a cyclic packet."""
        word, speed, torque, target = struct.unpack(self.options.struct + "HBBi", output)
        axis = self.axes[drive]
        moves = axis.commands(word)
        if self.record:
            line = f"P {when} {sequence} {word:04X} {axis.status():04X} {round(axis.position)} {int(moves)} {drive}"
            self.record.write(line + "\n")
        self.note_word(drive, word)
        base = 100 * (drive - 1)
        self.values.update({101 + base: word, 102 + base: speed, 103 + base: torque, 104 + base: target})
        if line := axis.obey(word, speed, torque, target):
            self.tell(line)
        self.publish(drive, axis)

    def image(self, with_words):
        image = b""
        for drive in range(1, self.places + 1):
            actual = [self.of(drive, base) for base in (105, 106, 107)] if drive in self.axes else (0, 0, 0)
            image += struct.pack(self.options.struct + "Hhi", *actual)
        return image + bytes(8 if with_words else 0)

    def tell_strays(self):
        """Records position errors, with the packet that shows them to the master."""
        found = {(drive, name) for drive, axis in self.axes.items() for name in axis.strays()}
        for _, name in sorted(found - self.is_astray):
            self.tell(name)
        self.is_astray = found

    def lose(self):
        """Runs the drives' own watchdog."""
        for axis in self.axes.values():
            self.tell(axis.fail(TIMEOUT))


class Target(enip_target.Target):
    def __init__(self, options, udp, port):
        super().__init__(options, udp, port)
        self.station = Station(options)
        self.cyclic, self.pause_until, self.delay, self.waiting = "answer", 0.0, 0.0, []

    def message(self, service, path, data, listed, peer):
        self.station.turn()
        had = self.connection
        answer = super().message(service, path, data, listed, peer)
        if self.connection is not had:
            self.station.tell("CLOSE" if self.connection is None else "OPEN")
            if self.connection is None:
                for axis in self.station.axes.values():
                    axis.halt()
        return answer

    def packet(self, packet, sender, when):
        if packet[:2] == struct.pack("<H", cip.LIST_IDENTITY) and len(packet) >= cip.HEADER.size:
            self.datagram(packet, sender)
            return
        try:
            listed = cip.parse_items(packet)
            number, sequence = struct.unpack("<II", listed[0x8002])
            data = listed[0xB1][6:]
        except (struct.error, KeyError):
            return
        if self.connection is None or number != self.connection["id"]:
            self.station.tell("STRAY_PACKET", when)
            return
        self.connection["heard"] = time.monotonic()
        self.station.turn()
        for drive in self.station.plugged:
            self.station.command(drive, data[8 * (drive - 1):8 * drive], sequence, when)

    def turn(self):
        """Sends the due packets: returns the seconds until the next one."""
        connection, now = self.connection, time.monotonic()
        self.station.turn()
        if connection is None:
            return 0.01
        if now - connection["heard"] > connection["watchdog"]:
            self.station.tell("LOST")
            self.station.lose()
            self.connection = None
            return 0.01
        if now >= connection["next"]:
            # A missed deadline is not made up for.
            connection["next"] = max(connection["next"] + connection["interval"], now)
            connection["sequence"] += 1
            address = struct.pack("<II", connection["back"], connection["sequence"])
            count = struct.pack("<H", connection["sequence"] & 0xFFFF)
            data = cip.items((0x8002, address), (0xB1, count + self.station.image(connection["words"])))
            if self.cyclic == "garbage":
                data = bytes((byte * 131 + 89) & 0xFF for byte in data)
            if self.cyclic != "silent" and now >= self.pause_until:
                self.waiting.append((now + self.delay, data))
            self.station.tell_strays()
        while self.waiting and self.waiting[0][0] <= now:
            self.udp.sendto(self.waiting.pop(0)[1], connection["to"])
        due = [connection["next"]] + [at for at, _ in self.waiting[:1]]
        return max(0.0, min(due) - time.monotonic())


class Server:
    def __init__(self, options):
        self.listener = socket.create_server(("127.0.0.1", options.port))
        self.port = self.listener.getsockname()[1]
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.udp.bind(("127.0.0.1", self.port))
        self.udp.setsockopt(socket.SOL_SOCKET, SO_TIMESTAMPNS, 1)
        self.target = Target(options, self.udp, self.port)
        self.buffers, self.peers, self.explicit = {}, {}, "answer"
        self.typed = b""
        self.drive = self.target.station.plugged[0]

    def serve(self):
        print("ready", f"127.0.0.1:{self.port}", flush=True)
        while True:
            wait = self.target.turn()
            ready, _, _ = select.select([self.listener, self.udp, sys.stdin, *self.buffers], [], [], wait)
            # Packets first: nothing else may delay them.
            if self.udp in ready:
                packet, ancillary, _, sender = self.udp.recvmsg(2048, 128)
                self.target.packet(packet, sender, arrival(ancillary))
            for client in [one for one in ready if one in self.buffers]:
                self.hear(client)
            if self.listener in ready:
                client, (peer, _) = self.listener.accept()
                client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self.buffers[client], self.peers[client] = bytearray(), peer
            if sys.stdin in ready and not self.hear_commands():
                return

    def hear(self, client):
        try:
            data = client.recv(4096)
            self.buffers[client] += data
            while data and (frame := cip.take(self.buffers[client])) is not None:
                if self.explicit == "silent":
                    continue
                answer = self.target.take(frame, self.peers[client])
                client.sendall(bytes(range(200, 250)) if self.explicit == "garbage" else answer or b"")
        except OSError:
            data = b""
        if not data:
            client.close()
            self.buffers.pop(client, None)

    def hear_commands(self):
        """Handles a command; returns False if stdin has ended."""
        data = sys.stdin.buffer.raw.read(4096)
        if not data:
            return False
        *lines, self.typed = (self.typed + data).split(b"\n")
        for line in lines:
            when = time.monotonic_ns()
            self.obey(*line.decode("ascii").split())
            print("done", when, flush=True)
        return True

    def obey(self, name, *words):
        axis, target = self.target.station.axes[self.drive], self.target
        self.target.station.turn()
        if name == "drive":
            self.drive = int(words[0])
        elif name == "place":
            axis.place(int(words[0]))
        elif name == "limits":
            base = 100 * (self.drive - 1)
            target.station.values.update({158 + base: int(words[0]), 160 + base: int(words[1])})
        elif name == "reverse":
            axis.is_reversed = words[0] == "on"
        elif name == "unlimited":
            axis.is_unlimited = words[0] == "on"
        elif name == "overrun":
            axis.is_overrunning = words[0] == "on"
        elif name == "pauseless":
            axis.is_pauseless = words[0] == "on"
        elif name == "fault":
            target.station.tell(axis.fail(int(words[0], 16)))
        elif name == "udp":
            target.cyclic = words[0]
        elif name == "pause":
            target.pause_until = time.monotonic() + int(words[0]) / 1000
        elif name == "delay":
            target.delay = int(words[0]) / 1000
        elif name == "tcp":
            self.explicitly(words[0])
        else:
            raise ValueError(name)

    def explicitly(self, how):
        if how in ("answer", "silent", "garbage"):
            self.explicit = how
            for client in self.buffers if how == "garbage" else ():
                client.sendall(bytes(range(200, 250)))
            return
        for client in list(self.buffers):
            if how == "fin":
                client.shutdown(socket.SHUT_WR)
            else:
                client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                client.close()
                del self.buffers[client]


def main():
    parser = enip_target.arguments()
    parser.description = __doc__
    parser.add_argument("--record", help="file for a line a cyclic packet")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    Server(options).serve()


if __name__ == "__main__":
    main()
