"""Compiling at a first start: said if it takes long, and ended by a signal."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

LONG = 2.0
"""Time after which it is said that a program compiles [s]."""

AGAIN = 0.1
"""Time after which an interrupt that was lost in the compiler is raised once more [s]."""


class Interrupted(BaseException):
    """A signal came while a program compiled, and nothing was open yet."""


@contextlib.contextmanager
def _compilation() -> Iterator[threading.Event]:
    """Give what is set when Numba begins to compile; what its cache has is only loaded."""
    # Not at the top: a program that compiles nothing need not load the compiler.
    from numba.core import event

    began = threading.Event()

    class Listener(event.Listener):
        def on_start(self, event: event.Event) -> None:
            began.set()

        def on_end(self, event: event.Event) -> None:
            pass

    with event.install_listener('numba:compile', Listener()):
        yield began


@contextlib.contextmanager
def announced(what: str, say: Callable[[str], object]) -> Iterator[None]:
    """Say that `what` is compiled, if it is and that takes long.

    Nothing is said where all comes from Numba's cache, however long a busy machine takes to load.

    Parameters
    ----------
    what : str
    say : callable
        Is given the line, in another thread: LONG after the start, or when the first compilation
        begins if that is later.
    """
    ended = threading.Event()
    with _compilation() as began:

        def watch() -> None:
            if ended.wait(LONG):
                return
            began.wait()
            if not ended.is_set():
                say(f'compiling {what} for this machine; only a first start takes this long')

        watcher = threading.Thread(target=watch, daemon=True)
        watcher.start()
        try:
            yield
        finally:
            ended.set()
            began.set()
            watcher.join()


@contextlib.contextmanager
def compiling(what: str, say: Callable[[str], object]) -> Iterator[None]:
    """Announce that `what` is compiled if that takes long; SIGINT and SIGTERM end it at once.

    Nothing that needs closing may be open yet.
    """
    with announced(what, say), interruptible():
        yield


def exit_at_signal() -> None:
    """Exit with code 0 at SIGINT and SIGTERM from now on: for loading, while nothing is open.

    An exception would meet the imports wherever they are, and show as a traceback.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda number, frame: os._exit(0))


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """Let SIGINT and SIGTERM end a program at once: for compiling, while nothing is open."""
    came = False

    def interrupt(number: int, frame: Any) -> None:
        nonlocal came
        came = True
        # What is raised in a callback from C or a finalizer is only reported, and goes no further.
        if timed:
            signal.setitimer(signal.ITIMER_REAL, AGAIN)
        raise Interrupted

    timed = hasattr(signal, 'setitimer')  # not on Windows
    numbers = [signal.SIGINT, signal.SIGTERM, *([signal.SIGALRM] if timed else [])]
    handlers = [signal.signal(number, interrupt) for number in numbers]
    report = sys.unraisablehook
    sys.unraisablehook = lambda unraisable: None if came else report(unraisable)
    try:
        yield
    except Exception:
        if not came:
            raise
    finally:
        if came and timed:
            signal.setitimer(signal.ITIMER_REAL, 0)
        if not came:  # what was left half made is reported when it is freed, which may be later
            sys.unraisablehook = report
        for number, handler in zip(numbers, handlers, strict=True):
            signal.signal(number, handler)
    if came:
        raise Interrupted
