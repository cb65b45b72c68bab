"""A separate screen with a window manager, and real pointer and key events on it: Xvfb, openbox and the XTEST extension,
through ctypes, so that an event is sent within microseconds of its recorded time."""

import ctypes
import os
import signal
import subprocess
import time

X = ctypes.CDLL("libX11.so.6")
TEST = ctypes.CDLL("libXtst.so.6")
POINTER, LONG, INT, UINT = ctypes.c_void_p, ctypes.c_long, ctypes.c_int, ctypes.c_uint
for library, name, result, *arguments in [
    (X, "XOpenDisplay", POINTER, ctypes.c_char_p), (X, "XDefaultRootWindow", LONG, POINTER),
    (X, "XInternAtom", LONG, POINTER, ctypes.c_char_p, INT), (X, "XSync", INT, POINTER, INT), (X, "XFlush", INT, POINTER),
    (X, "XStringToKeysym", LONG, ctypes.c_char_p), (X, "XKeysymToKeycode", ctypes.c_ubyte, POINTER, LONG),
    (X, "XAutoRepeatOn", INT, POINTER), (X, "XAutoRepeatOff", INT, POINTER), (X, "XCloseDisplay", INT, POINTER),
    (X, "XIconifyWindow", INT, POINTER, LONG, INT), (X, "XMapWindow", INT, POINTER, LONG), (X, "XFree", INT, POINTER),
    (X, "XMoveResizeWindow", INT, POINTER, LONG, INT, INT, UINT, UINT),
    (X, "XCreateSimpleWindow", LONG, POINTER, LONG, INT, INT, UINT, UINT, UINT, LONG, LONG),
    (X, "XStoreName", INT, POINTER, LONG, ctypes.c_char_p), (X, "XSetErrorHandler", POINTER, POINTER),
    (X, "XSendEvent", INT, POINTER, LONG, INT, LONG, POINTER),
    (X, "XGetWindowProperty", INT, POINTER, LONG, LONG, LONG, LONG, INT, LONG, *[POINTER] * 5),
    (X, "XTranslateCoordinates", INT, POINTER, LONG, LONG, INT, INT, *[POINTER] * 3),
    (TEST, "XTestFakeMotionEvent", INT, POINTER, INT, INT, INT, LONG),
    (TEST, "XTestFakeButtonEvent", INT, POINTER, UINT, INT, LONG), (TEST, "XTestFakeKeyEvent", INT, POINTER, UINT, INT, LONG),
]:
    function = getattr(library, name)
    function.restype, function.argtypes = result, arguments

HANDLER = ctypes.CFUNCTYPE(INT, POINTER, POINTER)
# A window that was closed meanwhile is no reason to end.
IGNORE = HANDLER(lambda *_: 0)


class Message(ctypes.Structure):
    """XClientMessageEvent, with the size of an XEvent."""
    _fields_ = [("type", INT), ("serial", ctypes.c_ulong), ("send_event", INT), ("display", POINTER), ("window", LONG),
                ("message", LONG), ("format", INT), ("data", LONG * 5), ("room", LONG * 24)]


