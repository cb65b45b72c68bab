"""A serial line or a TCP connection, for the hosts of these tests. Python standard library only."""

import os
import select
import socket
import termios
import tty

BIT_RATES = {600: termios.B600, 1200: termios.B1200, 2400: termios.B2400, 4800: termios.B4800,
             9600: termios.B9600, 19200: termios.B19200, 38400: termios.B38400, 115200: termios.B115200}


class Wire:
    """A file descriptor to the encoder, for either connection."""

    def __init__(self, path, baud, parity):
        self.socket = None
        if path.startswith("tcp:"):
            _, host, port = path.split(":")
            self.socket = socket.create_connection((host, int(port)), timeout=5)
            self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self.socket.settimeout(None)
            self.fd = self.socket.fileno()
        else:
            self.fd = os.open(path, os.O_RDWR | os.O_NOCTTY)
            self.set_line(baud, parity)

    def set_line(self, baud, parity):
        tty.setraw(self.fd)
        line = termios.tcgetattr(self.fd)
        line[2] &= ~(termios.PARENB | termios.PARODD | termios.CSTOPB)
        line[2] |= termios.CLOCAL | termios.CREAD | termios.CS8
        line[2] |= {"none": 0, "even": termios.PARENB, "odd": termios.PARENB | termios.PARODD}[parity]
        line[4] = line[5] = BIT_RATES[baud]
        try:
            termios.tcsetattr(self.fd, termios.TCSANOW, line)
        except termios.error:  # a pty has no parity bit, and some systems say so
            line[2] &= ~(termios.PARENB | termios.PARODD)
            termios.tcsetattr(self.fd, termios.TCSANOW, line)

    def send(self, data):
        while data:
            data = data[os.write(self.fd, data):]

    def receive(self, seconds):
        """Returns the bytes that arrive within the time; none when it is up, None when the other side has closed."""
        ready, _, _ = select.select([self.fd], [], [], max(0.0, seconds))
        if not ready:
            return b""
        try:
            return os.read(self.fd, 4096) or None
        except OSError:
            return None
