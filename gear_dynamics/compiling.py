"""Compiling at a first start: said if it takes long, and ended by a signal."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any

LONG = 2.0
"""Time after which it is said what is going on [s]; with a warm cache it does not come to it."""


class Interrupted(BaseException):
    """A signal came while a program compiled, and nothing was open yet."""


@contextlib.contextmanager
def announced(what: str, say: Callable[[str], object]) -> Iterator[None]:
    """Say that `what` is compiled if that takes long.

    Parameters
    ----------
    what : str
    say : callable
        Is given the line, in another thread.
    """
    line = f'compiling {what} for this machine; only a first start takes this long'
    notice = threading.Timer(LONG, say, [line])
    notice.daemon = True
    notice.start()
    try:
        yield
    finally:
        notice.cancel()


@contextlib.contextmanager
def interruptible() -> Iterator[None]:
    """Let SIGINT and SIGTERM end a program at once: for compiling, while nothing is open."""
    came = False

    def interrupt(number: int, frame: Any) -> None:
        nonlocal came
        came = True
        raise Interrupted

    numbers = (signal.SIGINT, signal.SIGTERM)
    handlers = [signal.signal(number, interrupt) for number in numbers]
    # The compiler calls back from C: what is raised there is only reported, and makes it fail.
    report = sys.unraisablehook
    sys.unraisablehook = lambda unraisable: None if came else report(unraisable)
    try:
        yield
    except Exception:
        if not came:
            raise
    finally:
        sys.unraisablehook = report
        for number, handler in zip(numbers, handlers, strict=True):
            signal.signal(number, handler)
    if came:
        raise Interrupted