class Screen:
    """Xvfb with openbox; `priority` runs in both before they begin. Keys repeat after `delay` milliseconds, every
    `interval`."""

    def __init__(self, size="1500x1150", delay=250, interval=30, priority=None):
        options = ["-screen", "0", f"{size}x24", "-nolisten", "tcp", "-ardelay", str(delay), "-arinterval", str(interval)]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "preexec_fn": priority}
        # The server selects a free number, and reports it.
        number, told = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(told), *options], pass_fds=[told], **quiet)
        os.close(told)
        with open(number, encoding="ascii") as line:
            self.name = ":" + line.readline().strip()
        X.XSetErrorHandler(ctypes.cast(IGNORE, POINTER))
        self.display, until = None, time.monotonic() + 15
        while not self.display and time.monotonic() < until:
            time.sleep(0.1)
            self.display = X.XOpenDisplay(self.name.encode())
        if not self.display:
            raise RuntimeError("no X server begins")
        self.root = X.XDefaultRootWindow(self.display)
        environment = {**os.environ, "DISPLAY": self.name}
        self.manager = subprocess.Popen(["openbox", "--sm-disable"], env=environment, **quiet)
        self.other, self.held = None, set()
        while not self.property(self.root, "_NET_SUPPORTING_WM_CHECK") and time.monotonic() < until:
            time.sleep(0.05)

    def end(self):
        """Ends the server and all its windows."""
        for process in (self.server, self.manager):
            if process.poll() is None:
                os.kill(process.pid, signal.SIGCONT)
                process.kill()
            process.wait()

    def let_go_of_display(self):
        """Closes the connection before the server is killed: otherwise Xlib would end this process with it."""
        X.XCloseDisplay(self.display)
        self.display = None

    def atom(self, name):
        return X.XInternAtom(self.display, name.encode(), 0)

    def property(self, window, name):
        """Returns a window's property of 32-bit numbers."""
        kind, form, count, left, data = LONG(), INT(), ctypes.c_ulong(), ctypes.c_ulong(), POINTER()
        out = [ctypes.byref(one) for one in (kind, form, count, left, data)]
        X.XGetWindowProperty(self.display, window, self.atom(name), 0, 1024, 0, 0, *out)
        if not data:
            return []
        numbers = list(ctypes.cast(data, ctypes.POINTER(ctypes.c_ulong))[:count.value]) if form.value == 32 else []
        X.XFree(data)
        return numbers

    def window_of(self, pid, seconds=40):
        """Returns the window of a process, as soon as it is managed."""
        until = time.monotonic() + seconds
        while time.monotonic() < until:
            for window in self.property(self.root, "_NET_CLIENT_LIST"):
                if self.property(window, "_NET_WM_PID") == [pid]:
                    return window
            time.sleep(0.05)
        raise RuntimeError("no window appears")

    def place(self, window, x, y, width, height):
        X.XMoveResizeWindow(self.display, window, x, y, width, height)
        X.XSync(self.display, 0)

    def origin(self, window):
        x, y, child = INT(), INT(), LONG()
        X.XTranslateCoordinates(self.display, window, self.root, 0, 0, *[ctypes.byref(one) for one in (x, y, child)])
        return x.value, y.value

    def has_focus(self, window):
        return self.property(self.root, "_NET_ACTIVE_WINDOW") == [window]

    def another(self):
        """Opens a second window, of this process; the window manager gives it the keyboard focus."""
        if self.other is None:
            self.other = X.XCreateSimpleWindow(self.display, self.root, 1300, 600, 150, 150, 1, 0, 0xFFFFFF)
            X.XStoreName(self.display, self.other, b"another window")
            X.XMapWindow(self.display, self.other)
            X.XSync(self.display, 0)
            time.sleep(0.3)
        return self.other

    # Events. Each returns the time just before it was sent, in nanoseconds of CLOCK_MONOTONIC.

    def flush(self, when):
        X.XSync(self.display, 0)
        return when

    def move(self, x, y):
        when = time.monotonic_ns()
        TEST.XTestFakeMotionEvent(self.display, -1, round(x), round(y), 0)
        return self.flush(when)

    def button(self, is_down, number=1):
        when = time.monotonic_ns()
        self.keep((self.button, number), is_down)
        TEST.XTestFakeButtonEvent(self.display, number, int(is_down), 0)
        return self.flush(when)

    def key(self, name, is_down):
        when = time.monotonic_ns()
        code = X.XKeysymToKeycode(self.display, X.XStringToKeysym(name.encode()))
        self.keep((self.key, name), is_down)
        TEST.XTestFakeKeyEvent(self.display, code, int(is_down), 0)
        return self.flush(when)

    def press(self, *names):
        """Presses all keys, one after the other, then releases them; returns the time of the last press."""
        downs = [self.key(name, True) for name in names]
        for name in reversed(names):
            self.key(name, False)
        return downs[-1]

    def keep(self, what, is_down):
        self.held = self.held | {what} if is_down else self.held - {what}

    def release_all(self):
        for how, what in list(self.held):
            how(False, what) if how == self.button else how(what, False)

    def repeat(self, is_on):
        (X.XAutoRepeatOn if is_on else X.XAutoRepeatOff)(self.display)
        X.XSync(self.display, 0)

    def ask_manager(self, window, name, *data):
        """Sends the request of a panel to the window manager."""
        when = time.monotonic_ns()
        event = Message(type=33, window=window, message=self.atom(name), format=32, data=(LONG * 5)(*data))
        X.XSendEvent(self.display, self.root, 0, 0x180000, ctypes.byref(event))
        return self.flush(when)

    def activate(self, window):
        return self.ask_manager(window, "_NET_ACTIVE_WINDOW", 2)

    def close(self, window):
        return self.ask_manager(window, "_NET_CLOSE_WINDOW", 0, 2)

    def minimise(self, window):
        when = time.monotonic_ns()
        X.XIconifyWindow(self.display, window, 0)
        return self.flush(when)
