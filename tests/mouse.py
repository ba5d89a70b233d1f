# SPDX-License-Identifier: GPL-3.0-or-later
"""What xdotool does, by its library, in this process: to start that program for each move of the mouse takes longer than the move."""
import ctypes
import time

NO_WINDOW = 0  # where the mouse is, or the keyboard
KEY_DELAY, CLICK_DELAY = 12, 100  # milliseconds, as of xdotool


@ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
def ignore(_display, _error):
    """A window that is asked for its name may be gone by then: Xlib would end the process."""
    return 0


class Mouse:
    """Mouse and keyboard of a display."""

    def __init__(self, display):
        ctypes.CDLL("libX11.so.6").XSetErrorHandler(ignore)
        self.library = ctypes.CDLL("libxdo.so.3")
        self.library.xdo_new.restype = ctypes.c_void_p
        self.xdo = ctypes.c_void_p(self.library.xdo_new(display.encode()))
        assert self.xdo, f"no connection to {display}"

    def close(self):
        self.library.xdo_free(self.xdo)

    def call(self, name, *arguments):
        return getattr(self.library, "xdo_" + name)(self.xdo, *arguments)

    def do(self, *words):
        """Takes words as xdotool does: mousemove X Y, click [--repeat N] [--delay MS] BUTTON, key KEYS, type [--delay MS] TEXT, sleep S, ..."""
        rest = [str(word) for word in words]
        number = lambda: int(float(rest.pop(0)))

        def option(name, usual):
            if rest[:1] != [name]:
                return usual
            rest.pop(0)
            return number()

        while rest:
            command = rest.pop(0)
            if command == "mousemove":
                self.call("move_mouse", number(), number(), 0)
            elif command in ("mousedown", "mouseup"):
                self.call("mouse_" + command[5:], ctypes.c_ulong(NO_WINDOW), number())
            elif command == "click":
                repeat, delay = option("--repeat", 1), option("--delay", CLICK_DELAY)
                self.call("click_window_multiple", ctypes.c_ulong(NO_WINDOW), number(), repeat, 1000 * delay) # after each
            elif command in ("key", "keydown", "keyup"):
                self.call("send_keysequence_window" + {"key": "", "keydown": "_down", "keyup": "_up"}[command], ctypes.c_ulong(NO_WINDOW),
                          rest.pop(0).encode(), 1000 * KEY_DELAY)
            elif command == "type":
                delay = option("--delay", KEY_DELAY)
                self.call("enter_text_window", ctypes.c_ulong(NO_WINDOW), rest.pop(0).encode(), 1000 * delay)
            elif command == "windowmove":
                self.call("move_window", ctypes.c_ulong(number()), number(), number())
            elif command == "sleep":
                time.sleep(float(rest.pop(0)))
            else:
                raise ValueError(command)

    def title(self):
        """Of the window that has the keyboard; empty where none has it."""
        window, name, length, kind = ctypes.c_ulong(0), ctypes.c_void_p(), ctypes.c_int(0), ctypes.c_int(0)
        if self.call("get_active_window", ctypes.byref(window)) or not window.value:
            return ""
        if self.call("get_window_name", window, ctypes.byref(name), ctypes.byref(length), ctypes.byref(kind)) or not name.value:
            return ""
        return ctypes.string_at(name.value, length.value).decode(errors="replace")
