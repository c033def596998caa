"""Limit: a time limit for code that may never end.

In:  a number of seconds.
Out: a ``with`` block that ends in ``OutOfTime`` once they are over.

>>> with TimeLimit(0.05):
...     while True:
...         pass
Traceback (most recent call last):
    ...
primkit.course.grading.limit.OutOfTime: stopped after 0.05 s

What it stops, and what it cannot:

* A Python loop, and one that swallows ``except Exception``: ``OutOfTime`` is no ``Exception``.
* A loop that swallows everything with a bare ``except``: the interruption comes again and again, and on the main thread
  of Linux and macOS also at the very next line, which is the handler's own. That ends such a loop, unless several lie
  within each other.
* Not a single call that never comes back from compiled code, and not a loop that goes out of its way to survive.
  There the time limit of the whole cell is the end: ``primkit teach grade`` then ends the kernel, marks the cell as
  failed and goes on with the next one.

On the main thread of Linux and macOS the system's alarm interrupts; on Windows and on other threads a second thread
does. Where Python has neither, as in a browser, nothing is stopped: there an endless loop ends with its page.
"""

from __future__ import annotations

import ctypes
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import Any

REPEAT_SECONDS = 0.05  # seconds from one interruption to the next, for code that swallowed the first
# Code in these folders is not a student's: its own cleaning up is never interrupted.
OWN_FOLDERS = tuple({sys.prefix, sys.base_prefix, str(Path(__file__).resolve().parents[2])})


class OutOfTime(BaseException):
    """The time is over. It is no ``Exception``, so that a student's ``except Exception`` lets it through."""


class TimeLimit:
    """A ``with`` block that is stopped by ``OutOfTime`` after some seconds.

    Parameters
    ----------
    seconds : float
        The limit, above zero.
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds

    def __enter__(self) -> None:
        """Start the clock."""
        self._outside = sys._getframe(1)
        main = threading.current_thread() is threading.main_thread()
        self._stop = self._alarm() if main and hasattr(signal, "setitimer") else self._second_thread()

    def __exit__(self, _kind: object, error: object, _trace: object) -> None:
        """Stop the clock."""
        self._stop()
        if isinstance(error, OutOfTime) and not error.args:  # a second thread can only send the bare class
            error.args = self._over().args

    def _over(self) -> OutOfTime:
        return OutOfTime(f"stopped after {self.seconds:g} s")

    def _block(self, frame: FrameType | None) -> list[FrameType] | None:
        """Return the block's frames, the innermost first; None when it has been left, or is about to be."""
        frames = list(_outwards(frame))
        leaving = TimeLimit.__exit__.__code__
        if self._outside not in frames or any(frame.f_code is leaving for frame in frames):
            return None
        return frames[: frames.index(self._outside)]

    def _alarm(self) -> Callable[[], None]:
        """Let the system's alarm interrupt the main thread; return what stops it."""
        before, tracing = signal.getsignal(signal.SIGALRM), sys.gettrace()

        def next_line(_frame: FrameType, event: str, _more: Any) -> None:
            if event == "line":
                raise self._over()  # Python takes the tracing away once it raises

        def ring(_number: int, frame: FrameType | None) -> None:
            block = self._block(frame)
            if block is None:
                return
            sys.settrace(lambda *_event: None)  # functions that are called from now on are not traced
            for each in block:
                if not each.f_code.co_filename.startswith(OWN_FOLDERS):
                    each.f_trace = next_line
            raise self._over()

        def stop() -> None:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
            sys.settrace(tracing)

        signal.signal(signal.SIGALRM, ring)
        signal.setitimer(signal.ITIMER_REAL, self.seconds, REPEAT_SECONDS)
        return stop

    def _second_thread(self) -> Callable[[], None]:
        """Let a second thread interrupt this one; return what stops it."""
        this, done = threading.get_ident(), threading.Event()
        interrupt = ctypes.pythonapi.PyThreadState_SetAsyncExc

        def watch() -> None:
            wait = self.seconds
            while not done.wait(wait):
                wait = REPEAT_SECONDS
                if self._block(sys._current_frames().get(this)) is not None:
                    interrupt(ctypes.c_ulong(this), ctypes.py_object(OutOfTime))

        def stop() -> None:
            done.set()
            while watcher.is_alive():
                with suppress(OutOfTime):
                    watcher.join()
            with suppress(OutOfTime):  # one that is still on its way arrives here
                for _ in range(9):
                    pass

        watcher = threading.Thread(target=watch, daemon=True)
        try:
            watcher.start()
        except RuntimeError:  # a browser's Python has no threads: nothing there can stop a loop
            return lambda: None
        return stop


def _outwards(frame: FrameType | None) -> Iterator[FrameType]:
    """Yield a frame and those that called it."""
    while frame is not None:
        yield frame
        frame = frame.f_back
