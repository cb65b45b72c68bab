"""A pseudo-terminal whose other end only the client opens, for the devices of these tests. Python standard library only."""

import os
import pty
import select
import signal
import sys
import termios
import time
import tty

END = object()  # stdin has ended, and so shall we


class Terminal:
    def __init__(self, stdin_eof=False):
        self.stdin_eof = stdin_eof
        self.master, slave = pty.openpty()
        self.path = os.ttyname(slave)
        tty.setraw(slave)
        os.close(slave)  # from now on the only one who holds it is the client

    def read(self, seconds):
        """Returns the bytes of the client; b"" if none came in time, None without a client, END at the end."""
        watched = [self.master] + ([sys.stdin.fileno()] if self.stdin_eof else [])
        ready, _, _ = select.select(watched, [], [], seconds)
        if sys.stdin.fileno() in ready and not os.read(sys.stdin.fileno(), 4096):
            return END
        if self.master not in ready:
            return b""
        try:
            return os.read(self.master, 4096)
        except OSError:  # EIO
            return None

    def write(self, data):
        try:
            os.write(self.master, data)
        except OSError:
            pass  # the client has gone

    def hang_up(self):
        """Handles a disconnected client: no late reply for the next one."""
        termios.tcflush(self.master, termios.TCIOFLUSH)
        tty.setraw(self.master)
        time.sleep(0.002)

    def serve(self, link, run):
        """Creates the symbolic link, prints "ready PATH" and runs until the end."""
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
        try:
            if link:
                if os.path.islink(link):
                    os.unlink(link)
                os.symlink(self.path, link)
            print("ready", self.path, flush=True)
            run()
        except KeyboardInterrupt:
            pass
        finally:
            if link and os.path.islink(link) and os.readlink(link) == self.path:
                os.unlink(link)
